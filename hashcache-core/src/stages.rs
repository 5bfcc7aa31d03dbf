//! A cache as the pipeline sees it: buffers and kernels, no algorithm. And the bridge for rays.

use alloc::vec::Vec;

use backend_api::{Backend, Binding, Error, HitRecord, RayRecord, TraceRays};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::{Geometry, Hit, Ray};
use crate::traits::RayCaster;

/// What a cache answers for one [`crate::record::VertexRecord`], as it stands in a buffer (32 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct EstimateRecord {
    /// Illumination by emitters seen directly; w: number of samples behind the answer (0: the vertex's own value).
    pub direct: [f32; 4],
    /// Illumination that arrived after a further scattering; w is 0.
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
        let hit = self.0.trace_closest(&to_record(ray));
        (hit.triangle != HitRecord::MISS).then_some(Hit {
            t: hit.t,
            u: hit.u,
            v: hit.v,
            triangle: hit.triangle,
            instance: hit.instance,
        })
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.0.trace_occluded(&to_record(ray))
    }
}

#[inline]
fn to_record(ray: &Ray) -> RayRecord {
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
