//! Which rays are cast, and at what scale.

use hashcache_core::geometry::Ray;

/// Whether a ray can meet anything: all finite, a direction of at least 2⁻¹²⁶, an interval (its end may be infinite).
#[inline(always)]
pub(super) fn is_usable(ray: &Ray) -> bool {
    ray.origin.is_finite()
        && ray.direction.is_finite()
        && ray.direction.abs().max_element() >= f32::MIN_POSITIVE
        && ray.t_min < ray.t_max
}

/// 2¹⁶: lengths from one over this to this are used as they are.
const RANGE: f32 = 65536.0;

/// Whether a direction's largest component, or a map's, leaves room for the products of the triangle test.
#[inline(always)]
pub(super) fn is_within_range(x: f32) -> bool {
    (1.0 / RANGE..=RANGE).contains(&x)
}

/// The same ray with a direction of a length near 1, and the factor that takes its distances back: a power of two, so
/// that nothing is rounded.
#[cold]
pub(super) fn rescaled(ray: &Ray) -> (Ray, f32) {
    let power = |e: i32| f32::from_bits(((e.clamp(-126, 127) + 127) as u32) << 23);
    let exponent = (ray.direction.abs().max_element().to_bits() >> 23) as i32 - 127;
    let (down, up) = (power(-exponent), power(exponent));
    let scaled =
        Ray { origin: ray.origin, t_min: ray.t_min * up, direction: ray.direction * down, t_max: ray.t_max * up };
    (scaled, down)
}
