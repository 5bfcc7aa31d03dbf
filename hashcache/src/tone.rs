//! From radiance to what a screen shows.

use hashcache_core::float::{exp2, powf};

use crate::choice::ToneCurve;

/// How radiance becomes the bytes of a PNG: exposure, then a curve, then the sRGB encoding.
///
/// ```
/// use hashcache::ToneMapping;
/// use hashcache::choice::ToneCurve;
///
/// let plain = ToneMapping::default();
/// assert!((plain.encode(0.5) - 0.735_357).abs() < 1e-6);
/// assert_eq!(plain.encode(3.0), plain.encode(1.0)); // what is above 1 is clipped
/// let stops = ToneMapping { exposure: -2.0, ..plain };
/// assert_eq!(stops.encode(2.0), plain.encode(0.5));
/// let filmic = ToneMapping { curve: ToneCurve::Filmic, ..plain };
/// assert!(filmic.encode(1.0) < filmic.encode(3.0)); // bright light keeps its shape
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMapping {
    /// Stops: radiance is multiplied by 2 to the power of this.
    pub exposure: f32,
    /// What comes between exposure and encoding.
    pub curve: ToneCurve,
}

impl Default for ToneMapping {
    /// No stops, clipped.
    fn default() -> Self {
        Self { exposure: 0.0, curve: ToneCurve::Srgb }
    }
}

impl ToneMapping {
    /// The encoded value in `[0, 1]` of a channel's radiance. Negative radiance and NaN become 0, infinite becomes the
    /// largest.
    pub fn encode(self, radiance: f32) -> f32 {
        let exposed = radiance * exp2(self.exposure);
        srgb_encode(match self.curve {
            ToneCurve::Srgb => exposed,
            ToneCurve::Filmic => filmic(exposed),
        })
    }

    /// The same as a byte, rounded to the nearest.
    pub fn byte(self, radiance: f32) -> u8 {
        (self.encode(radiance) * 255.0 + 0.5) as u8
    }
}

/// A film's response: a toe that darkens shadows a little, a shoulder that brings bright light below 1.
///
/// From a radiance of 7.24 on it is above 1, which the encoding clips.
///
/// # Source
/// Narkowicz 2016, a fit to the ACES reference and output transforms, without their factor of 0.6 on exposure.
fn filmic(x: f32) -> f32 {
    // Far beyond, squares would be infinite.
    let x = x.clamp(0.0, 16.0);
    (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)
}

/// The sRGB encoding of a linear value, clipped to `[0, 1]`; NaN becomes 0.
///
/// # Source
/// IEC 61966-2-1.
pub fn srgb_encode(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x.is_nan() {
        0.0
    } else if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * powf(x, 1.0 / 2.4) - 0.055
    }
}

/// The linear value of an sRGB-encoded one in `[0, 1]`.
///
/// # Source
/// IEC 61966-2-1.
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { powf((encoded + 0.055) / 1.055, 2.4) }
}
