/// Encodes linear light for a screen: clips to `[0, 1]`, then applies the sRGB transfer curve.
///
/// NaN counts as 0.
///
/// # Source
/// IEC 61966-2-1.
///
/// ```
/// use image_metrics::srgb_encode;
///
/// assert_eq!((srgb_encode(-1.0), srgb_encode(7.0)), (0.0, 1.0));
/// assert!((srgb_encode(0.214_041_14) - 0.5).abs() < 1e-7);
/// ```
pub fn srgb_encode(linear: f64) -> f64 {
    if linear >= 1.0 {
        1.0
    } else if linear > 0.003_130_8 {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    } else if linear > 0.0 {
        12.92 * linear
    } else {
        0.0
    }
}
