//! Path tracing that records its vertices: camera, samplers, BSDFs, lights.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod camera;
pub mod film;
#[cfg(feature = "kernels")]
pub mod kernels;
pub mod light;
pub mod packed;
pub mod path;
pub mod ray;
pub mod sampler;
pub mod sampling;
pub mod scene;
pub mod surface;
pub mod texture;
pub mod view;
#[cfg(feature = "kernels")]
pub mod wgsl;

pub use hashcache_core::glam;
