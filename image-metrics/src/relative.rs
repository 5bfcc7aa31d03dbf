use crate::{Error, ImageView};

/// What is added to R² in relMSE, in squared radiance.
///
/// 0.01 is the value of the field's comparisons: a pixel of reference 0.1 counts half as much as a bright one with the
/// same relative error. Figures made with another value cannot be compared.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// The share of pixels that [`rel_mse_trimmed`] leaves out: 0.1 %.
///
/// Few enough to keep all broad noise, enough to remove single fireflies, which else rule the mean.
pub const WORST_SHARE: f64 = 0.001;

/// Squared error relative to the reference's square.
fn relative_square(i: f64, r: f64) -> f64 {
    (i - r) * (i - r) / (r * r + REL_MSE_EPSILON)
}

/// relMSE: the mean over pixels and channels of (I−R)² / (R² + 0.01).
///
/// Linear light, unclipped. For independent samples it falls as 1/N in the samples per pixel N.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: a ratio, 0 for equal images, never negative.
///
/// # Source
/// Rousselle et al. 2011, section 3; ε from [`REL_MSE_EPSILON`].
///
/// ```
/// # use image_metrics::{ImageView, rel_mse};
/// let (image, reference) = ([[0.2; 3]], [[0.1; 3]]);
/// let e = rel_mse(ImageView::new(1, 1, &image)?, ImageView::new(1, 1, &reference)?)?;
/// assert!((e - 0.5).abs() < 1e-6); // 0.1² / (0.1² + 0.01)
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn rel_mse(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    image.same_size(&reference)?;
    let sum: f64 = image.channels_beside(&reference).map(|(i, r)| relative_square(i, r)).sum();
    Ok(sum / (3 * image.pixels().len()) as f64)
}

/// relMSE for each pixel, row by row from the upper left: the mean over its channels.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: a ratio, 0 for equal pixels. Its root is a relative error: 1 is as wrong as the reference is bright.
///
/// ```
/// # use image_metrics::{ImageView, rel_mse_map};
/// let (image, reference) = ([[3.0; 3], [1.0; 3]], [[1.0; 3]; 2]);
/// let map = rel_mse_map(ImageView::new(2, 1, &image)?, ImageView::new(2, 1, &reference)?)?;
/// assert_eq!(map, [4.0 / 1.01, 0.0]);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn rel_mse_map(image: ImageView, reference: ImageView) -> Result<Vec<f64>, Error> {
    image.same_size(&reference)?;
    let pixel_error = |(i, r): (&[f32; 3], &[f32; 3])| {
        i.iter().zip(r).map(|(&i, &r)| relative_square(i.into(), r.into())).sum::<f64>() / 3.0
    };
    Ok(image.pixels().iter().zip(reference.pixels()).map(pixel_error).collect())
}

/// relMSE without the worst 0.1 % of pixels ([`WORST_SHARE`]).
///
/// A pixel's error is the mean over its channels. Of n pixels the ⌊n·(1 − 0.001)⌋ with the smallest errors are averaged,
/// and never fewer than one: below 1000 pixels the worst one is left out, a single pixel is kept.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: a ratio, at most [`rel_mse`].
///
/// ```
/// # use image_metrics::{ImageView, rel_mse_trimmed};
/// let reference = [[1.0; 3]; 1000];
/// let mut image = reference;
/// image[17] = [5000.0; 3]; // a firefly
/// let e = rel_mse_trimmed(ImageView::new(50, 20, &image)?, ImageView::new(50, 20, &reference)?)?;
/// assert_eq!(e, 0.0);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn rel_mse_trimmed(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    let mut errors = rel_mse_map(image, reference)?;
    errors.sort_unstable_by(f64::total_cmp);
    let kept = ((errors.len() as f64 * (1.0 - WORST_SHARE)) as usize).max(1);
    Ok(errors[..kept].iter().sum::<f64>() / kept as f64)
}
