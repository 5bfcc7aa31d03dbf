//! Laws of the light that an octree keeps.
#![expect(clippy::float_cmp, reason = "the laws state equal bits")]

#[path = "octree_data/cells.rs"]
mod cells;
#[path = "octree_data/drift.rs"]
mod drift;
#[path = "octree_data/laws.rs"]
mod laws;
#[path = "octree_data/lookups.rs"]
mod lookups;
#[path = "octree_data/model.rs"]
mod model;
#[path = "octree_data/room.rs"]
mod room;
#[path = "octree_data/scatter.rs"]
mod scatter;
