//! What crates swap: ray casting, sampling, radiance caches.

use glam::{Vec2, Vec3};

use crate::geometry::{Hit, Ray};
use crate::record::VertexRecord;

/// Casts rays against a scene.
///
/// # Laws
/// `closest` returns the hit with the smallest `t` in `(t_min, t_max)`; `occluded(r)` is `closest(r).is_some()`.
/// A ray with a component that is not finite meets nothing.
pub trait RayCaster {
    /// The nearest hit.
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything lies on the segment.
    fn occluded(&self, ray: &Ray) -> bool;
}

/// A stream of random numbers for one path: each call moves on to the next dimension.
///
/// # Laws
/// Values lie in `[0, 1)`. Two samplers started alike return the same bits.
pub trait Sampler {
    /// One number.
    fn next_1d(&mut self) -> f32;

    /// Two numbers that are stratified together where the sampler stratifies.
    fn next_2d(&mut self) -> Vec2;
}

/// A cache's answer for one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Illumination by emitters seen directly, as in [`VertexRecord::direct`].
    pub direct: Vec3,
    /// Illumination that arrived after a further scattering, as in [`VertexRecord::further`].
    pub further: Vec3,
    /// Number of samples behind the answer; 0: the cache had none, and the vertex's own value was returned.
    pub samples: u32,
}

/// A store of illumination at path vertices, for host programs that bring their own loop.
///
/// # Laws
/// Energy recorded = energy stored + energy reported lost. An estimate is finite whatever was recorded.
/// The order of `record` calls between two `end_frame`s does not change any estimate after the second.
pub trait RadianceCache {
    /// Adds a vertex's illumination.
    fn record(&mut self, vertex: &VertexRecord);

    /// Illumination at a vertex: shared where the cache has samples, else the vertex's own.
    fn estimate(&self, vertex: &VertexRecord) -> Estimate;

    /// Makes everything recorded since the last call available to `estimate`.
    fn end_frame(&mut self);
}
