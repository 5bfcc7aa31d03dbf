//! Light that arrives from lights without extent.

use glam::Vec3;
use hashcache_core::float;

use super::{LightSample, luminance};
use crate::scene::PunctualLight;

impl PunctualLight {
    /// The light as seen from `from`, or `None` where it does not shine.
    ///
    /// # Source
    /// glTF light extension: inverse square law, the recommended fading towards `range`, and the square of a linear
    /// ramp in the cosine between a spot's two cones.
    ///
    /// # Deviation
    /// Equal cones make a hard edge; the extension's formula widens it by 0.001 in the cosine.
    #[inline]
    pub fn sample(&self, from: Vec3) -> Option<LightSample> {
        let [px, py, pz, _] = self.position;
        let [dx, dy, dz, inner] = self.direction;
        let [r, g, b, outer] = self.intensity;
        let [range, pdf, ..] = self.range;
        let along = Vec3::new(dx, dy, dz);
        let brought = |direction: Vec3, target: Option<Vec3>, factor: f32| {
            let radiance = Vec3::new(r, g, b) * factor;
            let seen = pdf > 0.0 && radiance != Vec3::ZERO && radiance.is_finite();
            seen.then_some(LightSample { direction, target, radiance, pdf, is_delta: true })
        };
        if self.is_directional() {
            return brought(-along, None, 1.0);
        }
        let position = Vec3::new(px, py, pz);
        let to = position - from;
        let squared = to.length_squared();
        let distance = float::sqrt(squared);
        let direction = to / distance;
        let mut factor = 1.0 / squared;
        if range > 0.0 {
            let ratio = distance / range;
            factor *= (1.0 - ratio * ratio * ratio * ratio).max(0.0);
        }
        if self.is_spot() {
            factor *= falloff(-along.dot(direction), inner, outer);
        }
        brought(direction, Some(position), factor)
    }

    /// Power over π by luminance; `squared` is the squared radius of a sphere about the scene, through which
    /// directional light shines.
    #[cfg_attr(not(feature = "alloc"), expect(dead_code, reason = "light lists need an allocator"))]
    pub(super) fn power_over_pi(&self, squared: f64) -> f64 {
        let [r, g, b, outer] = self.intensity;
        let strength = f64::from(luminance(Vec3::new(r, g, b)));
        if self.is_directional() {
            return strength * squared;
        }
        // A cone's solid angle over π is twice 1 − cosine; a spot's is taken half-way between its cones.
        let inner = if self.is_spot() { self.direction[3].max(outer) } else { -1.0 };
        let outer = if self.is_spot() { outer } else { -1.0 };
        strength * (2.0 - f64::from(inner) - f64::from(outer))
    }
}

/// Share of a spot's intensity at an angle of this cosine, between cones of these cosines.
#[inline]
fn falloff(cosine: f32, inner: f32, outer: f32) -> f32 {
    if cosine >= inner {
        1.0
    } else if cosine <= outer {
        0.0
    } else {
        let ramp = (cosine - outer) / (inner - outer);
        ramp * ramp
    }
}
