use crate::{Error, ImageView, srgb_encode};

/// The mean over pixels and channels of (I−R)², in linear light, unclipped.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// Squared radiance.
///
/// ```
/// # use image_metrics::{ImageView, mse};
/// let (image, reference) = ([[3.0, 1.0, 1.0]], [[1.0; 3]]);
/// let e = mse(ImageView::new(1, 1, &image)?, ImageView::new(1, 1, &reference)?)?;
/// assert!((e - 4.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn mse(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    mean_square(image, reference, |x| x)
}

/// The peak signal-to-noise ratio of what a screen shows: −10·log₁₀ of the mean squared difference of the clipped,
/// sRGB-encoded images, whose peak is 1.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// Decibels. Infinite when a screen shows the same; 0 for black against white.
///
/// ```
/// # use image_metrics::{ImageView, psnr};
/// let (black, white) = ([[0.0; 3]], [[1.0; 3]]);
/// assert_eq!(psnr(ImageView::new(1, 1, &black)?, ImageView::new(1, 1, &white)?)?, 0.0);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn psnr(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    let error = mean_square(image, reference, srgb_encode)?;
    Ok(10.0 * (1.0 / error).log10())
}

fn mean_square(image: ImageView, reference: ImageView, encode: impl Fn(f64) -> f64) -> Result<f64, Error> {
    image.same_size(&reference)?;
    let square = |(i, r)| {
        let d: f64 = encode(i) - encode(r);
        d * d
    };
    let sum: f64 = image.channels_beside(&reference).map(square).sum();
    Ok(sum / (3 * image.pixels().len()) as f64)
}
