//! Energy, order, extremes, wipes.

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::exact::{Quantum, mean, quantize};
use hashcache_core::glam::Vec3;
use hashcache_core::octree::{
    COUNTER_WORDS, CellRecord, ExactCell, Light, OctreeCache, OctreeSettings, PaperCell, ReadCells, Sample,
    SharedCells, add_counters, merge_samples, read_counters, sample_key, sample_vertices,
};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::RadianceCache;
use std::sync::atomic::AtomicU32;

use super::room::{Noise, QUADS, lit, octree, params, plain, record_all, vertex};

fn cache<C: CellRecord>(settings: &OctreeSettings, resolution: u32) -> OctreeCache<C> {
    OctreeCache::new(octree(&QUADS, resolution), params(settings))
}

fn cells<C: CellRecord>(cache: &OctreeCache<C>) -> Vec<u8> {
    let count = cache.octree().view().cells();
    (0..count).flat_map(|index| bytemuck::bytes_of(&cache.cell(index)).to_vec()).collect()
}

/// Every level's counts add up to the number of samples, and its mean to the mean of all samples: the root's, too.
#[test]
fn every_level_holds_all_light() {
    let mut cache = cache::<ExactCell>(&plain(), 32);
    let mut noise = Noise(1);
    let (mut sum, mut count) = ([0.0_f64; 3], 0);
    for frame in 0..20 {
        for _ in 0..100 + 37 * frame {
            let vertex = vertex(&mut noise, &QUADS);
            cache.record(&vertex);
            for (c, sum) in sum.iter_mut().enumerate() {
                *sum += f64::from(vertex.direct[c]) + f64::from(vertex.further[c]);
            }
            count += 1;
        }
        cache.end_frame();
    }
    let octree = cache.octree().view();
    for level in 0..octree.grid().levels {
        let (mut level_sum, mut level_count) = ([0.0; 3], 0);
        for index in octree.level_range(level) {
            let cell = cache.cell(index);
            for (mean, n) in cell.means.iter().zip(cell.counts) {
                level_count += n;
                (0..3).for_each(|c| level_sum[c] += f64::from(mean[c]) * f64::from(n));
            }
        }
        assert_eq!(level_count, count, "level {level}");
        for c in 0..3 {
            let error = (level_sum[c] / sum[c] - 1.0).abs();
            // Twenty merges, and half a quantum for each of two values: at most 1e-4 of the darkest channel's mean.
            assert!(error < 1e-4, "level {level}, channel {c}: {} for {}", level_sum[c], sum[c]);
        }
    }
    assert_eq!(octree.level_range(octree.grid().levels - 1).len(), 1, "the root");
}

/// The same where coordinates take more bits than a key has: every level counts every sample once.
#[test]
fn fine_cells_are_told_apart() {
    let corner = [Vec3::ZERO, Vec3::X * 0.02, Vec3::Y * 0.02];
    let quads = [corner, corner.map(|v| v + Vec3::ONE * (f32::from(u8::from(v == Vec3::ZERO))))];
    for resolution in [512, 1024, 4096] {
        let mut cache = OctreeCache::<ExactCell>::new(octree(&quads, resolution), params(&plain()));
        let mut noise = Noise(8);
        let frame: Vec<_> = (0..4000).map(|_| vertex(&mut noise, &quads)).collect();
        record_all(&mut cache, &frame);
        cache.end_frame();
        let octree = cache.octree().view();
        for level in 0..octree.grid().levels {
            let count: u32 = octree.level_range(level).flat_map(|index| cache.cell(index).counts).sum();
            assert_eq!(count, 4000, "level {level} of {resolution}");
        }
    }
}

#[test]
fn the_order_of_vertices_does_not_matter() {
    let settings = OctreeSettings { quantum: Quantum::for_scale(8.0), ..plain() };
    let mut noise = Noise(2);
    let mut frames: Vec<Vec<_>> = (0..4).map(|_| (0..3000).map(|_| vertex(&mut noise, &QUADS)).collect()).collect();
    let run = |frames: &[Vec<VertexRecord>]| {
        let mut cache = cache::<PaperCell>(&settings, 32);
        for frame in frames {
            record_all(&mut cache, frame);
            cache.end_frame();
        }
        (cells(&cache), cache.counters())
    };
    let forwards = run(&frames);
    for frame in &mut frames {
        frame.reverse();
    }
    assert!(run(&frames) == forwards, "backwards");
    for frame in &mut frames {
        for i in (1..frame.len()).rev() {
            frame.swap(i, noise.below(i + 1));
        }
    }
    assert!(run(&frames) == forwards, "shuffled");
}

const HOSTILE: [f32; 14] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    -1.0,
    -0.0,
    f32::MAX,
    f32::MIN_POSITIVE,
    1e-40,
    1e-12,
    1e-7,
    1e4,
    1e7,
    1e12,
    1e20,
];

fn survives<C: CellRecord>(light: Light) {
    for scale in [1e-12_f32, 1.0, 1e12] {
        let settings = OctreeSettings { light, quantum: Quantum::for_scale(scale), ..plain() };
        let mut cache = cache::<C>(&settings, 16);
        let mut noise = Noise(3);
        for _ in 0..5 {
            for _ in 0..400 {
                let mut vertex = vertex(&mut noise, &QUADS);
                let hostile = HOSTILE[noise.below(HOSTILE.len())];
                match noise.below(5) {
                    0 => vertex.direct[noise.below(3)] = hostile,
                    1 => vertex.further[noise.below(3)] = hostile,
                    2 => vertex.position_footprint[noise.below(4)] = hostile,
                    3 => vertex.normal = noise.word(),
                    _ => vertex.further = [hostile; 4],
                }
                cache.record(&vertex);
                let estimate = cache.estimate(&vertex);
                assert!(estimate.further.is_finite(), "{vertex:?}: {estimate:?}");
                assert!((0.0..=f32::MAX).contains(&estimate.variance), "{vertex:?}: {estimate:?}");
            }
            cache.end_frame();
        }
        let counters = cache.counters();
        assert_eq!(counters.balance(), 0);
        assert_eq!(counters.deposits, 2000);
        assert!(counters.non_finite > 0 && counters.negative > 0 && counters.refusals > 0, "{counters:?}");
        let clamp = 2.0 * settings.quantum.clamp();
        for index in 0..cache.octree().view().cells() {
            for side in [0, 1] {
                let mean = cache.cell(index).side(side, settings.quantum).mean;
                assert!(mean.iter().all(|v| (0.0..=clamp).contains(v)), "{mean:?}");
                let scatter = cache.cell(index).root_mean_square(side).unwrap_or(0.0);
                assert!((0.0..=clamp * 1.001).contains(&scatter), "{scatter}");
            }
        }
    }
}

#[test]
fn hostile_numbers_stay_outside() {
    survives::<ExactCell>(Light::All);
    survives::<PaperCell>(Light::Further);
}

/// Light from 1e-12 to 1e12 comes back, each in the units of its own scene.
#[test]
fn any_magnitude_comes_back() {
    for exponent in -12..=12 {
        let value = 10.0_f64.powi(exponent) as f32;
        let settings = OctreeSettings { quantum: Quantum::for_scale(value), ..plain() };
        let check = |found: f32, tolerance: f32| {
            assert!((found / value - 1.0).abs() <= tolerance, "{found:e} for {value:e}");
        };
        let mut exact = cache::<ExactCell>(&settings, 16);
        let mut paper = cache::<PaperCell>(&settings, 16);
        for _ in 0..3 {
            for cache in [&mut exact as &mut dyn RadianceCache, &mut paper] {
                cache.record(&lit(value));
                cache.end_frame();
            }
        }
        check(exact.estimate(&lit(0.0)).further.x, 1e-6);
        check(paper.estimate(&lit(0.0)).further.x, 1.0 / 1024.0);
    }
}

/// Light that is the same in every frame is kept to the bit, for any number of frames.
#[test]
fn steady_light_stays() {
    let mut cache = cache::<ExactCell>(&plain(), 8);
    for frame in 0..1000 {
        for _ in 0..=frame % 7 {
            cache.record(&lit(0.731));
        }
        cache.end_frame();
        let expected = mean(Quantum::for_scale(1.0), quantize(Quantum::for_scale(1.0), 0.731).value, 1);
        let found = cache.estimate(&lit(0.0)).further.x;
        assert!((found - expected).abs() <= 2.0 * f32::EPSILON * expected, "frame {frame}: {found} for {expected}");
    }
}

/// A frame's record is refused outside the cube, and goes to a coarser cell where the finest level has none.
#[test]
fn vertices_off_their_surface() {
    let mut cache = cache::<ExactCell>(&OctreeSettings { max_climb: 31, ..plain() }, 64);
    let outside = VertexRecord { position_footprint: [50.0, 0.0, 0.0, 0.01], ..lit(3.0) };
    let off = VertexRecord { position_footprint: [0.4, 0.4, 0.05, 0.01], ..lit(5.0) };
    let hidden = VertexRecord { flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY, ..lit(7.0) };
    let invalid = VertexRecord { flags: 0, ..lit(9.0) };
    for vertex in [&outside, &off, &hidden, &invalid] {
        cache.record(vertex);
    }
    cache.end_frame();
    let counters = cache.counters();
    assert_eq!((counters.deposits, counters.refusals, counters.coarser), (2, 1, 1));
    assert_eq!((counters.balance(), counters.energy_refused), (0, 3 * (1 << 20) + 3 * (1 << 19) + 3 * (1 << 18)));
    let octree = cache.octree().view();
    let finest: u32 = octree.level_range(0).flat_map(|index| cache.cell(index).counts).sum();
    let root: u32 = cache.cell(octree.cells() - 1).counts.iter().sum();
    assert_eq!((finest, root), (0, 1));
    assert_eq!(cache.estimate(&off).further.x, 5.0);
}

/// After a wipe nothing old is seen, in cells that were touched again and in those that were not.
#[test]
fn wiped_light_is_never_seen() {
    let settings = OctreeSettings { min_samples: 30, max_climb: 31, ..plain() };
    let mut cache = cache::<ExactCell>(&settings, 32);
    let mut noise = Noise(5);
    for era in 1..5_u32 {
        for _ in 0..3 {
            for _ in 0..400 {
                let mut vertex = vertex(&mut noise, &QUADS);
                // A light of its own for each era; the floor alone in the last.
                vertex.direct = [era as f32; 4];
                vertex.further = [0.0; 4];
                if era == 4 {
                    vertex.position_footprint[2] = 0.0;
                }
                cache.record(&vertex);
            }
            cache.end_frame();
            for _ in 0..300 {
                let estimate = cache.estimate(&vertex(&mut noise, &QUADS));
                if estimate.samples > 0 {
                    assert_eq!(estimate.further, Vec3::splat(era as f32));
                }
            }
        }
        cache.record(&lit(1000.0));
        cache.wipe();
        for _ in 0..300 {
            let estimate = cache.estimate(&vertex(&mut noise, &QUADS));
            assert_eq!(estimate.samples, 0, "era {era}");
        }
    }
}

/// Any number of threads may merge parts of the samples, levels in any order: the same cells come of it.
#[test]
fn threads_may_share_the_samples() {
    let owned = octree(&QUADS, 32);
    let octree = owned.view();
    let params = params(&plain());
    let mut noise = Noise(6);
    let vertices: Vec<_> = (0..2000).map(|_| vertex(&mut noise, &QUADS)).collect();
    let mut cache = OctreeCache::<ExactCell>::new(owned.clone(), params);
    record_all(&mut cache, &vertices);
    cache.end_frame();

    let mut counters = Counters::default();
    let mut samples = Vec::new();
    sample_vertices(octree.grid(), &params, &vertices, &mut counters, |_, sample| samples.push(sample));
    samples.reverse();
    samples.sort_by_key(|sample| sample_key(octree.grid(), sample, 0));
    samples.extend([Sample::zeroed(); 3]);
    let words: Vec<_> = owned
        .normals
        .iter()
        .flat_map(|normal| bytemuck::cast::<_, [u32; 12]>(ExactCell::empty(*normal, 0)).map(AtomicU32::new))
        .collect();
    let cells = SharedCells::<ExactCell>::new(&words);
    let shared = [const { AtomicU32::new(0) }; COUNTER_WORDS];
    std::thread::scope(|scope| {
        for level in (0..octree.grid().levels).rev() {
            for part in [0..333, 333..334, 334..1500, 1500..9000] {
                let (samples, shared) = (&samples, &shared);
                scope.spawn(move || {
                    let mut counters = Counters::default();
                    merge_samples(&octree, &cells, &params, level, samples, part, &mut counters);
                    add_counters(shared, &counters);
                });
            }
        }
    });
    for index in 0..octree.cells() {
        assert_eq!(cells.get(index), cache.cell(index), "cell {index}");
    }
    assert_eq!(read_counters(&shared).merge(&counters), cache.counters());
}
