//! A cache as the pipeline sees it: buffers and kernels, no algorithm. And the bridge for rays.

use alloc::vec::Vec;

use backend_api::{Backend, Binding, Error, HitRecord, RayRecord, TraceRays};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::{Geometry, Hit, Ray};
use crate::traits::RayCaster;

/// What a cache answers for one [`crate::record::VertexRecord`], as it stands in a buffer.
///
/// | bytes | field | meaning |
/// |---|---|---|
/// | 0..12 | `direct` | rgb |
/// | 12..16 | `direct[3]` | number of samples |
/// | 16..28 | `further` | rgb |
/// | 28..32 | `further[3]` | variance of the luminance, 0: not known |
///
/// The same bytes in WGSL: `HcEstimateRecord` of [`crate::wgsl::RECORD`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct EstimateRecord {
    /// Illumination by emitters seen directly; w: number of samples behind the answer (0: the vertex's own value).
    pub direct: [f32; 4],
    /// Illumination that arrived after a further scattering; w: variance of the luminance of all of it, 0 where it is not
    /// known.
    pub further: [f32; 4],
}

/// The stages of a cache in a frame: `prepare`, then for every batch of records `record`, then `update`, then for
/// every batch `query`. Each records dispatches; the pipeline submits.
pub trait CacheStages<B: Backend> {
    /// Creates buffers and clears what must be clear. Called once before the first frame.
    ///
    /// # Errors
    /// Those of the backend.
    fn prepare(&mut self, backend: &mut B) -> Result<(), Error>;

    /// Takes a batch of `count` vertex records (`VertexRecord`).
    ///
    /// # Errors
    /// Those of the backend.
    fn record(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), Error>;

    /// Makes everything recorded in this frame available to queries.
    ///
    /// # Errors
    /// Those of the backend.
    fn update(&mut self, backend: &mut B) -> Result<(), Error>;

    /// Answers a batch: `estimates[i]` (`EstimateRecord`) for `records[i]`.
    ///
    /// # Errors
    /// Those of the backend.
    fn query(&mut self, backend: &mut B, records: Binding, estimates: Binding, count: u32) -> Result<(), Error>;

    /// Names of the kernels behind `record`, `update` and `query`, for plans and statistics.
    fn kernels(&self) -> Vec<&'static str>;
}

/// A backend that casts rays against geometry it was given.
pub trait CastsRays: Backend {
    /// Builds the acceleration structure; replaces the one before.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Unsupported`].
    fn set_geometry(&mut self, geometry: &Geometry<'_>) -> Result<(), Error>;
}

/// A launch's rays as a [`RayCaster`], so that code written for host programs runs inside kernels.
#[derive(Clone, Copy)]
pub struct LaunchRays<'a>(
    /// What the launch offers.
    pub &'a dyn TraceRays,
);

impl RayCaster for LaunchRays<'_> {
    #[inline]
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        hit_from_record(&self.0.trace_closest(&to_record(ray)))
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.0.trace_occluded(&to_record(ray))
    }
}

/// A ray as a launch passes it.
#[inline]
pub fn to_record(ray: &Ray) -> RayRecord {
    RayRecord { origin: ray.origin.to_array(), t_min: ray.t_min, direction: ray.direction.to_array(), t_max: ray.t_max }
}

/// A ray of a launch as this crate's type.
#[inline]
pub fn from_record(ray: &RayRecord) -> Ray {
    Ray {
        origin: Vec3::from_array(ray.origin),
        t_min: ray.t_min,
        direction: Vec3::from_array(ray.direction),
        t_max: ray.t_max,
    }
}

/// A hit, or none, as a launch passes it. A miss has an infinite distance.
#[inline]
pub fn hit_to_record(hit: Option<Hit>) -> HitRecord {
    let miss = Hit { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: HitRecord::MISS, instance: HitRecord::MISS };
    let Hit { t, u, v, triangle, instance } = hit.unwrap_or(miss);
    HitRecord { t, u, v, triangle, instance }
}

/// A hit of a launch as this crate's type; `None` for a miss.
///
/// ```
/// # use hashcache_core::stages::{hit_from_record, hit_to_record};
/// assert_eq!(hit_from_record(&hit_to_record(None)), None);
/// ```
#[inline]
pub fn hit_from_record(hit: &HitRecord) -> Option<Hit> {
    let &HitRecord { t, u, v, triangle, instance } = hit;
    (triangle != HitRecord::MISS).then_some(Hit { t, u, v, triangle, instance })
}
