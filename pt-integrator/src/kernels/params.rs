//! Parameter blocks.

use bytemuck::{Pod, Zeroable};

use crate::camera::CameraRays;
use crate::path::{PathSettings, VertexSettings};

/// Parameters of [`super::TRACE_FILM`] and [`super::trace_records`]. 96 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TraceParams {
    /// The camera's rays.
    pub camera: CameraRays,
    /// Pixels a row of the picture, above 0.
    pub width: u32,
    /// Pixel of item 0.
    pub first_pixel: u32,
    /// Index of the first sample of every pixel. Samples 0..N of one seed are stratified together.
    pub first_sample: u32,
    /// Samples a pixel; [`super::trace_records`] take one whatever this says.
    pub samples: u32,
    /// Seed of all random numbers.
    pub seed: u32,
    /// [`PathSettings::max_bounces`].
    pub max_bounces: u32,
    /// [`PathSettings::roulette_depth`].
    pub roulette_depth: u32,
    /// [`VertexSettings::length`] of [`super::trace_records`]; `u32::MAX`: records hold all that pixels need.
    pub store_length: u32,
}

impl TraceParams {
    /// Limits of the paths.
    #[inline]
    pub const fn settings(&self) -> PathSettings {
        PathSettings { max_bounces: self.max_bounces, roulette_depth: self.roulette_depth }
    }

    /// Column and row of a pixel.
    #[inline]
    pub(super) const fn pixel(&self, index: u32) -> [u32; 2] {
        [index % self.width, index / self.width]
    }

    /// Limits of paths whose vertices are kept.
    #[inline]
    pub const fn vertex_settings(&self) -> VertexSettings {
        VertexSettings { path: self.settings(), length: self.store_length }
    }
}
