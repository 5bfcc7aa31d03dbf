use crate::{Error, ImageView};

/// The sum of an image over the sum of its reference, in linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyRatio {
    /// Over all channels: ΣI / ΣR.
    pub whole: f64,
    /// For red, green and blue apart.
    pub channels: [f64; 3],
}

/// ΣI / ΣR, whole and for each channel: 1 when no light is lost or gained.
///
/// Noise averages out in it, so it shows bias early; errors of opposite sign hide each other.
/// Equal sums give 1, also when both are 0; a sum over a reference's 0 is ±∞.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: a ratio.
///
/// ```
/// # use image_metrics::{ImageView, energy_ratio};
/// let (image, reference) = ([[1.0, 1.0, 0.0]], [[2.0, 1.0, 0.0]]);
/// let ratio = energy_ratio(ImageView::new(1, 1, &image)?, ImageView::new(1, 1, &reference)?)?;
/// assert_eq!((ratio.whole, ratio.channels), (2.0 / 3.0, [0.5, 1.0, 1.0]));
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn energy_ratio(image: ImageView, reference: ImageView) -> Result<EnergyRatio, Error> {
    image.same_size(&reference)?;
    let (i, r) = (channel_sums(image), channel_sums(reference));
    Ok(EnergyRatio {
        whole: ratio(i.iter().sum(), r.iter().sum()),
        channels: [ratio(i[0], r[0]), ratio(i[1], r[1]), ratio(i[2], r[2])],
    })
}

fn channel_sums(image: ImageView) -> [f64; 3] {
    image.pixels().iter().fold([0.0; 3], |s, p| core::array::from_fn(|c| s[c] + f64::from(p[c])))
}

/// `a / b`, with the 0 / 0 of two black images as 1.
#[expect(clippy::float_cmp, reason = "equal sums are a ratio of exactly 1, and two zeros have no other")]
fn ratio(a: f64, b: f64) -> f64 {
    if a == b { 1.0 } else { a / b }
}
