//! Shared vocabulary of hashcache: numbers, geometry, packing, exact sums, traits.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod geometry;
pub mod record;
pub mod traits;

#[cfg(feature = "kernels")]
pub mod stages;

pub use glam;
