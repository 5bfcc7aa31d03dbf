//! Directions about a normal in proportion to their cosine.

use core::f32::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::{Vec2, Vec3};
use hashcache_core::float;

/// A direction of the upper hemisphere (+z) with density cos θ / π: a disc's point, lifted. z is its cosine.
///
/// z is never 0: it is at least 2⁻¹³, the cosine at the disc's outermost representable ring.
///
/// # Source
/// Shirley & Chiu 1997 (square to disc, keeps neighbours together); Malley's method (Pharr et al. 2023, A.5.3).
#[inline]
pub fn sample_cosine(u: Vec2) -> Vec3 {
    let p = disc(u);
    // u < 1 in steps of 2⁻²⁴: 1 - |p|² rounds to 0 at worst.
    let z = float::sqrt((1.0 - p.length_squared()).max(SMALLEST_COSINE_SQUARED));
    Vec3::new(p.x, p.y, z)
}

/// 2⁻²⁶. Smaller: a density of 0 for a direction that was drawn. Larger: a visible bend of grazing directions.
const SMALLEST_COSINE_SQUARED: f32 = 1.0 / 67_108_864.0;

/// Density of [`sample_cosine`] by solid angle.
#[inline]
pub fn cosine_pdf(cosine: f32) -> f32 {
    cosine.max(0.0) * FRAC_1_PI
}

/// The unit disc's point for a point of the unit square; areas keep their ratio.
#[inline]
fn disc(u: Vec2) -> Vec2 {
    let p = u * 2.0 - 1.0;
    let across = p.x.abs() > p.y.abs();
    let (radius, other) = if across { (p.x, p.y) } else { (p.y, p.x) };
    if radius == 0.0 {
        return Vec2::ZERO;
    }
    let (sine, cosine) = float::sin_cos(FRAC_PI_4 * (other / radius));
    if across { Vec2::new(radius * cosine, radius * sine) } else { Vec2::new(radius * sine, radius * cosine) }
}
