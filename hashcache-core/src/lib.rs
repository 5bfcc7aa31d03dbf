//! The vocabulary that all hashcache crates share: numbers with the same bits everywhere, plain geometry, path
//! vertices, sums that do not depend on order, and the traits by which crates are swapped.
//!
//! ```
//! use hashcache_core::exact::{Quantum, mean, quantize};
//! use hashcache_core::glam::Vec3;
//! use hashcache_core::hash::pcg3d;
//! use hashcache_core::level::level_from_footprint;
//! use hashcache_core::pack::octahedral_encode;
//!
//! let level = level_from_footprint(0.09, 100.0); // a pixel of 9 cm over cells of 1 cm: cells of 2³ cm
//! let slot = pcg3d([17, level, octahedral_encode(Vec3::Y)])[0] & 0xffff;
//! let q = Quantum::for_scale(15.0); // a scene whose strongest light has a radiance of 15
//! let sum = quantize(q, 0.25).value + quantize(q, 0.75).value; // in any order, on any thread
//! assert_eq!((level, slot, mean(q, sum, 2)), (3, 49_265, 0.5));
//! ```
//!
//! # Concepts
//!
//! - **Illumination** is incident light weighted by the albedo-free BRDF times cosine. A path's vertex that a cache
//!   may hold is a [`record::VertexRecord`]; it keeps light that arrives directly apart from light that arrives after
//!   a further bounce.
//! - **Footprint**: path length × the pixel's angle, in scene units. [`level`] turns it into a level of detail.
//! - **Keys** are integers: [`hash`] and [`pack`] make slots and fingerprints from cell, level and normal.
//! - **Exact sums** ([`exact`]): light is rounded once, to a multiple of a quantum, then integers are added.
//! - **Energy recorded = energy stored + energy reported lost**: [`counters`] says where it went.
//! - **Traits** ([`traits`]): ray casting, sampling, caches; each with its law and a toy that implements it.
//!   With feature `kernels`, `stages` holds a cache's face towards a pipeline of buffers and kernels.
//! - **Twins**: every integer function has a WGSL twin (`wgsl`, feature `kernels`) with the same name behind `hc_`.
//!
//! # Features
//!
//! Both are additive and off by default; without them the crate needs neither `std` nor an allocator.
//!
//! | feature | adds |
//! |---|---|
//! | `alloc` | nothing here; the one switch that crates above pass on |
//! | `kernels` | `stages` and `wgsl`, on top of `backend-api`; implies `alloc` |
//!
//! # Memory
//!
//! The crate owns none. Records have fixed sizes:
//!
//! | type | bytes |
//! |---|---|
//! | [`record::VertexRecord`] | 96 |
//! | `stages::EstimateRecord` | 32 |
//! | [`counters::Counters`] | 144 |
//! | [`geometry::Instance`], [`geometry::OpacityMask`] | 64 |
//! | an exact sum | 8 |
//!
//! A batch of vertices of a 1920×1080 frame: 2,073,600 × 96 = 199 MB of records, 66 MB of estimates; hence batches.
//!
//! # Determinism
//!
//! The same input bits give the same output bits on every machine, in three tiers. Tier 0, integers ([`hash`],
//! [`level`] after its one multiplication, [`pack`] except the octahedral floats, [`exact`] except the division in
//! `mean`): equal bits on GPUs too. Tier 1, + − × ÷ √: equal bits on processors, a rounding step apart on GPUs.
//! Tier 2 ([`float`]): equal bits on processors, since the functions are libm's own; no WGSL twin.
//!
//! # Limits
//!
//! - Radiance is resolved to L0·2⁻²⁰ and clamped at L0·2¹³ with one L0 = 2^e for a table. A scene whose lamps are
//!   10⁶ times brighter than what they light loses the dark part to rounding; [`counters`] shows how much.
//! - 2³⁰ deposits fit one sum.
//! - Levels reach from 0 to 31.
//! - Directions are kept to 0.004°.
//!
//! # Sources
//!
//! Keys of `REFERENCES.md`: Jarzynski & Olano 2020 and O'Neill 2014 (PCG hashes), Appleby 2011 (`MurmurHash3`),
//! Meyer et al. 2010 and Cigolle et al. 2014 (octahedral directions), Binder et al. 2021 (keys, levels, fingerprints).
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod counters;
pub mod error;
pub mod exact;
pub mod float;
pub mod geometry;
pub mod hash;
pub mod jitter;
pub mod level;
pub mod octree;
pub mod pack;
pub mod record;
pub mod texel;
pub mod traits;

#[cfg(feature = "kernels")]
pub mod stages;
#[cfg(feature = "kernels")]
pub mod wgsl;

pub use glam;
