//! Path tracing that records its vertices: camera, samplers, BSDFs, lights.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod scene;

pub use hashcache_core::glam;
