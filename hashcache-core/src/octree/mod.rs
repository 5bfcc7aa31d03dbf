//! A linkless octree: which cells of space hold geometry, on all levels, without pointers.

pub mod block;
mod cell;
mod cells;
mod deposit;
mod error;
mod grid;
pub mod header;
mod lookup;
mod merge;
mod params;
mod pending;
mod sample;
pub mod table;
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
pub use deposit::deposit_samples;
pub use error::{BuildError, OctreeError};
pub use grid::{BLOCK, Grid, MAP_BITS, MARGIN_BITS, MAX_RESOLUTION, MIN_RESOLUTION};
pub use lookup::{SALT_LOOKUP, estimate_vertices};
#[cfg(target_has_atomic = "64")]
pub use mark::{Added, Full, MAX_PROBES, Marks};
pub use merge::merge_entries;
pub use overlap::Window;
pub use params::{JITTER_BITS, Light, OctreeParams, OctreeSettings};
pub use pending::{ENTRY_WORDS, HEAD_WORDS, MAX_RECORDS, Pending};
pub use validate::OctreeViolation;
pub use sample::{NO_SAMPLE, Sample, sample_key, sample_vertices};
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
