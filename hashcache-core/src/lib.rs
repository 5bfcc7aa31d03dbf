//! Shared vocabulary of hashcache: numbers, geometry, packing, exact sums, traits.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod counters;
pub mod error;
pub mod exact;
pub mod float;
pub mod geometry;
pub mod hash;
pub mod level;
pub mod pack;
pub mod record;
pub mod traits;

#[cfg(feature = "kernels")]
pub mod stages;
#[cfg(feature = "kernels")]
pub mod wgsl;

pub use glam;
