//! Levels, jitter, holes.

use hashcache_core::glam::Vec3;
use hashcache_core::octree::{ExactCell, Light, OctreeCache, OctreeSettings};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::RadianceCache;

use super::room::{Noise, QUADS, lit, octree, params, plain, record_all, vertex};

/// A cache whose cells answer with their level on red, and x + 1000·y of their coordinates on green and blue.
fn labelled(settings: &OctreeSettings, resolution: u32) -> OctreeCache {
    let mut cache = OctreeCache::<ExactCell>::new(octree(&QUADS, resolution), params(settings));
    let owned = cache.octree().clone();
    let octree = owned.view();
    for level in 0..octree.grid().levels {
        for (place, index) in octree.blocks(level).flat_map(|block| block.cells().collect::<Vec<_>>()) {
            let label = [level as f32, place[0] as f32, place[1] as f32];
            let cell = cache.cell(index);
            cache.set_cell(index, &ExactCell { means: [label; 2], counts: [100; 2], ..cell });
        }
    }
    cache
}

/// A footprint of x·√½ cells is on one level; the next float is on the next, and levels only go up.
#[test]
fn levels_change_by_one_rounding_step() {
    let cache = labelled(&plain(), 64);
    let grid = *cache.octree().view().grid();
    let level = |footprint: f32| {
        let mut vertex = lit(0.0);
        vertex.position_footprint[3] = footprint;
        cache.estimate(&vertex).further.x as u32
    };
    for k in 0..grid.levels - 1 {
        let (mut below, mut above) = (grid.cell_size(k), grid.cell_size(k + 1));
        assert_eq!((level(below), level(above)), (k, k + 1), "a cell's own size asks for its level");
        while above.to_bits() - below.to_bits() > 1 {
            let middle =
                f32::from_bits(below.midpoint(above).to_bits().clamp(below.to_bits() + 1, above.to_bits() - 1));
            *(if level(middle) == k { &mut below } else { &mut above }) = middle;
        }
        let border = f64::from(grid.cell_size(k)) * std::f64::consts::SQRT_2;
        assert!((f64::from(above) / border - 1.0).abs() < 1e-6, "{above} for {border}");
    }
    for (footprint, expected) in [
        (0.0, 0),
        (-1.0, 0),
        (f32::NAN, 0),
        (f32::MIN_POSITIVE, 0),
        (f32::MAX, grid.levels - 1),
        (f32::INFINITY, grid.levels - 1),
    ] {
        assert_eq!(level(footprint), expected, "{footprint}");
    }
}

/// With full jitter of levels, both neighbours are read, in proportion to how near they are.
#[test]
fn levels_blend() {
    let cache = labelled(&OctreeSettings { level_jitter: 1.0, ..plain() }, 64);
    let grid = *cache.octree().view().grid();
    let share = |footprint: f32| {
        let levels = (0..4000_u32).map(|seed| {
            let mut vertex = VertexRecord { seed, ..lit(0.0) };
            vertex.position_footprint[3] = footprint;
            cache.estimate(&vertex).further.x
        });
        levels.sum::<f32>() / 4000.0
    };
    let mut last = 0.0;
    for step in 0..=20 {
        let footprint = grid.cell_size(1) * (1.0 + step as f32 / 20.0);
        let mean = share(footprint);
        // The logarithm is linear between powers of two; five standard deviations of a share of 4000.
        assert!((mean - (1.0 + step as f32 / 20.0)).abs() < 0.04, "{mean} at {step}");
        assert!(mean > last - 0.04);
        last = mean;
    }
}

/// Jitter reads cells up to its width away, all of them, and only of the same surface.
#[test]
fn jitter_stays_in_the_plane_and_within_its_width() {
    for jitter in [0.5_f32, 1.0, 2.0] {
        let cache = labelled(&OctreeSettings { jitter, ..plain() }, 64);
        let octree = cache.octree().view();
        let mut reached = [0_u32; 2];
        for seed in 0..2000 {
            let vertex = VertexRecord { seed, ..lit(0.0) };
            let [x, y, z, _] = vertex.position_footprint;
            let own = octree.coordinates(Vec3::new(x, y, z)).expect("inside");
            let estimate = cache.estimate(&vertex).further;
            assert_eq!(estimate.x, 0.0);
            for (axis, found) in [estimate.y, estimate.z].into_iter().enumerate() {
                let distance = (found as u32).abs_diff(own[axis]);
                assert!(distance <= jitter.ceil() as u32);
                reached[axis] = reached[axis].max(distance);
            }
        }
        assert!(reached.iter().all(|d| *d >= 1), "{jitter}: {reached:?}");
    }
}

/// Where jitter leads off the surface, the vertex's own cell answers: a surface full of samples has no holes.
#[test]
fn jitter_makes_no_holes() {
    let quads = [[Vec3::ZERO, Vec3::X, Vec3::Y]];
    let settings = OctreeSettings { jitter: 4.0, ..plain() };
    let mut cache = OctreeCache::<ExactCell>::new(octree(&quads, 16), params(&settings));
    let mut noise = Noise(3);
    let frame: Vec<_> = (0..20_000).map(|_| vertex(&mut noise, &quads)).collect();
    record_all(&mut cache, &frame);
    cache.end_frame();
    assert!(frame.iter().all(|vertex| cache.estimate(vertex).samples > 0));
    assert_eq!(cache.counters().fallbacks, 0);
}

/// Both sides of a wall keep their light.
#[test]
fn sides_do_not_mix() {
    let mut cache = OctreeCache::<ExactCell>::new(octree(&QUADS, 32), params(&plain()));
    let back = VertexRecord { normal: octahedral_encode(Vec3::NEG_Z), ..lit(5.0) };
    cache.record(&lit(1.0));
    cache.record(&back);
    cache.end_frame();
    assert_eq!(cache.estimate(&lit(0.0)).further.x, 1.0);
    assert_eq!(cache.estimate(&back).further.x, 5.0);
}

/// A hole gets what the vertex would have given; one that never gives gets nothing.
#[test]
fn holes_answer_with_the_vertex_itself() {
    let light = VertexRecord { direct: [2.0, f32::NAN, 1.0, 0.0], ..lit(1.0) };
    let visible = VertexRecord { flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY, ..light };
    let invalid = VertexRecord { flags: 0, ..light };
    for (kind, own) in [(Light::All, Vec3::new(3.0, 0.5, 1.25)), (Light::Further, Vec3::new(1.0, 0.5, 0.25))] {
        let settings = OctreeSettings { light: kind, max_climb: 31, min_samples: 4, ..plain() };
        let mut cache = OctreeCache::<ExactCell>::new(octree(&QUADS, 32), params(&settings));
        for (vertex, expected) in [(&light, own), (&visible, Vec3::ZERO), (&invalid, Vec3::ZERO)] {
            let estimate = cache.estimate(vertex);
            assert_eq!((estimate.further, estimate.direct, estimate.samples), (expected, Vec3::ZERO, 0));
        }
        assert_eq!((cache.counters().lookups, cache.counters().fallbacks), (2, 2));
        // Light elsewhere is found by climbing; how far that goes is a setting.
        let far = VertexRecord { position_footprint: [0.9, 0.9, 0.0, 0.001], ..lit(8.0) };
        (0..4).for_each(|_| cache.record(&far));
        cache.end_frame();
        assert_eq!((cache.estimate(&visible).further.x, cache.counters().coarser), (8.0, 1));
        cache.set_params(params(&OctreeSettings { max_climb: 1, ..settings }));
        assert_eq!(cache.estimate(&visible).samples, 0);
    }
}

/// Cells that were never stored are misses: a point off all surfaces finds nothing on the finest level.
#[test]
fn points_off_all_surfaces_find_nothing() {
    let cache = labelled(&plain(), 64);
    let octree = cache.octree().view();
    let mut noise = Noise(9);
    let mut missed = 0;
    for _ in 0..5000 {
        let p = Vec3::new(noise.unit(), noise.unit(), noise.unit()) * 3.0 - 1.0;
        let vertex = VertexRecord { position_footprint: p.extend(0.0).to_array(), ..lit(0.0) };
        let stored = octree.coordinates(p).and_then(|place| octree.cell(0, place)).is_some();
        assert_eq!(cache.estimate(&vertex).samples > 0, stored);
        missed += u32::from(!stored);
    }
    assert!(missed > 4000);
}
