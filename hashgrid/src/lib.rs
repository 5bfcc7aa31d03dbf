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
//! - **Fallback**: a vertex without a cell is answered with its own value; whatever is refused, clamped or not finite is
//!   counted, so *energy recorded = stored + refused + clamped* to the last quantum.
//!
//! Start at [`Settings`], then [`vertex`] for plain functions over slices, `OwnedGrid` for a grid that brings its own
//! memory, `kernels` and `GridStages` for launchers. `examples/embed.rs` puts a grid into a foreign renderer.
//!
//! # Pieces
//! Each is a module or a type parameter; what a program leaves out costs it neither bytes nor instructions.
//!
//! | piece | what for |
//! |---|---|
//! | [`layout`] | what a cell holds: one sum or two, squares, changes, a stamp, the whole key: 32 to 112 bytes |
//! | [`sums`] | means and their standard error, exact shares |
//! | [`names`] | whole keys: no false match at all |
//! | [`temporal`], [`merge`] | a frame's table blended into a lasting one: integration, fixed count, moving average, adaptive |
//! | [`levels`] | light handed on when places change their level with the camera |
//! | [`evict`] | cells that leave between frames, into coarser ones |
//! | [`few`] | cells with few vertices: neighbours, several levels at once, the level by its error |
//! | [`similar`] | normals found by probing instead of kept apart |
//! | [`lobe`], [`keyed`] | directions and layers in the key, keys of the caller's making |
//! | [`points`] | light at implicit points instead of cells |
//!
//! # Features
//! - `alloc`: `OwnedGrid`.
//! - `kernels`: the `kernels` module (host bodies and WGSL) and `GridStages`; on targets with 64-bit atomics.
//!
//! Without features nothing allocates. Where 64-bit atomics are missing, [`Word`] is a pair of 32-bit ones of the same bytes.
//!
//! # Memory
//! 64 bytes a cell in the standard [`layout`], a line of the memory's caches where storage
//! begins at one; 32 in the smallest, up to 112 with all
//! options, each listed there with its bytes. A power of two of cells. A standard table of n keys at load a takes
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
//! Kernels exist for the standard layout, which integrates over time; the other pieces are for the host (keys, levels and
//! points have WGSL bodies to build on). A table does not grow. At most 2³⁰ deposits a cell. No vertices in media. Each
//! piece tells its own.
//!
//! # Source
//! Binder, Fricke and Keller, *Massively Parallel Path Space Filtering*, sections 3.1 to 3.4; Delaere 2021 for [`points`]. Deviations: sizes are
//! powers of two (exact), the origin is shifted by a third of the coarsest cell (axis-aligned walls miss the borders),
//! claim and deposit are two phases (no influence of order), a mean is an exact sum, and the fingerprint has 25 bits instead
//! of 32, compared among keys of one home only: of half a million keys in a table of a million cells, two share a cell
//! in one table of 250; where that is too often, cells keep [whole keys](names).
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod batch;
mod cell;
pub mod evict;
pub mod few;
pub mod jitter;
pub mod key;
pub mod keyed;
mod lanes;
pub mod layout;
pub mod levels;
pub mod lobe;
pub mod merge;
pub mod names;
pub mod params;
pub mod points;
pub mod similar;
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
