//! What lasts for many frames: removal, eviction into coarser cells, and light handed on between levels.

use std::collections::BTreeMap;

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::exact::MAX_DEPOSITS;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg, pcg4d, to_unit_f32};
use hashcache_core::level::MAX_LEVEL;
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::evict::{CountAndAge, Evicted, LeastRecent, MAX_PRIORITY, Priority, evict};
use hashgrid::jitter::SALT_DEPOSIT;
use hashgrid::key::{coarser, finer, key};
use hashgrid::layout::{Complete, Lasting, Layout};
use hashgrid::levels::{Inherited, inherit, touch_vertices};
use hashgrid::merge::Merge;
use hashgrid::names::{Naming, name_vertices};
use hashgrid::sums::Sums;
use hashgrid::temporal::Integrate;
use hashgrid::vertex::{claim_vertices, deposit_vertices};
use hashgrid::{Claim, Key, Params, Settings, Table, Word};

fn storage<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(7)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

fn params(max_probes: u32, jitter: f32) -> Params {
    Params::new(&Settings { base_size: 1.0 / 256.0, max_probes, jitter, ..Settings::default() }).unwrap()
}

/// A wall of 4 m, with footprints of `footprint`, lit in a ramp.
fn wall(count: u32, seed: u32, footprint: f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let [a, b, c, _] = pcg4d([i, seed, 0, 9]).map(to_unit_f32);
            VertexRecord {
                position_footprint: [4.0 * a - 1.7, 4.0 * b - 2.1, 0.0, footprint],
                direct: [a, c, 0.0, 0.0],
                further: [0.25; 4],
                normal: octahedral_encode(Vec3::Z),
                direction: octahedral_encode(Vec3::NEG_Z),
                seed: i ^ seed,
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

/// One frame into one table: claims, names, stamps, hands on, deposits.
fn frame<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], index: u32) -> Counters {
    let mut counters = Counters::default();
    claim_vertices(table, params, vertices);
    name_vertices(table, params, vertices, Naming::First);
    name_vertices(table, params, vertices, Naming::Second);
    touch_vertices(table, params, vertices, index);
    deposit_vertices(table, params, vertices, &mut counters);
    counters
}

fn energy<L: Layout>(table: &Table<'_, L>) -> u64 {
    table.validate().expect("a valid table").energy
}

/// The coarser cell of a vertex's cell is the vertex's cell on the coarser level, but for a 256th at a border; and going
/// there and back finds the cell among eight.
#[test]
fn coarser_cells_hold_finer_ones() {
    let params = params(32, 0.0);
    let mut off = 0;
    for i in 0..20_000_u32 {
        let [a, b, c, d] = pcg4d([i, 3, 1, 4]).map(to_unit_f32);
        let level = pcg(i) % MAX_LEVEL;
        // All levels of the range that coordinates of this size allow.
        let size = 2.0_f32.powi(level as i32 - 8);
        let place = [a, b, c].map(|r| (r - 0.4) * size * 1e4 * d);
        let at = |level: u32| {
            let footprint = 2.0_f32.powi(level as i32 - 8) / 8.0 * 1.01;
            let position_footprint = [place[0], place[1], place[2], footprint];
            let flags = VertexRecord::VALID;
            key(&params, &VertexRecord { position_footprint, flags, ..VertexRecord::zeroed() }, SALT_DEPOSIT).unwrap()
        };
        let (fine, coarse) = (at(level), at(level + 1));
        assert_eq!((fine.level(), coarse.level()), (level, level + 1));
        let above = coarser(&fine).unwrap();
        off += u32::from(above != coarse);
        assert!(above.cell.iter().zip(coarse.cell).all(|(a, b)| a.abs_diff(b) <= 1));
        let children: Vec<Key> = (0..8).filter_map(|octant| finer(&above, octant)).collect();
        assert_eq!(children.iter().filter(|child| **child == fine).count(), 1);
        assert!(children.iter().all(|child| coarser(child) == Some(above)));
    }
    // A 256th in each of three axes, on half of the borders.
    assert!(off > 0 && off < 20_000 / 64, "{off}");
    let top = Key { cell: [1, 2, 3], attributes: MAX_LEVEL };
    assert_eq!((coarser(&top), finer(&Key { attributes: 0, ..top }, 0)), (None, None));
}

/// Removal by chance from tables of any load: what is left is found, with its sums, and the table stays valid.
#[test]
fn removal_leaves_no_gaps() {
    const CELLS: u32 = 256;
    for (load, probes) in [(0.5, 32), (0.9, 64), (1.0, 64), (1.2, 8)] {
        let params = params(probes, 0.0);
        let words = storage::<Lasting>(CELLS as usize, &params);
        let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
        let keys = (0..(f64::from(CELLS) * load) as i32).map(|i| Key { cell: [i, -i, 3], attributes: 4 });
        let keys: Vec<Key> = keys.collect();
        let refused = keys.iter().filter(|key| table.claim(key) == Claim::Refused).count();
        assert!(if load > 1.1 { refused > 0 } else { refused < 10 }, "load {load}: {refused} refused");
        for step in [Naming::First, Naming::Second] {
            for key in &keys {
                table.name(key, step);
            }
        }
        let mut model = BTreeMap::new();
        for (i, key) in keys.iter().enumerate() {
            // Some were refused.
            if let Some(slot) = table.find_named(key) {
                let sums = Sums { count: i as u32 + 1, light: [i as u64; 6], squares: 0 };
                table.set_sums(slot, &sums);
                model.insert(*key, sums);
            }
        }
        let mut turn = 0;
        while !model.is_empty() {
            turn += 1;
            let victim = *model.keys().nth(pcg(turn) as usize % model.len()).unwrap();
            table.remove(table.find_named(&victim).expect("still there"));
            model.remove(&victim);
            assert_eq!(table.find_named(&victim), None);
            assert_eq!(table.validate().expect("a valid table").occupied as usize, model.len());
            for (key, sums) in &model {
                assert_eq!(table.sums(table.find_named(key).expect("kept")), *sums, "load {load}");
            }
        }
    }
}

/// Eviction at several loads: energy stays but for what is reported, the target is met but for coarser cells that had to
/// be made, means of what is folded stay, and the same happens for the same frames.
#[test]
fn eviction_keeps_the_energy() {
    let by = CountAndAge { half_life: 4 };
    for (vertices, target) in [(3000, 900), (6000, 512), (20_000, 1000), (20_000, 0)] {
        let mut last: Option<(Evicted, u64)> = None;
        for _ in 0..2 {
            let params = params(32, 1.0);
            let words = storage::<Lasting>(2048, &params);
            let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
            for index in 0..3 {
                frame(&table, &params, &wall(vertices, index, 0.02), index);
            }
            let (before, deposits) = (energy(&table), table.cells().map(|cell| u64::from(cell.count)).sum::<u64>());
            let cells = table.cells().count() as u32;
            let evicted = evict(&table, target, 3, &by);
            let after = energy(&table);
            assert_eq!(before, after.wrapping_add(evicted.energy_lost));
            assert!(evicted.energy_lost <= before / 1_000_000, "room was there: {evicted:?}");
            assert_eq!(table.cells().map(|cell| u64::from(cell.count)).sum::<u64>(), deposits);
            let left = table.cells().count() as u32;
            assert_eq!(left, cells - evicted.empty - evicted.removed + evicted.made);
            assert!(cells > target && left <= target + evicted.made && evicted.made < evicted.removed, "{evicted:?}");
            // Nothing to do the second time, or less.
            let again = evict(&table, left, 3, &by);
            assert_eq!((again.removed, again.empty), (0, 0));
            assert!(last.is_none_or(|last| last == (evicted, after)));
            last = Some((evicted, after));
        }
    }
}

/// Evicting round after round ends at the coarsest level, and only there light is lost.
#[test]
fn repeated_eviction_ends_at_the_coarsest_level() {
    let params = params(32, 1.0);
    let words = storage::<Lasting>(2048, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    frame(&table, &params, &wall(5000, 1, 0.02), 0);
    let before = energy(&table);
    let mut lost = 0;
    for round in 0..40 {
        let evicted = evict(&table, 0, 1, &LeastRecent);
        lost += evicted.energy_lost;
        assert_eq!(energy(&table) + lost, before);
        let lowest = table.cells().filter_map(|cell| Some(table.key(cell.slot)?.level())).min();
        assert!(lowest.is_none_or(|level| level > round), "round {round}: {lowest:?}");
        assert!(lost == 0 || lowest.is_none());
    }
    assert_eq!((table.cells().count(), lost), (0, before));
}

/// The longest unused leave first.
#[test]
fn least_recently_used_cells_leave_first() {
    let params = params(32, 0.0);
    let words = storage::<Lasting>(4096, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    for index in 0..4 {
        let shifted = wall(400, index, 0.02).into_iter().map(|mut vertex| {
            vertex.position_footprint[2] = index as f32;
            vertex
        });
        frame(&table, &params, &shifted.collect::<Vec<_>>(), 10 * index);
    }
    let by_age = |age| table.cells().filter(|cell| table.stamp(cell.slot) == age && cell.count > 0).count();
    let counts: Vec<usize> = [0, 10, 20, 30].map(by_age).to_vec();
    let keep = counts[2] + counts[3] + counts[1] / 2;
    let evicted = evict(&table, keep as u32, 31, &LeastRecent);
    assert_eq!(evicted.removed as usize, counts.iter().sum::<usize>() - keep);
    assert_eq!((by_age(20), by_age(30)), (counts[2], counts[3]));
    // Half of the second frame's cells remain; the rest of it and the first are in coarser cells of these stamps.
    let fine = |stamp| {
        let at = |slot| table.stamp(slot) == stamp && table.key(slot).unwrap().level() == 5;
        table.cells().filter(|cell| at(cell.slot)).count()
    };
    assert_eq!(fine(0), 0);
    assert_eq!(fine(10), counts[1] / 2);
    assert_eq!([LeastRecent.priority(1, 0), LeastRecent.priority(9, 70)], [MAX_PRIORITY, 0]);
    assert_eq!(CountAndAge { half_life: 0 }.priority(u32::MAX, u32::MAX), 0);
    assert_eq!(CountAndAge { half_life: 7 }.priority(MAX_DEPOSITS, 0), 60);
}

/// Mean light by column of the wall, where the table has any.
fn ramp<L: Layout>(table: &Table<'_, L>, params: &Params, footprint: f32) -> (f64, u32) {
    let (mut error, mut known) = (0.0_f64, 0);
    for vertex in wall(500, 99, footprint) {
        let key = key(params, &vertex, SALT_DEPOSIT).unwrap();
        let Some(slot) = table.find_named(&key).filter(|slot| table.sums(*slot).count > 0) else { continue };
        let expected = (vertex.position_footprint[0] + 1.7) / 4.0;
        let found = table.sums(slot).mean_direct(params.quantum())[0];
        error = error.max(f64::from((found - expected).abs()));
        known += 1;
    }
    (error, known)
}

/// A camera that goes away or comes near by one level: what the old level knew is known on the new one, before a single
/// deposit, and not a quantum more or less.
#[test]
fn light_changes_level_with_the_camera() {
    for factor in [2.0_f32, 0.5] {
        let params = params(32, 0.0);
        let words = storage::<Complete>(16_384, &params);
        let table = Table::<Complete>::with_layout(&words, &params).unwrap();
        frame(&table, &params, &wall(20_000, 1, 0.02), 0);
        let (before, count) = (energy(&table), table.cells().map(|cell| cell.count).sum::<u32>());
        let (error, known) = ramp(&table, &params, 0.02);
        assert!(error < 0.04 && known == 500);

        let next = wall(20_000, 2, 0.02 * factor);
        claim_vertices(&table, &params, &next);
        name_vertices(&table, &params, &next, Naming::First);
        name_vertices(&table, &params, &next, Naming::Second);
        touch_vertices(&table, &params, &next, 1);
        assert_eq!(ramp(&table, &params, 0.02 * factor).1, 0, "new cells know nothing");
        let inherited = inherit(&table, 1, 1000);
        assert_eq!(energy(&table), before);
        assert_eq!(table.cells().map(|cell| cell.count).sum::<u32>(), count);
        let (error, known) = ramp(&table, &params, 0.02 * factor);
        // A cell of 1/8 m of a ramp of 1 in 4 m, coarser cells twice that; fine cells have the mean of the coarse one.
        assert!(error < 0.08 && known > 490, "factor {factor}: off by {error}, {known} known, {inherited:?}");
        if factor > 1.0 {
            assert!(inherited.summed > 900 && inherited.shared == 0, "{inherited:?}");
        } else {
            assert!(inherited.shared > 3000 && inherited.summed == 0, "{inherited:?}");
        }
        assert_eq!(inherit(&table, 1, 1000), Inherited::default(), "nobody is new any more");
        assert_eq!(deposit(&table, &params, &next).balance(), 0);
    }
}

fn deposit<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) -> Counters {
    let mut counters = Counters::default();
    deposit_vertices(table, params, vertices, &mut counters);
    counters
}

/// A bound on what is inherited leaves the rest with the coarser cell, and cells still in use keep what they have.
#[test]
fn inheritance_is_bounded() {
    let params = params(32, 0.0);
    let words = storage::<Lasting>(4096, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    let (coarse, fine) = (wall(20_000, 1, 0.04), wall(20_000, 2, 0.02));
    frame(&table, &params, &coarse, 0);
    let before = energy(&table);
    claim_vertices(&table, &params, &fine);
    name_vertices(&table, &params, &fine, Naming::First);
    name_vertices(&table, &params, &fine, Naming::Second);
    touch_vertices(&table, &params, &fine, 1);
    inherit(&table, 1, 3);
    assert_eq!(energy(&table), before);
    let of = |level: u32| table.cells().filter(move |cell| table.key(cell.slot).unwrap().level() == level);
    let levels: Vec<u32> = table.cells().map(|cell| table.key(cell.slot).unwrap().level()).collect();
    let (low, high) = (*levels.iter().min().unwrap(), *levels.iter().max().unwrap());
    assert_eq!(high - low, 1);
    assert!(of(low).all(|cell| cell.count <= 3) && of(low).filter(|cell| cell.count == 3).count() > 500);
    assert!(of(high).filter(|cell| cell.count > 30).count() > 200);

    // Both levels in use: summing up takes nothing from below, since it is needed there.
    let words = storage::<Lasting>(4096, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    frame(&table, &params, &fine, 0);
    let both: Vec<_> = fine.iter().chain(&coarse).copied().collect();
    claim_vertices(&table, &params, &both);
    name_vertices(&table, &params, &both, Naming::First);
    name_vertices(&table, &params, &both, Naming::Second);
    touch_vertices(&table, &params, &both, 1);
    assert_eq!(inherit(&table, 1, 1000), Inherited::default());
}

/// The whole life of a lasting table: frames merged, levels changed, cells evicted, for a camera that comes near and
/// goes away; energy in and out agrees to the last quantum in every frame.
#[test]
fn a_moving_camera_keeps_the_balance() {
    let params = params(32, 1.0);
    let words: Vec<_> = (0..2).map(|_| storage::<Lasting>(2048, &params)).collect();
    let [lasting, one] = [0, 1].map(|k| Table::<Lasting>::with_layout(&words[k], &params).unwrap());
    let (mut balance, mut lost) = (0_u64, 0_u64);
    for index in 0..24_u32 {
        let footprint = 0.015 * 2.0_f32.powi((index as i32 % 12 - 6).abs() / 2);
        one.clear();
        frame(&one, &params, &wall(1500, index, footprint), index);
        let merge = Merge::new(&lasting, &one).unwrap();
        let slots = 0..merge.slots();
        merge.claim(slots.clone());
        merge.name(slots.clone(), Naming::First);
        merge.name(slots.clone(), Naming::Second);
        merge.touch(slots.clone(), index);
        inherit(&lasting, index, 16);
        let merged = merge.add(slots, &Integrate, index);
        balance += merged.energy_added - merged.energy_faded;
        assert_eq!(energy(&lasting), balance);
        let evicted = evict(&lasting, 1024, index, &CountAndAge { half_life: 6 });
        balance -= evicted.energy_lost;
        lost += evicted.energy_lost;
        assert_eq!(energy(&lasting), balance);
        assert!(lasting.load() < 0.8, "{}", lasting.load());
    }
    assert!(lost < balance / 1_000_000, "{lost} of {balance} lost");
}
