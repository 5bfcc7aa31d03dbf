//! Rays and hits as a launch passes them: plain records, one virtual call a ray.

use bytemuck::{Pod, Zeroable};

/// A ray segment `origin + t·direction`, `t_min < t < t_max`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RayRecord {
    /// Origin in scene units.
    pub origin: [f32; 3],
    /// Smallest accepted distance, in units of the direction's length.
    pub t_min: f32,
    /// Direction, of any length above 0.
    pub direction: [f32; 3],
    /// Largest accepted distance, in units of the direction's length.
    pub t_max: f32,
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HitRecord {
    /// Distance in units of the direction's length.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex.
    pub v: f32,
    /// Index of the triangle in the geometry's list, or [`HitRecord::MISS`].
    pub triangle: u32,
    /// Index of the instance in the geometry's list.
    pub instance: u32,
}

impl HitRecord {
    /// `triangle` of a ray that met nothing.
    pub const MISS: u32 = u32::MAX;
}

/// Ray casting as a launch offers it to a kernel's host body.
///
/// # Laws
/// `trace_closest` finds the hit with the smallest `t` in `(t_min, t_max)`; `trace_occluded` tells whether there is one.
/// A ray with a component that is not finite (`t_max` may be infinite) meets nothing.
///
/// ```
/// use backend_api::{HitRecord, RayRecord, TraceRays};
///
/// /// The plane y = 0.
/// struct Ground;
///
/// impl TraceRays for Ground {
///     fn trace_closest(&self, ray: &RayRecord) -> HitRecord {
///         let t = -ray.origin[1] / ray.direction[1];
///         let hit = t > ray.t_min && t < ray.t_max;
///         let triangle = if hit { 0 } else { HitRecord::MISS };
///         HitRecord { t, u: 0.0, v: 0.0, triangle, instance: 0 }
///     }
///
///     fn trace_occluded(&self, ray: &RayRecord) -> bool {
///         self.trace_closest(ray).triangle != HitRecord::MISS
///     }
/// }
///
/// let down = RayRecord { origin: [0.0, 3.0, 0.0], t_min: 0.0, direction: [0.0, -2.0, 0.0], t_max: 10.0 };
/// assert_eq!(Ground.trace_closest(&down).t, 1.5);
/// assert!(!Ground.trace_occluded(&RayRecord { t_max: 1.0, ..down }));
/// ```
pub trait TraceRays: Sync {
    /// The nearest hit, or a record whose `triangle` is [`HitRecord::MISS`].
    fn trace_closest(&self, ray: &RayRecord) -> HitRecord;

    /// Whether anything lies between `t_min` and `t_max`.
    fn trace_occluded(&self, ray: &RayRecord) -> bool;
}
