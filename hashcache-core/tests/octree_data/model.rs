//! The same by a map from cells to sums in double precision.

use std::collections::BTreeMap;

use hashcache_core::glam::Vec3;
use hashcache_core::octree::{
    CellRecord, ExactCell, Light, Octree, OctreeCache, OctreeSettings, OwnedOctree, PaperCell,
};
use hashcache_core::pack::octahedral_decode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::{Estimate, RadianceCache};

use super::room::{Noise, QUADS, octree, params, plain, vertex};

type Place = (u32, [u32; 3]);

#[derive(Clone, Copy, Default)]
struct ModelSide {
    sum: [f64; 3],
    count: u32,
}

/// Cells by level and coordinates: front's normal, front and back.
struct Model<'a> {
    octree: Octree<'a>,
    cells: BTreeMap<Place, (Vec3, [ModelSide; 2])>,
    settings: OctreeSettings,
}

fn side(normal: Vec3, n: Vec3) -> usize {
    usize::from(normal.dot(n) < 0.0)
}

impl<'a> Model<'a> {
    fn new(owned: &'a OwnedOctree, settings: OctreeSettings) -> Self {
        let octree = owned.view();
        let mut cells = BTreeMap::new();
        for level in 0..octree.grid().levels {
            for (place, index) in octree.blocks(level).flat_map(|block| block.cells().collect::<Vec<_>>()) {
                let normal = octahedral_decode(owned.normals[index as usize]);
                cells.insert((level, place), (normal, [ModelSide::default(); 2]));
            }
        }
        assert_eq!(cells.len(), octree.cells() as usize);
        Self { octree, cells, settings }
    }

    fn place(&self, vertex: &VertexRecord) -> Option<[u32; 3]> {
        self.octree.coordinates(Vec3::from_slice(&vertex.position_footprint[..3]))
    }

    fn record(&mut self, vertex: &VertexRecord) {
        if !vertex.is_recordable() {
            return;
        }
        let Some(place) = self.place(vertex) else { return };
        for level in 0..self.octree.grid().levels {
            let Some((normal, sides)) = self.cells.get_mut(&(level, place.map(|c| c >> level))) else { continue };
            let at = side(*normal, vertex.normal());
            for (sum, c) in sides[at].sum.iter_mut().zip(0..3) {
                let direct = if self.settings.light == Light::All { vertex.direct[c] } else { 0.0 };
                *sum += f64::from(direct) + f64::from(vertex.further[c]);
            }
            sides[at].count += 1;
        }
    }

    fn estimate(&self, vertex: &VertexRecord) -> ModelSide {
        let Some(place) = self.place(vertex) else { return ModelSide::default() };
        let grid = self.octree.grid();
        let wanted = f64::from(vertex.position_footprint[3]) * f64::from(self.settings.cell) / f64::from(grid.cell);
        let top = f64::from(grid.levels - 1);
        let nearest = wanted.log2().round().clamp(0.0, top) as u32;
        let first = nearest.saturating_sub(self.settings.finer);
        let last = (nearest + self.settings.max_climb).min(grid.levels - 1);
        let mut best = ModelSide::default();
        for level in first..=last {
            if let Some((normal, sides)) = self.cells.get(&(level, place.map(|c| c >> level))) {
                let here = sides[side(*normal, vertex.normal())];
                if here.count > best.count {
                    best = here;
                }
            }
            if best.count >= self.settings.min_samples.max(1) {
                break;
            }
        }
        best
    }
}

fn compare(found: &Estimate, expected: &ModelSide, tolerance: f64, at: &str) {
    assert_eq!(found.samples, expected.count, "{at}");
    assert_eq!(found.direct, Vec3::ZERO, "{at}");
    if expected.count == 0 {
        return;
    }
    for (c, sum) in expected.sum.iter().enumerate() {
        let mean = sum / f64::from(expected.count);
        let error = (f64::from(found.further[c]) - mean).abs();
        // A quantum is 2⁻²⁰: each of two values a sample is half of one off at most.
        assert!(error <= tolerance * mean + 1e-6, "{at}: channel {c}: {} for {mean}", found.further[c]);
    }
}

/// Several frames on several resolutions: whatever is asked, cache and model agree.
fn agrees<C: CellRecord>(settings: OctreeSettings, tolerance: f64, seed: u32) {
    for resolution in [4, 16, 64] {
        let owned = octree(&QUADS, resolution);
        let mut model = Model::new(&owned, settings);
        let mut cache = OctreeCache::<C>::new(owned.clone(), params(&settings));
        let mut noise = Noise(seed ^ resolution);
        for frame in 0..6 {
            for _ in 0..500 << (frame % 3) {
                let vertex = vertex(&mut noise, &QUADS);
                model.record(&vertex);
                cache.record(&vertex);
            }
            cache.end_frame();
            for k in 0..500 {
                let vertex = vertex(&mut noise, &QUADS);
                let at = format!("{settings:?}, resolution {resolution}, frame {frame}, vertex {k}");
                compare(&cache.estimate(&vertex), &model.estimate(&vertex), tolerance, &at);
            }
        }
        let counters = cache.counters();
        assert_eq!((counters.balance(), counters.refusals, counters.lookups), (0, 0, 3000));
        assert_eq!(counters.hits + counters.fallbacks, counters.lookups);
    }
}

/// Six frames round six times, each by at most a unit in the last place.
const EXACT: f64 = 6.0 / 8_388_608.0;

/// The same for half floats, which have 13 bits less.
const PAPER: f64 = 6.0 / 1024.0;

#[test]
fn own_cells() {
    agrees::<ExactCell>(plain(), EXACT, 1);
    agrees::<PaperCell>(plain(), PAPER, 2);
}

#[test]
fn coarser_cells_where_samples_are_few() {
    let settings = OctreeSettings { min_samples: 20, max_climb: 4, ..plain() };
    agrees::<ExactCell>(settings, EXACT, 3);
    agrees::<PaperCell>(OctreeSettings { light: Light::Further, ..settings }, PAPER, 4);
}

#[test]
fn the_finest_cells_with_enough_samples() {
    let settings = OctreeSettings { min_samples: 50, max_climb: 31, finer: 31, cell: 3.0, ..plain() };
    agrees::<ExactCell>(settings, EXACT, 5);
    agrees::<ExactCell>(OctreeSettings { max_climb: 1, finer: 2, light: Light::Further, ..settings }, EXACT, 6);
}
