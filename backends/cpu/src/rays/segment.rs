//! A ray made ready for boxes and triangles.

use hashcache_core::geometry::Ray;

/// A ray's constants. Distances are in units of the direction's length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) origin: [f32; 3],
    pub(super) direction: [f32; 3],
    /// 1/direction, made smaller by [`MARGIN`] for the near planes and larger for the far ones.
    pub(super) inverse_near: [f32; 3],
    pub(super) inverse_far: [f32; 3],
    /// For each axis, whether the ray runs towards lower values, so that the near plane is the upper one.
    pub(super) backwards: [bool; 3],
    /// The direction's two smaller components and its largest.
    pub(super) axes: [usize; 3],
    /// Direction over its largest component for the smaller two, and one over the largest.
    pub(super) shear: [f32; 3],
    pub(super) t_min: f32,
    pub(super) t_max: f32,
}

/// How much a box is widened, as a part of its distance along each axis: 2⁻²¹, 8 half-units in the last place.
///
/// Source of the need: three roundings for a plane's distance, four for a corner in the triangle test. Less, and a ray
/// may miss the box of a triangle that it meets; more only costs visits.
const MARGIN: f32 = 1.0 / 2_097_152.0;

impl Segment {
    /// Constants of a ray whose direction's largest component lies between 2⁻³² and 2³².
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let [x, y, z] = ray.direction.abs().to_array();
        let kz = if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
        let (kx, ky) = ([1, 2, 0][kz], [2, 0, 1][kz]);
        let inverse = d.map(|d| 1.0 / d);
        // Behind the origin the margin would narrow boxes.
        let margin = if ray.t_min < 0.0 { 0.0 } else { MARGIN };
        Self {
            origin: ray.origin.to_array(),
            direction: d,
            inverse_near: inverse.map(|i| i * (1.0 - margin)),
            inverse_far: inverse.map(|i| i * (1.0 + margin)),
            backwards: d.map(f32::is_sign_negative),
            axes: [kx, ky, kz],
            shear: [d[kx] * inverse[kz], d[ky] * inverse[kz], inverse[kz]],
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }
}

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
