//! Laws of the octree's cells.

#[path = "octree/common.rs"]
mod common;
#[path = "octree/hostile.rs"]
mod hostile;
#[path = "octree/laws.rs"]
mod laws;
#[path = "octree/partition.rs"]
mod partition;
