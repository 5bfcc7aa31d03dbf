//! The core's octree: marks in borrowed words, light as samples, and with an allocator, a whole one.

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, AtomicU64};

use hashcache_core::counters::Counters;
use hashcache_core::glam::Vec3;
use hashcache_core::octree::block::{block_key, cell_bit, from_morton, key_block, morton};
use hashcache_core::octree::{
    Added, BACK, COUNTER_WORDS, CellRecord, Grid, Marks, NO_SAMPLE, Octree, OctreeError, OctreeParams, OctreeSettings,
    PaperCell, Sum, add_counters, read_counters, sample_key, sample_vertices,
};
use hashcache_core::record::VertexRecord;

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
    light(checks, &grid);
    checks.that("Octree::new: bad", matches!(Octree::new(&[0; 16]), Err(OctreeError::Header)));
    #[cfg(feature = "alloc")]
    owned(checks);
}

/// Samples, layouts and counters, which need no allocator.
fn light(checks: &mut Checks, grid: &Grid) {
    let bad = OctreeSettings { cell: black_box(-1.0), ..OctreeSettings::default() };
    checks.that("OctreeParams::new: bad", OctreeParams::new(&bad).is_err());
    let Ok(params) = OctreeParams::new(&OctreeSettings::default()) else {
        return checks.that("OctreeParams::new", false);
    };
    let vertex = VertexRecord {
        position_footprint: black_box([0.5, 0.5, 0.5, 0.01]),
        further: [1.0, 0.5, 0.0, 0.0],
        flags: VertexRecord::VALID,
        ..bytemuck::Zeroable::zeroed()
    };
    let mut counters = Counters::default();
    let mut right = false;
    sample_vertices(grid, &params, &[vertex], &mut counters, |_, sample| {
        let key = sample_key(grid, &sample, 0);
        right = sample.place() == [74, 74, 74] && sample.sums() == [1 << 20, 1 << 19, 0] && key != NO_SAMPLE;
    });
    checks.that("sample_vertices", right && counters.deposits == 1 && counters.balance() == 0);
    let shared: [AtomicU32; COUNTER_WORDS] = core::array::from_fn(|_| AtomicU32::new(0));
    add_counters(&shared, &counters);
    checks.that("read_counters", read_counters(&shared) == counters);
    let mean = [0.5, 0.25, 2.0].map(|v| Sum::new(black_box(v), 0.0));
    let mut cell = PaperCell::empty(0, 0);
    cell.put(BACK, params.quantum(), mean, 7, [0; 3]);
    let side = cell.side(BACK, params.quantum());
    checks.that("PaperCell", side.count == 7 && side.mean.map(f32::to_bits) == mean.map(|sum| sum.value.to_bits()));
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
        ..Geometry::default()
    };
    let settings = BuildSettings { resolution: 64, ..BuildSettings::default() };
    let Ok(built) = build_within(&geometry, &settings, &Serial) else { return checks.that("octree::build", false) };
    let octree = built.view();
    checks.that("Octree::validate", octree.validate().is_ok());
    let cell = octree.coordinates(Vec3::new(0.2, 0.3, 0.0));
    checks.that("Octree::cell", cell.and_then(|cell| octree.cell(0, cell)).is_some());
    checks.that("Octree::cell: none", octree.cell(0, [0; 3]).is_none());
    let statistics = octree.statistics(0, 48);
    checks.that("Octree::statistics", statistics.cells > 1000 && statistics.table_bytes < 4 * 1500);
    cache(checks, built);
}

/// Light in an octree of its own memory.
#[cfg(feature = "alloc")]
fn cache(checks: &mut Checks, built: hashcache_core::octree::OwnedOctree) {
    use hashcache_core::octree::{ExactCell, OctreeCache};
    use hashcache_core::traits::RadianceCache;

    let settings = OctreeSettings { min_samples: 1, ..OctreeSettings::default() };
    let Ok(params) = OctreeParams::new(&settings) else { return checks.that("OctreeParams::new", false) };
    let mut cache = OctreeCache::<ExactCell>::new(built, params);
    let vertex = VertexRecord {
        position_footprint: black_box([0.2, 0.3, 0.0, 0.001]),
        further: [1.5; 4],
        flags: VertexRecord::VALID,
        ..bytemuck::Zeroable::zeroed()
    };
    cache.record(&vertex);
    cache.end_frame();
    checks.that("OctreeCache::estimate", cache.estimate(&vertex).further == Vec3::splat(1.5));
    cache.wipe();
    checks.that("OctreeCache::wipe", cache.estimate(&vertex).samples == 0 && cache.counters().balance() == 0);
}
