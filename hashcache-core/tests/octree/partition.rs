//! Exactly the cells that triangles overlap are stored.

use std::collections::HashSet;

use hashcache_core::glam::Vec3;
use hashcache_core::octree::Octree;
use proptest::prelude::*;

use crate::common::{Scene, overlaps};

/// Every cell of the finest level against the model.
fn check_finest(octree: &Octree<'_>, triangles: &[[Vec3; 3]]) {
    let grid = octree.grid();
    let (side, margin) = (grid.side(0), grid.margin());
    for z in 0..side {
        for y in 0..side {
            for x in 0..side {
                let cell = [x, y, z];
                let stored = octree.cell(0, cell).is_some();
                let touched = |margin: f64| triangles.iter().any(|t| overlaps(grid, t, cell, margin));
                if stored {
                    assert!(touched(2.0 * margin), "{cell:?} is stored, and no triangle is near: {triangles:?}");
                } else {
                    assert!(!touched(0.0), "{cell:?} is missing: {triangles:?}");
                }
            }
        }
    }
}

/// Parents of all cells exist, no others do, and indices are the numbers from 0 on.
fn check_levels(octree: &Octree<'_>) {
    let mut indices = HashSet::new();
    let mut finer: HashSet<[u32; 3]> = HashSet::new();
    for level in 0..octree.grid().levels {
        let mut cells = HashSet::new();
        for block in octree.blocks(level) {
            for (cell, index) in block.cells() {
                assert_eq!(octree.cell(level, cell), Some(index));
                assert!(octree.level_range(level).contains(&index));
                assert!(indices.insert(index) && cells.insert(cell));
            }
        }
        assert_eq!(cells.len(), octree.level_range(level).len());
        if level > 0 {
            assert_eq!(cells, finer.iter().map(|cell| cell.map(|c| c >> 1)).collect::<HashSet<_>>());
        }
        finer = cells;
    }
    assert_eq!(indices.len(), octree.cells() as usize);
    assert_eq!(finer, HashSet::from([[0; 3]]));
}

fn corner() -> impl Strategy<Value = Vec3> {
    // Multiples of 1/8 give edges along axes, faces in planes, and triangles without area.
    let free = prop::array::uniform3(-1.0_f32..1.0);
    let lattice = prop::array::uniform3((-8_i32..=8).prop_map(|v| v as f32 / 8.0));
    prop_oneof![free, lattice].prop_map(Vec3::from_array)
}

fn triangles() -> impl Strategy<Value = Vec<[Vec3; 3]>> {
    let triangle = (prop::array::uniform3(corner()), prop_oneof![Just(1.0_f32), Just(0.05), Just(1e-6)], corner())
        .prop_map(|(corners, size, at)| corners.map(|corner| corner * size + at));
    prop::collection::vec(triangle, 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn exactly_the_overlapped_cells_are_stored(triangles in triangles(), bits in 2_u32..5) {
        let octree = Scene::new(&triangles).build(1 << bits);
        check_finest(&octree.view(), &triangles);
        check_levels(&octree.view());
        prop_assert_eq!(octree.normals.len(), octree.view().cells() as usize);
    }
}
