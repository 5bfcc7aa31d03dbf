//! A linkless octree: which cells of space hold geometry, on all levels, without pointers; and light in those cells.
//!
//! The finest level divides the scene's largest side into `resolution` cells; a cell of level `l + 1` is eight of level
//! `l`; the coarsest level is one cell. Only cells that a triangle overlaps are stored, and the partition is exact: a
//! cell is stored if and only if a triangle comes within [`Grid::margin`] of it. A cell is named by its level and
//! integer coordinates, and a lookup gives its index: a bijection between stored cells and `0..cells`, level 0 first.
//! What belongs to cells stands in plain arrays.
//!
//! # Structure
//! Cells come in [blocks](block) of 4×4×2, one bit each. A block is one entry of a [table]: its key, its 32 bits,
//! and the index of its first cell; the index of a cell is that base plus the number of bits below its own. A table a
//! level (several beyond a resolution of 4096), two buckets of four entries a key, nine entries of ten in use: a lookup
//! reads two buckets, whatever it asks for, and says "no cell" with certainty.
//!
//! # Building
//! [`build`] voxelises triangles ([`Marks`] takes any number of threads), sorts the marked blocks along a Morton curve, derives
//! the coarser levels from the finer, fills the tables, and finds each cell's largest triangle, whose normal tells its front
//! from its back. The result depends on the triangles only: not on threads, nor on how work is cut.
//! [`build_within`] chooses the largest resolution for an amount of memory.
//!
//! # Light
//! A cell keeps the running mean of its samples for each of its two sides ([`ExactCell`], 48 bytes, with their scatter;
//! [`PaperCell`], 24 bytes, with its drift). In a frame, path vertices become [samples](Sample) of 24 bytes; at its end these are sorted by place,
//! so that those of a cell stand together on every level, are summed in whole quanta, and each touched cell of each level,
//! up to the root, moves its mean once ([`merge_samples`]). [Lookups](estimate_vertices) read the level whose cells suit
//! the footprint, at a jittered place, and climb where samples are few. A wipe is a number: cells that have another
//! count as empty. [`OctreeCache`] is all that with its own memory; `kernels` and `OctreeStages` are for launchers.
//!
//! # Memory
//! Data, a cell: 48 or 24 bytes; an open frame, a record: 56 (keys, order, samples, and samples in order), 24 in
//! [`OctreeCache`]. A million cells and frames of 150 thousand records: 48 MB and 8.4 MB.
//!
//! A block takes 12 / 0.9 = 13.3 bytes and has about nine cells where surfaces are smooth: 1.4 bytes a cell, 3.4 at
//! worst with four cells a block; the normal takes 4, the data 48 or 24. While building, 16 to 32 bytes a block and four a
//! triangle come on top of tables and normals, before any data is there. The country kitchen (1,050,941 triangles) at a
//! resolution of 2048: 35.2 million cells, 49 MB of tables, 141 MB of normals, 221 MB at the peak.
//!
//! # Determinism
//! Structure: integers behind one multiplication, equal bits everywhere. Data: sums are exact and each cell is written once
//! a frame, by one item, rounded by chance that a hash of cell and counts decides; so equal bits for any number of
//! threads, order of records and cut into batches. A frame that outgrows the room it was given is merged in two parts,
//! which rounds twice.
//!
//! # Limits
//! Static geometry: another scene is another octree. At a resolution of `R` the margin is R·2⁻¹⁹ of a cell: an eighth at the
//! largest `R`. Building is for the host, in double precision; lookups are for GPUs, too (`wgsl::OCTREE`).
//!
//! # Source
//! Roth et al. 2020, section 3.1; Choi et al. 2009 (linkless octree); Akenine-Möller 2001 and Schwarz & Seidel 2010 (overlap);
//! Dietzfelbinger & Weidling 2007 (cuckoo tables with buckets).
//!
//! # Deviation
//! The paper has one table entry a cell in buckets of one, and grows the table by 1.1·1.01ⁿ; such tables cannot be filled to
//! more than half, and 4.4 bytes a cell hold a key or an index, not both, so that lookups return cells of other places. Its
//! fronts are the sides of the first rays, which depend on the order. Its coarser cells are made of finer ones; here
//! every sample goes to the side that its own normal points to on each level, which is how lookups ask. Its means round to
//! nearest and stop moving; see [`PaperCell`].

pub mod block;
mod cell;
mod cells;
mod error;
mod grid;
pub mod header;
mod lookup;
mod merge;
mod params;
mod sample;
mod scatter;
pub mod table;
mod tally;
mod view;

#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod block_list;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod cache;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod cuckoo;
#[cfg(feature = "kernels")]
pub mod kernels;
#[cfg(target_has_atomic = "64")]
mod mark;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod normals;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod overlap;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod owned;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod partition;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod size;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
mod stages;
#[cfg(feature = "alloc")]
mod triangles;
mod validate;

pub use block::BlockRef;
pub use cell::{BACK, CellRecord, ExactCell, FRONT, Layout, PaperCell, Side, Sum};
pub use cells::{ReadCells, SharedCells};
pub use error::{BuildError, OctreeError};
pub use grid::{BLOCK, Grid, MAP_BITS, MARGIN_BITS, MAX_RESOLUTION, MIN_RESOLUTION};
pub use lookup::{SALT_LOOKUP, estimate_vertices};
#[cfg(target_has_atomic = "64")]
pub use mark::{Added, Full, MAX_PROBES, Marks};
pub use merge::{MAX_SAMPLES, merge_samples};
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use overlap::Window;
pub use params::{JITTER_BITS, Light, OctreeParams, OctreeSettings};
pub use sample::{NO_SAMPLE, Sample, sample_key, sample_keys, sample_vertices};
pub use tally::{COUNTER_WORDS, add_counters, read_counters};
pub use validate::OctreeViolation;
pub use view::{NO_CELL, Octree};

#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use cache::OctreeCache;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use cuckoo::buckets_for;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use owned::{BuildSettings, OwnedOctree, build, build_within, finish};
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use partition::{Partition, Serial, Workers};
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use size::{LevelStatistics, NORMAL_BYTES, predict_bytes, resolution_for_footprint, resolution_within};
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub use stages::OctreeStages;
#[cfg(feature = "alloc")]
pub use triangles::Triangles;
