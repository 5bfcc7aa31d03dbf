//! Laws of the octree's cells.

#[path = "octree/common.rs"]
mod common;
#[path = "octree/partition.rs"]
mod partition;
