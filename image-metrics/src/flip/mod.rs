//! FLIP: the difference that a viewer sees when two images alternate on a screen.

mod color;
mod kernels;
mod rows;

use crate::{Error, ImageView};
use color::{Hunt, MAX_DIFFERENCE};
use rows::{FilteredRows, Seen};

/// Pixels per degree of the viewer's field of view at which [`flip`] judges: 3840·π/180, near 67.
///
/// That is 0.7 m from a screen 0.7 m and 3840 pixels wide, the viewing condition of the method's authors. More makes the
/// eye overlook fine noise. Figures made with another value cannot be compared.
pub const FLIP_PIXELS_PER_DEGREE: f64 = 3840.0 * core::f64::consts::PI / 180.0;

/// Compression of colour differences, and of feature differences.
const COLOR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;

/// Differences up to this share of the largest take up this share of the scale.
const COMMON_SHARE: f64 = 0.4;
const COMMON_SCALE: f64 = 0.95;

/// The mean of [`flip_map`]: LDR-FLIP of what a screen shows, at 67 pixels a degree.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: 0 for images that look the same on a screen, at most 1. Symmetric in its arguments.
///
/// # Source
/// Andersson et al. 2020.
///
/// ```
/// # use image_metrics::{ImageView, flip};
/// let (green, blue) = ([[0.0, 1.0, 0.0]; 64], [[0.0, 0.0, 1.0]; 64]);
/// let (green, blue) = (ImageView::new(8, 8, &green)?, ImageView::new(8, 8, &blue)?);
/// assert_eq!(flip(green, green)?, 0.0);
/// // The largest difference of colours that a screen can show, by which the scale is set.
/// assert!((flip(blue, green)? - 1.0).abs() < 1e-6);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn flip(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    let errors = flip_map(image, reference)?;
    Ok(errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64)
}

/// LDR-FLIP for each pixel, row by row from the upper left: how different the pixel looks when the images alternate.
///
/// Both images are clipped to `[0, 1]`, as a screen does. Colours are blurred by what the eye resolves and compared in
/// a perceptual space; differences of edges and points in the luminance raise the result.
/// Outside the image its border pixels are repeated.
///
/// # Errors
/// [`Error::SizesDiffer`].
///
/// # Units
/// None: from 0 (no visible difference) to 1 (the largest).
///
/// # Source
/// Andersson et al. 2020, section 4.
///
/// ```
/// # use image_metrics::{ImageView, flip_map};
/// let grey = [[0.2; 3]; 41 * 41];
/// let mut dot = grey;
/// dot[20 * 41 + 20] = [1.0; 3];
/// let map = flip_map(ImageView::new(41, 41, &dot)?, ImageView::new(41, 41, &grey)?)?;
/// assert!(map[20 * 41 + 20] > 0.3 && map[0] < 1e-6);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn flip_map(image: ImageView, reference: ImageView) -> Result<Vec<f32>, Error> {
    image.same_size(&reference)?;
    let (mut image, mut reference) = (FilteredRows::new(image), FilteredRows::new(reference));
    let mut errors = Vec::new();
    while let (Some(a), Some(b)) = (image.next_row(), reference.next_row()) {
        errors.extend(a.iter().zip(b).map(|(a, b)| pixel_error(a, b) as f32));
    }
    Ok(errors)
}

/// The error of a pixel: its colour difference to the power of one minus its feature difference.
fn pixel_error(a: &Seen, b: &Seen) -> f64 {
    let feature = (a.edge - b.edge).abs().max((a.point - b.point).abs());
    // Two unit slopes are √2 long; rounding must not turn the exponent below negative.
    let feature = (core::f64::consts::FRAC_1_SQRT_2 * feature).powf(FEATURE_EXPONENT).min(1.0);
    color_error(&a.color, &b.color).powf(1.0 - feature)
}

/// The colour difference as a number from 0 to 1.
fn color_error(a: &Hunt, b: &Hunt) -> f64 {
    let largest = MAX_DIFFERENCE.powf(COLOR_EXPONENT);
    let difference = a.distance(b).powf(COLOR_EXPONENT);
    let common = COMMON_SHARE * largest;
    if difference < common {
        difference * COMMON_SCALE / common
    } else {
        // Filtered colours stay inside the screen's, so only rounding could pass 1.
        (COMMON_SCALE + (difference - common) / (largest - common) * (1.0 - COMMON_SCALE)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use color::{Opponent, to_hunt};

    #[test]
    fn the_scale_ends_at_green_against_blue() {
        let hunt = |rgb| to_hunt(Opponent::from_linear(rgb));
        let colors = [0.0, 0.25, 1.0];
        let all = || colors.iter().flat_map(|&r| colors.iter().flat_map(move |&g| colors.map(|b| [r, g, b])));
        let largest = all().flat_map(|a| all().map(move |b| hunt(a).distance(&hunt(b)))).fold(0.0, f64::max);
        assert!((largest / MAX_DIFFERENCE - 1.0).abs() < 1e-9, "{largest}");
        assert!((color_error(&hunt([0.0, 1.0, 0.0]), &hunt([0.0, 0.0, 1.0])) - 1.0).abs() < 1e-9);
    }
}
