//! Laws of the implicit points: where they are, how they nest, who is nearest, what is interpolated.

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::exact::Quantum;
use hashcache_core::hash::{pcg, pcg4d, to_unit_f32};
use hashcache_core::record::VertexRecord;
use hashgrid::key::{coarser, finer, origin_shift};
use hashgrid::layout::{Layout, Minimal};
use hashgrid::merge::Merge;
use hashgrid::points::{
    POINT_BIN, Spot, chosen, claim_vertices, cube_distance, deposit_vertices, distance_squared, estimate_vertices,
    point_choose, point_cube, point_inside, point_nearest, point_neighbour, point_offset, point_owner, point_pick,
    point_place, point_spot,
};
use hashgrid::temporal::FixedCount;
use hashgrid::{Key, Params, Settings, Table, Word};

/// Cubes of 8 footprints, 2⁻¹⁰ m and larger.
fn params() -> Params {
    Params::new(&Settings::default()).unwrap()
}

/// Footprint of `level`.
fn footprint(level: u32) -> f32 {
    2.0_f32.powi(level as i32 - 13) * 1.01
}

fn storage<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(7)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

fn random(i: u32, seed: u32) -> [f32; 4] {
    pcg4d([i, seed, 5, 6]).map(to_unit_f32)
}

fn cube(i: u32, level: u32) -> Key {
    let [x, y, z, _] = pcg4d([i, 8, 8, 8]).map(|v| (v >> 12) as i32 - (1 << 19));
    Key { cell: [x, y, z], attributes: level | (POINT_BIN << 8) }
}

/// A cube's point is uniform in it, on every level, at the end of the levels too.
#[test]
fn points_are_uniform() {
    for level in [0, 1, 3, 8, 20, 31] {
        const COUNT: u32 = 40_000;
        let (mut bins, mut products) = ([[0_u32; 16]; 3], 0.0_f64);
        for i in 0..COUNT {
            let place = point_place(cube(i, level));
            assert!(place.iter().all(|v| (0..256).contains(v)));
            (0..3).for_each(|k| bins[k][place[k] as usize / 16] += 1);
            products += f64::from(place[0] - 128) * f64::from(place[1] - 128);
        }
        for axis in bins {
            let expected = f64::from(COUNT) / 16.0;
            let chi: f64 = axis.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
            // 15 degrees of freedom, standard deviation √30: 6 of them.
            assert!(chi < 48.0, "level {level}: {chi}, {axis:?}");
        }
        // 73² is the variance of each; 5 standard deviations of the mean of the products.
        assert!((products / f64::from(COUNT) / 5461.0).abs() < 5.0 / f64::from(COUNT).sqrt(), "level {level}");
    }
}

/// Where a cube's point is, in metres.
fn world(key: Key) -> [f64; 3] {
    let (place, shift) = (point_place(key), f64::from(origin_shift(key.level())));
    let size = f64::from(params().cell_size(key.level()));
    [0, 1, 2].map(|k| (256.0 * f64::from(key.cell[k]) - shift + f64::from(place[k]) + 0.5) / 256.0 * size)
}

/// The points of a level are among those of the next finer one, with the same owner and at the same place.
#[test]
fn points_nest() {
    let mut own = 0;
    for i in 0..5000 {
        let level = 1 + pcg(i) % 30;
        let above = cube(i, level);
        let children: Vec<Key> = (0..8).filter_map(|octant| finer(&above, octant)).collect();
        let heirs = children.iter().filter(|child| point_owner(**child) == point_owner(above)).count();
        assert_eq!(heirs, 1);
        let heir = finer(&above, point_pick(above)).unwrap();
        assert_eq!(point_owner(heir), point_owner(above));
        let size = f64::from(params().cell_size(level));
        for (a, b) in world(heir).iter().zip(world(above)) {
            assert!((a - b).abs() <= 2.0 / 256.0 * size, "level {level}: {a} {b}");
        }
        own += u32::from(point_owner(above) == above);
        let owner = point_owner(above);
        assert!(owner.level() >= level && point_owner(owner) == owner);
        assert!(coarser(&owner).is_none_or(|up| finer(&up, point_pick(up)) != Some(owner)));
    }
    assert!((f64::from(own) / 5000.0 - 7.0 / 8.0).abs() < 0.03, "{own}");
}

/// Any place of any magnitude has a spot or a reason, and its cube holds it.
#[test]
fn every_place_has_a_spot() {
    let params = params();
    for i in 0..20_000 {
        let [a, b, c, d] = random(i, 1);
        let magnitude = 2.0_f32.powi((d * 38.0) as i32 - 14);
        let place = [(a - 0.5) * magnitude, (b - 0.5) * magnitude, (c - 0.5) * magnitude, footprint(pcg(i) % 32)];
        let spot = point_spot(&params, place).expect("a finite place");
        let size = f64::from(params.cell_size(spot.level));
        let corner = point_cube(spot).cell;
        for k in 0..3 {
            let shift = f64::from(origin_shift(spot.level)) / 256.0;
            let at = f64::from(place[k]) / size + shift - f64::from(corner[k]);
            assert!((0.0..1.0).contains(&at), "{at}");
            let inside = f64::from(point_inside(spot)[k]) / 512.0;
            assert!((inside - at).abs() <= 1.0 / 512.0, "{inside} {at}");
        }
        assert!(chosen(&params, &place).is_some());
    }
    for bad in [f32::NAN, f32::INFINITY, 1e38] {
        assert_eq!(point_spot(&params, [0.0, bad, 0.0, 1.0]), None);
    }
    assert!(point_spot(&params, [0.0, 0.0, 0.0, f32::NAN]).is_none());
    // Cubes on both sides of the origin are different ones: nothing is mirrored.
    let at = |x: f32| point_cube(point_spot(&params, [x, 0.7, 0.7, footprint(5)]).unwrap());
    assert_ne!(at(0.05), at(-0.05));
    assert_ne!(point_place(at(0.05))[1], point_place(at(-0.05))[1]);
}

/// The three nearest are those of a plain search through all 216, in order.
#[test]
fn the_nearest_are_the_nearest() {
    for i in 0..500 {
        let [x, y, z, w] = pcg4d([i, 2, 2, 2]);
        let level = w % 32;
        // Coordinates on both sides of the origin and as far as spots go.
        let far = if i % 3 == 0 { 2 } else { 14 };
        let spot = Spot { level, fixed: [x, y, z].map(|v| (v as i32) >> far) };
        let (own, at) = (point_cube(spot), point_inside(spot));
        let mut all: Vec<(u32, Key)> = (0..216)
            .map(|index| {
                let delta = point_neighbour(own, index);
                let cell = [0, 1, 2].map(|k| own.cell[k] + delta[k]);
                let other = Key { cell, ..own };
                let distance = distance_squared(point_offset(at, delta, other));
                assert!(cube_distance(at, delta) <= distance);
                (distance, point_owner(other))
            })
            .collect();
        all.sort_unstable_by_key(|point| point.0);
        let nearest = point_nearest(spot);
        for (found, expected) in nearest.iter().zip(&all) {
            assert_eq!(distance_squared(found.offset), expected.0);
        }
        if all[0].0 < all[1].0 && all[1].0 < all[2].0 && all[2].0 < all[3].0 {
            assert_eq!(nearest.map(|point| point.owner), [all[0].1, all[1].1, all[2].1]);
        }
        // Two cubes to either side at least are looked through, so nobody nearer was missed.
        assert!(all[2].0 <= 1024 * 1024);
    }
}

/// Nearer points are drawn more often: in proportion to 1/d².
#[test]
fn choices_follow_the_inverse_square() {
    const COUNT: u32 = 200_000;
    for distances in [[1, 1, 1], [0, 5, 5], [0, 0, 0], [100, 200, 300], [90_000, 90_001, 2_000_000], [3, 70, 7_000_000]]
    {
        let mut counts = [0_u32; 3];
        for i in 0..COUNT {
            counts[point_choose(distances, pcg(i)) as usize] += 1;
        }
        let inverse = distances.map(|d| 1.0 / f64::from(d.max(1)));
        let sum: f64 = inverse.iter().sum();
        for (count, weight) in counts.iter().zip(inverse) {
            let p = weight / sum;
            let found = f64::from(*count) / f64::from(COUNT);
            let deviation = (p * (1.0 - p) / f64::from(COUNT)).sqrt();
            assert!((found - p).abs() < 6.0 * deviation + 2.0_f64.powi(-12), "{distances:?}: {found}, {p} expected");
        }
    }
    assert!((0..1000).all(|i| point_choose([1, u32::MAX, u32::MAX], pcg(i)) == 0));
    assert_eq!([point_choose([1, 1, 1], 0), point_choose([1, 1, 1], u32::MAX)], [0, 2]);
}

/// A floor of 2 m with light by `light(x)`.
fn floor(count: u32, seed: u32, level: u32, light: impl Fn(f32) -> f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let [a, b, ..] = random(i, seed);
            VertexRecord {
                position_footprint: [2.0 * a - 1.0, 0.0, 2.0 * b - 1.0, footprint(level)],
                further: [light(2.0 * a - 1.0); 4],
                flags: VertexRecord::VALID,
                seed: i,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

fn fill<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) -> Counters {
    let mut counters = Counters::default();
    claim_vertices(table, params, vertices);
    deposit_vertices(table, params, vertices, &mut counters);
    assert_eq!(counters.balance(), 0);
    assert_eq!(table.validate().expect("valid").deposits + counters.refusals, counters.deposits);
    counters
}

/// Constant light comes back as it is; a ramp up to the width of the kernel; noise is averaged.
#[test]
fn interpolation_keeps_constants_and_ramps() {
    let params = params();
    let words = storage::<Minimal>(1 << 14, &params);
    let table = Table::<Minimal>::with_layout(&words, &params).unwrap();
    let light: [(&str, &dyn Fn(f32) -> f32); 2] = [("constant", &|_| 0.7), ("ramp", &|x| x + 1.0)];
    for (name, light) in light {
        table.clear();
        assert_eq!(fill(&table, &params, &floor(10_000, 1, 6, light)).refusals, 0);
        let asked = floor(300, 2, 6, |_| 0.0);
        let (mut counters, mut worst) = (Counters::default(), 0.0_f32);
        estimate_vertices(&table, &params, &asked, 1.0, 0, &mut counters, |i, estimate| {
            let x = asked[i].position_footprint[0];
            let expected = light(x);
            assert!(estimate.samples > 0 && estimate.direct.x == 0.0);
            // Near the ends the kernel, 1/8 m wide, sees one side only.
            if x.abs() < 0.85 {
                worst = worst.max((estimate.further.x - expected).abs());
            }
        });
        assert!(worst < if name == "ramp" { 0.06 } else { 1e-6 }, "{name}: {worst}");
        assert_eq!((counters.hits, counters.fallbacks), (300, 0));
    }
}

/// The weights are count·(r − d), beside a model in f64; nothing beyond the radius counts.
#[test]
fn interpolation_is_shepards() {
    let params = params();
    let words = storage::<Minimal>(1 << 14, &params);
    let table = Table::<Minimal>::with_layout(&words, &params).unwrap();
    fill(&table, &params, &floor(5000, 3, 5, |x| (7.0 * x).abs()));
    for radius in [0.25_f32, 0.6, 1.0, 9.0, f32::NAN] {
        let asked = floor(200, 4, 5, |_| 3.0);
        let mut counters = Counters::default();
        estimate_vertices(&table, &params, &asked, radius, 0, &mut counters, |i, estimate| {
            let r = f64::from(if radius < 1.0 { radius } else { 1.0 }) * 1024.0;
            let spot = point_spot(&params, asked[i].position_footprint).unwrap();
            let (own, at) = (point_cube(spot), point_inside(spot));
            let (mut sum, mut weights) = (0.0, 0.0);
            for index in 0..216 {
                let delta = point_neighbour(own, index);
                let other = Key { cell: [0, 1, 2].map(|k| own.cell[k] + delta[k]), ..own };
                let d = f64::from(distance_squared(point_offset(at, delta, other))).sqrt();
                let Some(slot) = table.find_named(&point_owner(other)).filter(|_| d < r) else { continue };
                let sums = table.sums(slot);
                sum += (r - d) * sums.light[3] as f64;
                weights += (r - d) * f64::from(sums.count);
            }
            if weights == 0.0 {
                assert_eq!((estimate.samples, estimate.further.x), (0, 3.0));
                return;
            }
            let expected = sum / weights * f64::from(params.quantum().quantum());
            assert!((f64::from(estimate.further.x) / expected - 1.0).abs() < 1e-5, "{estimate:?} {expected}");
        });
        assert_eq!(counters.lookups, 200);
    }
}

/// What a coarse level gathered is there on finer ones, at the points that both have; and where a level has nothing, the
/// coarser ones answer.
#[test]
fn levels_share_their_points() {
    let params = params();
    let words = storage::<Minimal>(1 << 14, &params);
    let table = Table::<Minimal>::with_layout(&words, &params).unwrap();
    fill(&table, &params, &floor(5000, 5, 7, |_| 0.5));
    for (level, coarser, all) in [(6, 0, true), (3, 0, false), (3, 4, true)] {
        let near = floor(1000, 6, level, |_| 0.0);
        let mut counters = Counters::default();
        estimate_vertices(&table, &params, &near, 1.0, coarser, &mut counters, |_, estimate| {
            assert!(estimate.samples == 0 || (estimate.further.x - 0.5).abs() < 1e-6);
        });
        // One level nearer, one in eight of the cubes around has its point from above; four levels nearer, few have.
        assert_eq!((counters.fallbacks == 0, counters.coarser > 0), (all, coarser > 0), "level {level}: {counters:?}");
        assert!(counters.hits > if all { 999 } else { 0 }, "{counters:?}");
    }
}

/// Frames merged with a cap: the count is bounded, energy balances, the course of a step is that of the cap.
#[test]
fn merged_frames_are_capped() {
    let params = params();
    let words: Vec<_> = (0..2).map(|_| storage::<Minimal>(1 << 12, &params)).collect();
    let [lasting, frame] = [0, 1].map(|k| Table::<Minimal>::with_layout(&words[k], &params).unwrap());
    let rule = FixedCount { most: 32 };
    for index in 0..40 {
        let light = if index < 20 { 0.0 } else { 1.0 };
        frame.clear();
        fill(&frame, &params, &floor(2000, index, 8, |_| light));
        let before = lasting.validate().unwrap().energy;
        let merged = Merge::new(&lasting, &frame).unwrap().all(&rule, index);
        let after = lasting.validate().unwrap().energy;
        assert_eq!(after, before + merged.energy_added - merged.energy_faded);
        assert_eq!(merged.refused, 0);
    }
    let most = frame.cells().map(|cell| cell.count).max().unwrap();
    assert!(lasting.cells().all(|cell| cell.count <= 32 + 2 * most));
    let full = lasting.cells().filter(|cell| cell.count >= 32);
    let means: Vec<f32> = full.map(|cell| cell.mean_further(params.quantum())[0]).collect();
    let risen = means.iter().filter(|mean| **mean > 0.9).count();
    assert!(risen > 100 && risen > means.len() / 2, "{risen} of {}", means.len());
}

/// Order and threads play no part, and light of any magnitude comes back.
#[test]
fn tables_depend_on_the_vertices_alone() {
    for exponent in [-40, 0, 40] {
        let light = 2.0_f32.powi(exponent);
        let params = Params::new(&Settings { quantum: Quantum::for_scale(light), ..Settings::default() }).unwrap();
        let vertices = floor(1500, 9, 6, |x| light * (1.0 + x));
        let tables: Vec<Vec<u64>> = [1, 4]
            .map(|threads| {
                let words = storage::<Minimal>(1 << 12, &params);
                let table = Table::<Minimal>::with_layout(&words, &params).unwrap();
                let run = |step: &(dyn Fn(&[VertexRecord]) + Sync)| {
                    std::thread::scope(|scope| {
                        for part in vertices.rchunks(vertices.len().div_ceil(threads)) {
                            scope.spawn(move || step(part));
                        }
                    });
                };
                run(&|part| {
                    claim_vertices(&table, &params, part);
                });
                run(&|part| deposit_vertices(&table, &params, part, &mut Counters::default()));
                let mean = table.cells().map(|cell| f64::from(cell.mean_further(params.quantum())[0])).sum::<f64>()
                    / table.cells().count() as f64;
                assert!((mean / f64::from(light) - 1.0).abs() < 0.1, "{mean}");
                words.iter().map(|word| word.load(std::sync::atomic::Ordering::Relaxed)).collect()
            })
            .into();
        assert!(tables[0] == tables[1]);
    }
}
