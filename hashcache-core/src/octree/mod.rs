//! A linkless octree: which cells of space hold geometry, on all levels, without pointers.

pub mod block;
mod error;
mod grid;
pub mod header;
pub mod table;
mod view;

#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod cuckoo;
#[cfg(target_has_atomic = "64")]
mod mark;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod normals;
mod overlap;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod owned;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
mod partition;
#[cfg(feature = "alloc")]
mod triangles;

pub use block::BlockRef;
pub use error::{BuildError, OctreeError};
pub use grid::{BLOCK, Grid, MAP_BITS, MARGIN_BITS, MAX_RESOLUTION, MIN_RESOLUTION};
#[cfg(target_has_atomic = "64")]
pub use mark::{Added, Full, Marks};
pub use overlap::Window;
pub use view::Octree;

#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use cuckoo::buckets_for;
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use owned::{BuildSettings, OwnedOctree, build, finish};
#[cfg(all(feature = "alloc", target_has_atomic = "64"))]
pub use partition::{Partition, Serial, Workers};
#[cfg(feature = "alloc")]
pub use triangles::Triangles;
