//! A jittered spatial hash of light path vertices: vertices that fall into one cell share the mean of their light (path
//! space filtering), in constant time a vertex and without any order between them.
//!
//! ```
//! use bytemuck::Zeroable;
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::{CELL_WORDS, Params, Settings, Table, Word, vertex};
//!
//! let params = Params::new(&Settings::default())?;
//! let storage = [const { Word::new(0) }; 256 * CELL_WORDS]; // 256 cells; in practice the caller's buffer
//! let table = Table::new(&storage, &params)?;
//! table.clear();
//!
//! let dim = VertexRecord { direct: [0.5; 4], flags: VertexRecord::VALID, ..VertexRecord::zeroed() };
//! let vertices = [dim, VertexRecord { direct: [1.5; 4], ..dim }];
//! let mut counters = Counters::default();
//! vertex::claim_vertices(&table, &params, &vertices);
//! vertex::deposit_vertices(&table, &params, &vertices, &mut counters);
//! vertex::estimate_vertices(&table, &params, &vertices, &mut counters, |_, estimate| {
//!     assert_eq!((estimate.direct.x, estimate.samples), (1.0, 2));
//! });
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Concepts
//! - **Cell**: a cube of the grid on a *level* (its edge is 2^level times the smallest), for one *bin* of normals. The
//!   level follows from the vertex's footprint, so that cells look about equally large to the camera.
//! - **Key** ([`Key`]): cell, level, bin; made by [`key::key`] in integers, jittered so that borders become noise.
//! - **Tag** ([`tag`]): what the table keeps of a key: 25 bits of a second hash and the distance from home.
//! - **Claim, deposit, lookup** ([`Table`], [`vertex`]): three phases. In the first, keys take slots; in the second, light
//!   is added to exact sums; in the third, means are read. A phase may run on any number of threads.
//! - **Over time** ([`temporal`], [`merge`]): sums simply go on growing; or a frame's table is merged into a lasting one by
//!   a rule that limits, fades or wipes the history. Cells of the lasting table change their level with the camera
//!   ([`levels`]) and leave it, least worthy first, into coarser ones ([`evict`]).
//! - **Fallback**: a vertex without a cell is answered with its own value; whatever is refused, clamped or not finite is
//!   counted, so *energy recorded = stored + refused + clamped* to the last quantum.
//!
//! Start at [`Settings`], then [`vertex`] for plain functions over slices, `OwnedGrid` for a grid that brings its own
//! memory, `kernels` and `GridStages` for launchers. `examples/embed.rs` puts a grid into a foreign renderer.
//!
//! # Features
//! - `alloc`: `OwnedGrid`.
//! - `kernels`: the `kernels` module (host bodies and WGSL) and `GridStages`; on targets with 64-bit atomics.
//!
//! Without features nothing allocates. Where 64-bit atomics are missing, [`Word`] is a pair of 32-bit ones of the same bytes.
//!
//! # Memory
//! 64 bytes a cell in the standard [`layout`], a line of the memory's caches; 32 in the smallest, and what else a cell may
//! hold is chosen by type and listed there, byte by byte. A power of two of cells. A table of 64-byte cells of n keys at load a takes
//! 64·n/a bytes: half a million keys at load 0.5 are 2²⁰ cells, 64 MiB. A frame of w×h pixels with cells of
//! c×c footprints on surfaces has about 4·w·h/c² keys at first vertices (cells are between c/2 and c wide), and at least as
//! many again after a bounce. Healthy: load up to 0.7, mean distance from home ([`validate::Summary`]) below 2.
//! Kernels for GPUs reach the 128 MiB that every device binds: 2²¹ cells.
//!
//! # Determinism
//! Keys are integers after one exact multiplication; layout and refusals depend on the set of claimed keys, sums on the
//! multiset of deposits. Equal input bits give equal tables on every machine, for every number of threads and every
//! order. Means are one division away and equal on one machine. Batches claimed after other batches were
//! deposited come second: with a table too full for both, the cut into batches tells who is refused.
//!
//! # Limits today
//! The kernels work on the standard layout and integrate over time; other layouts and rules are for the host. Diffuse
//! light only (a key knows no direction of view); a table does not grow; cells with few vertices are not helped by their
//! neighbours; at most 2³⁰ deposits a cell.
//!
//! # Source
//! Binder, Fricke and Keller, *Massively Parallel Path Space Filtering*, sections 3.1 and 3.2. Deviations: sizes are
//! powers of two (exact), the origin is shifted by a third of the coarsest cell (axis-aligned walls miss the borders),
//! claim and deposit are two phases (no influence of order), a mean is an exact sum, and the fingerprint has 25 bits instead
//! of 32, compared among keys of one home only: of half a million keys in a table of a million cells, two share a cell
//! in one table of 250.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod cell;
pub mod evict;
pub mod jitter;
pub mod key;
pub mod layout;
pub mod levels;
pub mod merge;
pub mod names;
pub mod params;
pub mod sums;
pub mod table;
pub mod tag;
pub mod temporal;
pub mod validate;
pub mod vertex;
mod word;

#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub mod kernels;
#[cfg(feature = "alloc")]
mod owned;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
mod stages;

pub use key::Key;
#[cfg(feature = "alloc")]
pub use owned::OwnedGrid;
pub use params::{Params, Settings};
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub use stages::GridStages;
pub use table::{CELL_WORDS, Cell, Claim, Table};
pub use word::Word;
