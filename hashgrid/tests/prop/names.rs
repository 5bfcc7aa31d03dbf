use std::thread;

use hashcache_core::counters::Counters;
use hashgrid::Key;
use hashgrid::key::{fingerprint, home};
use hashgrid::keyed::name_keyed;
use hashgrid::layout::{Lasting, Layout, Standard};
use hashgrid::names::{Naming, name_vertices};
use hashgrid::vertex::{claim_vertices, deposit_vertices};

use super::layouts::storage_of;
use super::*;

/// Keys whose tags are equal in a table of 64 cells, two by two: found among half a million.
fn twins() -> Vec<[Key; 2]> {
    let mut all: Vec<(u32, u32, Key)> = (0..1 << 19)
        .map(|i: i32| Key { cell: [i & 1023, i >> 10, 7], attributes: 5 | (4 << 8) })
        .map(|key| (home(&key) & 63, fingerprint(&key), key))
        .collect();
    all.sort_unstable();
    let pairs = all.windows(2).filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1));
    pairs.map(|pair| [pair[0].2, pair[1].2]).collect()
}

/// Two keys of one tag: without names one takes the other's light, with names the smaller key has the cell, whoever
/// comes first, and the other none.
#[test]
fn names_end_false_matches() {
    let params = params(still());
    let twins = twins();
    // 2³⁸/2 pairs of keys in 2⁶·2²⁵ tags: 64.
    assert!(twins.len() > 32 && twins.len() < 128, "{}", twins.len());
    let words = storage_of::<Lasting>(64, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    for [a, b] in twins {
        for order in [[a, b], [b, a]] {
            table.clear();
            for key in &order {
                table.claim(key);
            }
            assert!(order.iter().all(|key| table.find(key).slot.is_some()), "one tag");
            for step in [Naming::First, Naming::Second] {
                for key in &order {
                    table.name(key, step);
                }
            }
            assert_eq!(table.cells().count(), 1);
            let owner = if a.words() < b.words() { a } else { b };
            let found = order.map(|key| table.find_named(&key).is_some());
            assert_eq!(found, order.map(|key| key == owner));
        }
    }
}

/// A layout without keys asks nobody for one, and its table stays as it was.
#[test]
fn without_keys_nothing_is_named() {
    let params = params(still());
    let words = storage_of::<Standard>(64, &params);
    let table = Table::<Standard>::with_layout(&words, &params).unwrap();
    let vertices = room(16, 1);
    claim_vertices(&table, &params, &vertices);
    let before = bits(&words);
    for step in [Naming::First, Naming::Second] {
        name_keyed(&table, &vertices, |_| panic!("asked for a key"), step);
        name_vertices(&table, &params, &vertices, step);
        hashgrid::few::name_levels(&table, &params, &vertices, 3, step);
        hashgrid::points::name_vertices(&table, &params, &vertices, step);
    }
    assert!(bits(&words) == before);
}

/// Claims, names and deposits of the same new keys by many threads at once: the same words as by one, names right,
/// nobody named twice; and later frames rename nobody.
#[test]
fn threads_agree_on_names() {
    let params = params(Settings { base_size: 1.0 / 32.0, max_probes: 16, ..Settings::default() });
    let frames = [room(6000, 1), room(6000, 2)];
    let mut tables = vec![];
    for threads in [1, 4] {
        let words = storage_of::<Lasting>(1 << 11, &params);
        let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
        for frame in &frames {
            let part = frame.len().div_ceil(threads);
            let run = |step: &(dyn Fn(&[VertexRecord]) + Sync)| {
                // Every thread works on all vertices when there are several: the same new keys at the same moment.
                thread::scope(|scope| {
                    for first in (0..frame.len()).step_by(part) {
                        scope.spawn(move || {
                            step(&frame[first..]);
                            step(&frame[..first]);
                        });
                    }
                });
            };
            run(&|part| {
                claim_vertices(&table, &params, part);
            });
            run(&|part| name_vertices(&table, &params, part, Naming::First));
            run(&|part| name_vertices(&table, &params, part, Naming::Second));
            let mut counters = Counters::default();
            deposit_vertices(&table, &params, frame, &mut counters);
            assert_eq!(counters.balance(), 0);
            assert!(counters.refusals > 0 && counters.refusals < 6000, "{}", counters.refusals);
        }
        table.validate().expect("a valid table");
        for cell in table.cells() {
            let key = table.key(cell.slot).expect("a name");
            assert_eq!(table.find_named(&key), Some(cell.slot));
            assert_eq!(cell.home(table.capacity()), table.home_slot(&key));
        }
        tables.push(bits(&words));
    }
    assert!(tables[0] == tables[1]);
    assert_eq!(Lasting::WORDS, 10);
}
