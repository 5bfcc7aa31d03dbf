//! The core's octree: marks in borrowed words, and with an allocator, a whole one.

use core::hint::black_box;
use core::sync::atomic::AtomicU64;

use hashcache_core::glam::Vec3;
use hashcache_core::octree::block::{block_key, cell_bit, from_morton, key_block, morton};
use hashcache_core::octree::{Added, Grid, Marks, Octree, OctreeError};

use crate::checks::Checks;

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    let Ok(grid) = Grid::new(Vec3::ZERO, black_box(Vec3::ONE), 64) else { return checks.that("Grid::new", false) };
    checks.that("Grid::coordinates", grid.coordinates(Vec3::splat(black_box(0.5))) == Some([74, 74, 74]));
    checks.that("Grid::side", grid.side(grid.levels - 1) == 1 && grid.level_corner(2) == [8, 8, 10]);
    let words: [AtomicU64; 8] = core::array::from_fn(|_| AtomicU64::new(0));
    let marks = Marks::new(&words);
    let bit = cell_bit(black_box([5, 6, 7]));
    checks.that("Marks::mark: new", marks.mark([1, 1, 3], bit) == Ok(Added { blocks: 1, cells: 1 }));
    checks.that("Marks::mark: known", marks.mark([1, 1, 3], bit) == Ok(Added::default()));
    let key = block_key([1, 1, 3]);
    checks.that("Marks::blocks", marks.blocks().eq([(key, bit)]));
    checks.that("block::morton", from_morton(morton(key)) == key && key_block(key) == [1, 1, 3]);
    checks.that("Octree::new: bad", matches!(Octree::new(&[0; 16]), Err(OctreeError::Header)));
    #[cfg(feature = "alloc")]
    owned(checks);
}

#[cfg(feature = "alloc")]
fn owned(checks: &mut Checks) {
    use hashcache_core::geometry::{Geometry, Instance, Mesh};
    use hashcache_core::octree::{BuildSettings, Serial, build_within};

    let geometry = Geometry {
        positions: black_box(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        indices: &[[0, 1, 2]],
        meshes: &[Mesh { first_triangle: 0, triangle_count: 1 }],
        instances: &[Instance::identity(0)],
    };
    let settings = BuildSettings { resolution: 64, ..BuildSettings::default() };
    let Ok(built) = build_within(&geometry, &settings, &Serial) else { return checks.that("octree::build", false) };
    let octree = built.view();
    checks.that("Octree::validate", octree.validate().is_ok());
    let cell = octree.coordinates(Vec3::new(0.2, 0.3, 0.0));
    checks.that("Octree::cell", cell.and_then(|cell| octree.cell(0, cell)).is_some());
    checks.that("Octree::cell: none", octree.cell(0, [0; 3]).is_none());
    let statistics = octree.statistics(0, 40);
    checks.that("Octree::statistics", statistics.cells > 1000 && statistics.table_bytes < 4 * 1500);
}
