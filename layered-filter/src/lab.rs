//! CIE L\*a\*b\* of linear Rec. 709 colours.
//!
//! # Source
//! CIE 15:2018, section 8.2.1, with the white of the input, D65 (Rec. 709's own white has a\* = b\* = 0).

use hashcache_core::float;
use hashcache_core::glam::Vec3;

/// Below this ratio to white the cube root is replaced by a line, (6/29)³.
const LINEAR_BELOW: f32 = 216.0 / 24_389.0;

/// Slope of that line, (29/6)³ / 27 · … = 24389/27 in units of 1/116.
const LINEAR_SLOPE: f32 = 24_389.0 / (27.0 * 116.0);

/// L\*a\*b\* of a reflectance: L\* from 0 (black) to 100 (white), a\* and b\* within about ±110. Components are clamped to
/// 0..=1 first (an albedo cannot be more); NaN counts as 0.
///
/// ```
/// # use hashcache_core::glam::Vec3;
/// # use layered_filter::lab::lab_from_linear;
/// let white = lab_from_linear(Vec3::ONE);
/// assert!((white - Vec3::new(100.0, 0.0, 0.0)).length() < 0.01);
/// ```
#[inline]
pub fn lab_from_linear(rgb: Vec3) -> Vec3 {
    let rgb = Vec3::from_array(rgb.to_array().map(reflectance));
    // Rows of the Rec. 709 matrix, each divided by its sum: the white's X, Y, Z.
    let x = 0.433_953 * rgb.x + 0.376_219 * rgb.y + 0.189_828 * rgb.z;
    let y = 0.212_639 * rgb.x + 0.715_169 * rgb.y + 0.072_192 * rgb.z;
    let z = 0.017_758 * rgb.x + 0.109_477 * rgb.y + 0.872_765 * rgb.z;
    let (fx, fy, fz) = (compressed(x), compressed(y), compressed(z));
    Vec3::new(116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz))
}

/// Within 0..=1, and 0 for NaN.
#[inline]
fn reflectance(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

#[inline]
fn compressed(t: f32) -> f32 {
    if t > LINEAR_BELOW { float::cbrt(t) } else { LINEAR_SLOPE * t + 16.0 / 116.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_colours() {
        // sRGB's red, green and blue in L*a*b* (D65), Lindbloom's calculator.
        let known = [
            (Vec3::X, Vec3::new(53.24, 80.09, 67.20)),
            (Vec3::Y, Vec3::new(87.74, -86.18, 83.18)),
            (Vec3::Z, Vec3::new(32.30, 79.19, -107.86)),
            (Vec3::ZERO, Vec3::ZERO),
        ];
        for (rgb, lab) in known {
            assert!((lab_from_linear(rgb) - lab).length() < 0.1, "{rgb}: {}", lab_from_linear(rgb));
        }
        assert!(lab_from_linear(Vec3::splat(0.18)).z.abs() < 0.01, "greys have no colour");
    }

    #[test]
    fn hostile_colours_stay_finite() {
        for v in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, 1e-40] {
            assert!(lab_from_linear(Vec3::new(v, 0.5, v)).is_finite());
        }
    }

    #[test]
    fn the_line_meets_the_root() {
        assert!((compressed(LINEAR_BELOW) - float::cbrt(LINEAR_BELOW)).abs() < 1e-6);
    }
}
