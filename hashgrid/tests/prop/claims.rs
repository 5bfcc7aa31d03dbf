use std::collections::{BTreeMap, BTreeSet};
use std::thread;

use hashcache_core::counters::Counters;
use hashcache_core::hash::pcg;
use hashgrid::Claim;
use hashgrid::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use hashgrid::key::key;
use hashgrid::tag::tag_distance;
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_slots};

use super::*;

const CELLS: usize = 1 << 12;

/// A key by home and fingerprint.
type Identity = (u32, u32);

/// `count` different keys for a table of [`CELLS`] cells; some share fingerprints, some share homes.
fn identities(count: u32, seed: u32) -> Vec<Identity> {
    let mut all = BTreeSet::new();
    let mut i = 0;
    while (all.len() as u32) < count {
        let r = pcg4d([i, seed, 2, 3]);
        // Every fourth key has an even home, every eighth one of 16 fingerprints.
        let home = r[0] & if i.is_multiple_of(4) { CELLS as u32 - 2 } else { CELLS as u32 - 1 };
        all.insert((home, r[1] >> if i.is_multiple_of(8) { 28 } else { 7 }));
        i += 1;
    }
    all.into_iter().map(|(home, f)| (home, f.min((1 << 25) - 2))).collect()
}

fn shuffle<T>(items: &mut [T], seed: u32) {
    for i in (1..items.len()).rev() {
        items.swap(i, pcg(seed ^ (i as u32).wrapping_mul(0x9e37)) as usize % (i + 1));
    }
}

fn value(key: Identity) -> [u64; 6] {
    let v = u64::from(key.0) + 1;
    [v, 0, v << 20, u64::from(key.1), 1, v * v]
}

/// Claims, then deposits, by `threads` threads that each take a part of the shuffled work; every key comes three times.
fn fill(params: &Params, keys: &[Identity], threads: usize, seed: u32) -> (Vec<Word>, u64) {
    let words = storage(CELLS, params);
    frame(&words, params, keys, threads, seed);
    let table = Table::new(&words, params).unwrap();
    let refused = keys.iter().filter(|k| table.find_at(k.0, k.1).slot.is_none()).count();
    (words, refused as u64)
}

fn frame(words: &[Word], params: &Params, keys: &[Identity], threads: usize, seed: u32) {
    let table = Table::new(words, params).unwrap();
    let mut work: Vec<Identity> = (0..3).flat_map(|_| keys.iter().copied()).collect();
    shuffle(&mut work, seed);
    let part = work.len().div_ceil(threads).max(1);
    let run = |step: &(dyn Fn(Identity) + Sync)| {
        thread::scope(|scope| {
            for part in work.chunks(part) {
                scope.spawn(move || part.iter().for_each(|key| step(*key)));
            }
        });
    };
    run(&|key| {
        table.claim_from(key.0, key.1, table.head(key.0));
    });
    run(&|key| {
        let found = table.find_at(key.0, key.1);
        if let Some(slot) = found.slot {
            table.add(slot, found.head, &value(key), 1);
        }
    });
}

/// The same key set gives the same words, the same refusals and the sums of a map, for every order and number of
/// threads, at loads from sparse to overfull.
#[test]
fn layout_depends_on_the_key_set_only() {
    for (load, probes) in [(0.3, 32), (0.9, 32), (0.9, 4), (1.2, 16), (1.2, 64)] {
        let params = params(Settings { max_probes: probes, ..still() });
        let keys = identities((CELLS as f32 * load) as u32, probes);
        let (reference, refused) = fill(&params, &keys, 1, 0);
        let share = refused as f32 / keys.len() as f32;
        let expected = if load < 0.5 {
            0.0..=0.0
        } else if load < 1.0 {
            0.0..=0.3
        } else {
            0.166..=0.3
        };
        assert!(expected.contains(&share), "load {load}, {probes} probes: {refused} refused");
        println!("load {load}, {probes} probes: {refused} of {} refused", keys.len());
        let mut backwards = keys.clone();
        backwards.reverse();
        for (keys, threads, seed) in [(&backwards, 1, 1), (&keys, 2, 2), (&keys, 4, 3), (&backwards, 7, 4)] {
            let (words, others) = fill(&params, keys, threads, seed);
            assert_eq!(others, refused, "load {load}, {threads} threads");
            assert!(bits(&words) == bits(&reference), "load {load}, {threads} threads: another layout");
        }
        compare_with_map(&Table::new(&reference, &params).unwrap(), &keys, refused);
    }
}

/// Every key of the map that was not refused stands in the table with its sums, and nothing else does.
fn compare_with_map(table: &Table<'_>, keys: &[Identity], refused: u64) {
    let mut model: BTreeMap<Identity, (u32, [u64; 6])> = BTreeMap::new();
    for _ in 0..3 {
        for key in keys {
            let (count, sums) = model.entry(*key).or_default();
            *count += 1;
            for (sum, value) in sums.iter_mut().zip(value(*key)) {
                *sum += value;
            }
        }
    }
    let summary = table.validate().expect("a valid table");
    assert_eq!(u64::from(summary.occupied) + refused, model.len() as u64);
    assert_eq!((summary.new, table.cells().count() as u32), (0, summary.occupied));
    let stored = keys.iter().filter_map(|key| Some((key, table.find_at(key.0, key.1).slot?)));
    for (key, slot) in stored {
        let cell = table.cell(slot);
        let (count, sums) = model[key];
        assert_eq!(cell.count, count);
        assert_eq!([cell.direct, cell.further].concat(), sums);
        assert_eq!(cell.home(table.capacity()), key.0);
    }
}

/// Who has deposits keeps the cell: later frames move nobody, whatever their keys and threads.
#[test]
fn later_frames_move_nobody() {
    let params = params(Settings { max_probes: 16, ..still() });
    let frames: Vec<_> = (0..4).map(|f| identities(CELLS as u32 / 3, 100 + f)).collect();
    let mut tables = vec![];
    for threads in [1, 3] {
        let words = storage(CELLS, &params);
        let table = Table::new(&words, &params).unwrap();
        let mut before: Vec<(u32, u32)> = vec![];
        for (f, keys) in frames.iter().enumerate() {
            frame(&words, &params, keys, threads, f as u32 * 7 + threads as u32);
            for (slot, tag) in &before {
                assert_eq!(table.cell(*slot).tag, *tag, "frame {f} moved a settled key");
            }
            before = table.cells().map(|cell| (cell.slot, cell.tag)).collect();
            table.validate().expect("a valid table");
        }
        tables.push(bits(&words));
    }
    assert!(tables[0] == tables[1]);
}

/// Probe sequences wrap at the end of the table, and a full table refuses the largest tags.
#[test]
fn probes_wrap_at_the_end() {
    let params = params(Settings { max_probes: 8, ..still() });
    let words = storage(64, &params);
    let table = Table::new(&words, &params).unwrap();
    for fingerprint in (0..9).rev() {
        table.claim_from(62, fingerprint, table.head(62));
    }
    for fingerprint in 0..8 {
        assert_eq!(table.find_at(62, fingerprint).slot, Some((62 + fingerprint) % 64));
    }
    assert_eq!(table.find_at(62, 8).slot, None);
    assert_eq!(table.claim_from(62, 8, table.head(62)), Claim::Refused);
    assert_eq!(table.claim_from(62, 3, table.head(62)), Claim::Found);
    assert_eq!(table.validate().unwrap().longest, 7);
    assert_eq!(table.cells().map(|cell| tag_distance(cell.tag)).sum::<u32>(), 28);
}

/// Vertices of a scene: any cut into parts and any number of threads give the same table and counters.
#[test]
fn vertices_in_any_order_make_the_same_table() {
    let vertices = room(20_000, 5);
    for (cells, probes) in [(1 << 16, 32), (1 << 13, 32), (1 << 10, 8)] {
        let params = params(Settings { base_size: 1.0 / 32.0, max_probes: probes, ..Settings::default() });
        let mut results = vec![];
        for (threads, seed) in [(1, 0), (2, 1), (5, 2)] {
            let words = storage(cells, &params);
            let table = Table::new(&words, &params).unwrap();
            let mut shuffled = vertices.clone();
            if seed > 0 {
                shuffle(&mut shuffled, seed);
            }
            let parts: Vec<_> = shuffled.chunks(shuffled.len().div_ceil(threads)).collect();
            thread::scope(|s| {
                for part in &parts {
                    s.spawn(|| claim_vertices(&table, &params, part));
                }
            });
            let counters = thread::scope(|s| {
                let tasks: Vec<_> = parts
                    .iter()
                    .map(|part| {
                        s.spawn(|| {
                            let mut counters = Counters::default();
                            deposit_vertices(&table, &params, part, &mut counters);
                            counters
                        })
                    })
                    .collect();
                tasks.into_iter().fold(Counters::default(), |sum, task| sum.merge(&task.join().unwrap()))
            });
            let summary = table.validate().expect("a valid table");
            assert_eq!(summary.energy, counters.energy_stored);
            assert_eq!(summary.deposits + counters.refusals, counters.deposits);
            assert_eq!((counters.balance(), counters.deposits), (0, 20_000));
            results.push((bits(&words), counters));
        }
        assert!(results.iter().all(|result| *result == results[0]), "{cells} cells");
        assert_eq!(results[0].1.refusals > 0, cells < 1 << 16, "{cells} cells: {:?}", results[0].1);
    }
}

/// Storage that is too small or no power of two is refused.
#[test]
fn storage_is_checked() {
    let params = params(still());
    for words in [0, 8, 63 * 8, 65 * 8, 100 * 8, 64 * 8 - 1, 1 << 9 | 1] {
        let storage: Vec<Word> = (0..words).map(|_| Word::new(0)).collect();
        assert!(Table::new(&storage, &params).is_err(), "{words} words");
    }
    assert!(Table::new(&storage(64, &params), &params).is_ok());
}

/// Vertices that are looked for together find what each finds by itself, slot by slot, in a table so full that sequences
/// end in every way: at the key, at an empty slot, and at the last probe.
#[test]
fn batches_find_what_single_lookups_find() {
    let params = params(Settings { base_size: 1.0 / 32.0, max_probes: 6, ..Settings::default() });
    let words = storage(1 << 11, &params);
    let table = Table::new(&words, &params).unwrap();
    // All that is known and some more.
    let (known, mut asked) = (room(2500, 1), room(3001, 1));
    claim_vertices(&table, &params, &known);
    deposit_vertices(&table, &params, &known, &mut Counters::default());
    // Some without a key, some that are no vertex.
    for i in (0..asked.len()).step_by(7) {
        asked[i].position_footprint[0] = f32::NAN;
        asked[i + 1].flags = 0;
    }
    let (mut wanted, mut slots, mut exhausted) = (Counters::default(), vec![], 0);
    for vertex in &asked {
        let found = [SALT_LOOKUP, SALT_DEPOSIT].into_iter().find_map(|salt| {
            let found = table.find(&key(&params, vertex, salt).filter(|_| vertex.is_valid())?);
            wanted.probes += u64::from(found.probes);
            exhausted += u32::from(found.slot.is_none() && found.probes == 6);
            found.slot.filter(|slot| table.cell(*slot).count > 0)
        });
        wanted.lookups += u64::from(vertex.is_valid());
        wanted.hits += u64::from(found.is_some());
        slots.push(found);
    }
    let (mut counters, mut answered) = (Counters::default(), vec![]);
    estimate_slots(&table, &params, &asked, &mut counters, |_, _, slot| answered.push(slot));
    assert!(answered == slots && exhausted > 10, "{exhausted} sequences ended at the last probe");
    assert_eq!([counters.probes, counters.lookups, counters.hits], [wanted.probes, wanted.lookups, wanted.hits]);
    assert!(counters.hits > 500 && counters.fallbacks > 200, "{} hits, {} not", counters.hits, counters.fallbacks);
}
