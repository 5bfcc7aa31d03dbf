//! What the partition does not depend on, and what every lookup keeps.

use std::collections::HashSet;
use std::ops::Range;
use std::thread;

use hashcache_core::glam::Vec3;
use hashcache_core::octree::{BuildSettings, NO_CELL, Octree, OwnedOctree, Workers, build};
use hashcache_core::pack::{octahedral_decode, octahedral_encode};
use proptest::prelude::*;

use crate::common::{Scene, overlaps, sheet};

/// What does not depend on units: everything but the grid's origin and cell sizes.
fn without_units(octree: &OwnedOctree) -> (Vec<u32>, &[u32]) {
    let mut words = octree.words.clone();
    words[4..9].fill(0);
    (words, &octree.normals)
}

/// Triangles whose corners are multiples of 2⁻¹⁰ in −2..2.
fn lattice_triangles() -> impl Strategy<Value = Vec<[[i32; 3]; 3]>> {
    prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-2048..=2048)), 1..6)
}

/// Triangles whose every coordinate went through `place(axis, v)` in double precision.
fn placed(triangles: &[[[i32; 3]; 3]], place: impl Fn(usize, f64) -> f64) -> Vec<[Vec3; 3]> {
    let corner = |corner: &[i32; 3]| {
        Vec3::from_array(std::array::from_fn(|axis| place(axis, f64::from(corner[axis]) / 1024.0) as f32))
    };
    triangles.iter().map(|triangle| triangle.each_ref().map(corner)).collect()
}

/// Threads that take the items in pieces of an odd size, from the end.
struct Pieces(u32);

impl Workers for Pieces {
    fn run(&self, items: u32, body: &(dyn Fn(Range<u32>) + Sync)) {
        thread::scope(|scope| {
            for worker in 0..3 {
                scope.spawn(move || {
                    for first in (0..items).step_by(self.0 as usize).collect::<Vec<_>>().into_iter().rev() {
                        if first / self.0 % 3 == worker {
                            body(first..items.min(first + self.0));
                        }
                    }
                });
            }
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn scale_changes_nothing(triangles in lattice_triangles(), bits in 2_u32..9) {
        let built = Scene::new(&placed(&triangles, |_, v| v)).build(1 << bits);
        for exponent in [-10, -3, 1, 10] {
            let scale = 2.0_f64.powi(exponent);
            let scaled = Scene::new(&placed(&triangles, |_, v| v * scale)).build(1 << bits);
            prop_assert_eq!(without_units(&scaled), without_units(&built));
        }
    }

    /// A loader subtracts the centre in double precision.
    #[test]
    fn offsets_change_nothing_once_taken_out(triangles in lattice_triangles(), offset in prop::array::uniform3(0..1_000_000)) {
        let offset = offset.map(|v| f64::from(v) + 0.3);
        // The file's coordinates are rounded where they are far away; this is what they mean near home.
        let far = |axis: usize, v: f64| v + offset[axis];
        let first: [f64; 3] = std::array::from_fn(|axis| far(axis, f64::from(triangles[0][0][axis]) / 1024.0));
        let near = Scene::new(&placed(&triangles, |axis, v| far(axis, v) - first[axis])).build(256);
        let home = Scene::new(&placed(&triangles, |axis, v| v - f64::from(triangles[0][0][axis]) / 1024.0)).build(256);
        prop_assert_eq!(near, home);
    }

    #[test]
    fn threads_and_pieces_change_nothing(triangles in lattice_triangles(), piece in 1_u32..5) {
        let scene = Scene::new(&placed(&triangles, |_, v| v));
        let settings = BuildSettings { resolution: 128, ..BuildSettings::default() };
        prop_assert_eq!(build(&scene.geometry(), &settings, &Pieces(piece)), Ok(scene.build(128)));
    }

    /// Points on a triangle, computed in f32, lie in stored cells of every level.
    #[test]
    fn points_on_triangles_have_cells(
        corners in prop::array::uniform3(prop::array::uniform3(-10.0_f32..10.0)),
        at in prop::collection::vec((0.0_f32..1.0, 0.0_f32..1.0), 64),
        bits in 2_u32..13,
    ) {
        let [a, b, c] = corners.map(Vec3::from_array);
        // Narrower for fine grids, to keep the number of cells small.
        let c = a + (c - a) * if bits > 9 { 0.01 } else { 1.0 };
        let built = Scene::new(&[[a, b, c]]).build(1 << bits);
        let octree = built.view();
        for (u, v) in at {
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let p = a + (b - a) * u + (c - a) * v;
            let finest = octree.coordinates(p).expect("inside");
            for level in 0..octree.grid().levels {
                prop_assert!(octree.cell(level, finest.map(|c| c >> level)).is_some(), "{p} on level {level}");
            }
        }
    }

    /// The normal is that of a triangle that touches the cell, and no larger one does.
    #[test]
    fn normals_are_those_of_the_largest_triangle(triangles in lattice_triangles()) {
        let triangles = placed(&triangles, |_, v| v);
        let built = Scene::new(&triangles).build(16);
        let (octree, grid) = (built.view(), *built.view().grid());
        let area = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).length();
        let front = |t: &[Vec3; 3]| {
            let n = (t[1] - t[0]).cross(t[2] - t[0]);
            let first = [n.x, n.y, n.z].into_iter().find(|v| *v != 0.0).unwrap_or(1.0);
            octahedral_decode(octahedral_encode(n * first.signum()))
        };
        for block in octree.blocks(0) {
            for (cell, index) in block.cells() {
                let normal = octahedral_decode(built.normals[index as usize]);
                let sure = triangles.iter().filter(|t| overlaps(&grid, t, cell, 0.0)).map(area).fold(0.0, f32::max);
                let right = triangles.iter().any(|t| {
                    area(t) >= sure * 0.999 && overlaps(&grid, t, cell, 2.0 * grid.margin()) && front(t).dot(normal) > 0.9999
                });
                prop_assert!(right, "{cell:?}: {normal}");
            }
        }
    }

    /// Cells that were never stored are misses, wherever one asks.
    #[test]
    fn strangers_are_misses(cells in prop::collection::vec((0_u32..12, any::<[u32; 3]>(), 0_u32..33), 256)) {
        let built = sheet(4).build(64);
        let octree = built.view();
        let stored: HashSet<(u32, [u32; 3])> = (0..octree.grid().levels)
            .flat_map(|level| octree.blocks(level).flat_map(move |block| block.cells().map(move |(cell, _)| (level, cell))))
            .collect();
        for (level, cell, shift) in cells {
            let cell = cell.map(|c| c.checked_shr(shift).unwrap_or(c));
            prop_assert_eq!(octree.cell(level, cell).is_some(), stored.contains(&(level, cell)));
        }
    }
}

/// All resolutions, one map a level and several.
#[test]
fn every_resolution_keeps_the_laws() {
    // Long and thin in every direction: few cells, all of the range.
    let ends = [Vec3::splat(-1.0), Vec3::ONE, Vec3::new(1.0, -1.0, 0.2), Vec3::new(-1.0, 0.9, 1.0)];
    let triangles: Vec<[Vec3; 3]> = (0..4).map(|k| [ends[k], ends[(k + 1) % 4], ends[(k + 1) % 4] + 1e-4]).collect();
    let scene = Scene::new(&triangles);
    for bits in 2..=14 {
        let built = scene.build(1 << bits);
        let octree = built.view();
        assert_eq!(octree.validate(), Ok(()), "resolution {}", 1 << bits);
        assert_eq!(octree.maps().len() > octree.levels().len(), bits > 12);
        for triangle in &triangles {
            for step in 0..=1000 {
                let p = triangle[0].lerp(triangle[1], step as f32 / 1000.0);
                let cell = octree.coordinates(p).expect("inside");
                assert!(octree.cell(0, cell).is_some(), "{p} at {}", 1 << bits);
            }
        }
        check_batches(&octree);
    }
}

/// Lookups of many cells are those of single ones.
fn check_batches(octree: &Octree<'_>) {
    let mut cells: Vec<[u32; 3]> = octree.blocks(0).take(99).flat_map(|b| b.cells().map(|(cell, _)| cell)).collect();
    cells.extend(cells.clone().iter().map(|[x, y, z]| [x + 1, *y, z.wrapping_sub(3)]));
    let mut indices = vec![7; cells.len()];
    octree.find_cells(0, &cells, &mut indices);
    for (cell, index) in cells.iter().zip(indices) {
        assert_eq!(octree.cell(0, *cell).unwrap_or(NO_CELL), index);
    }
}

/// Tables stay small on every level that has enough blocks to fill them.
#[test]
fn tables_are_dense() {
    let built = sheet(30).build(1024);
    let octree = built.view();
    for level in 0..octree.grid().levels {
        let statistics = octree.statistics(level, 40);
        if statistics.side >= 64 {
            let bytes = statistics.table_bytes as f64 / f64::from(statistics.cells);
            assert!(bytes <= 4.4, "level {level}: {bytes} bytes a cell");
        }
    }
}
