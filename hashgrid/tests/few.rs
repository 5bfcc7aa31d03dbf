//! Cells with few vertices: sums over levels, searches, and what they are good for.

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::few::{ByError, Levels, Neighbours, Search, claim_levels, deposit_levels, estimate_by, name_levels};
use hashgrid::key::finer;
use hashgrid::layout::{Complete, Layout, Measured};
use hashgrid::names::Naming;
use hashgrid::sums::Sums;
use hashgrid::vertex::estimate_vertices;
use hashgrid::{Params, Settings, Table, Word};

fn storage<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(7)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

fn params(jitter: f32) -> Params {
    Params::new(&Settings { base_size: 1.0 / 256.0, jitter, ..Settings::default() }).unwrap()
}

/// A wall of 4 m across `axis`, lit by `light(x)` on average, by noise of twice that.
fn wall(count: u32, seed: u32, axis: usize, light: impl Fn(f32) -> f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let [a, b, c, _] = pcg4d([i, seed, 3, 9]).map(to_unit_f32);
            let (mut place, mut normal) = ([0.1, 4.0 * a - 2.0, 4.0 * b - 2.0], [1.0, 0.0, 0.0]);
            place.rotate_right(axis);
            normal.rotate_right(axis);
            VertexRecord {
                position_footprint: [place[0], place[1], place[2], 0.01],
                further: [2.0 * c * light(4.0 * a - 2.0); 4],
                normal: octahedral_encode(Vec3::from_array(normal)),
                direction: octahedral_encode(-Vec3::from_array(normal)),
                seed: i ^ (seed << 20),
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

fn fill<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], levels: u32) {
    let mut counters = Counters::default();
    assert!(!claim_levels(table, params, vertices, levels));
    for step in [Naming::First, Naming::Second] {
        name_levels(table, params, vertices, levels, step);
    }
    deposit_levels(table, params, vertices, levels, &mut counters);
    assert_eq!((counters.balance(), counters.refusals), (0, 0));
    assert_eq!(counters.deposits, u64::from(levels) * vertices.len() as u64);
    assert_eq!(table.validate().expect("valid").energy, counters.energy_stored);
}

/// A coarser cell holds exactly what the finer ones in it hold, moments too.
#[test]
fn coarser_cells_hold_the_sum_of_finer_ones() {
    let params = params(0.0);
    let words = storage::<Complete>(1 << 14, &params);
    let table = Table::<Complete>::with_layout(&words, &params).unwrap();
    fill(&table, &params, &wall(3000, 1, 0, |x| x + 2.5), 4);
    let keys: Vec<_> = table.cells().map(|cell| (cell.slot, table.key(cell.slot).expect("named"))).collect();
    let lowest = keys.iter().map(|(_, key)| key.level()).min().unwrap();
    for (slot, key) in keys.iter().filter(|(_, key)| key.level() > lowest) {
        let children = (0..8).filter_map(|octant| table.find_named(&finer(key, octant)?));
        let sum = children.fold(Sums::default(), |sum, child| sum.plus(&table.sums(child)));
        assert_eq!(sum, table.sums(*slot));
    }
    assert_eq!(keys.iter().map(|(_, key)| key.level()).max().unwrap(), lowest + 3);
}

fn error<S: Search>(table: &Table<'_, Measured>, params: &Params, search: &S, light: impl Fn(f32) -> f32) -> [f64; 2] {
    let (asked, mut counters) = (wall(2000, 7, 0, |_| 0.0), Counters::default());
    let (mut squares, mut samples) = (0.0, 0.0);
    estimate_by(table, params, &asked, search, &mut counters, |i, estimate| {
        let truth = f64::from(light(asked[i].position_footprint[1]));
        squares += (f64::from(estimate.further.x) - truth).powi(2) / 2000.0;
        samples += f64::from(estimate.samples) / 2000.0;
    });
    assert_eq!(counters.lookups, counters.hits + counters.fallbacks);
    [squares, samples]
}

/// On even light with few vertices a cell, both searches take the noise away; and on none they lose light.
#[test]
fn searches_take_noise_away() {
    let params = params(1.0);
    let words = storage::<Measured>(1 << 14, &params);
    let table = Table::<Measured>::with_layout(&words, &params).unwrap();
    fill(&table, &params, &wall(3000, 2, 0, |_| 1.0), 4);
    let even = |_| 1.0;
    let own = error(&table, &params, &Neighbours { least: 0 }, even);
    let neighbours = error(&table, &params, &Neighbours { least: 8 }, even);
    let levels = error(&table, &params, &Levels { least: 8, levels: 4 }, even);
    let by_error = error(&table, &params, &ByError { least: 4, levels: 4, tolerance: 3.0 }, even);
    assert!(neighbours[0] * 3.0 < own[0] && neighbours[1] > 3.0 * own[1], "{own:?} {neighbours:?}");
    assert!(levels[0] * 3.0 < own[0], "{own:?} {levels:?}");
    assert!(by_error[0] * 10.0 < own[0] && by_error[1] > 30.0, "{own:?} {by_error:?}");
}

/// On a shadow's edge with many vertices a cell, the error decides: as good as coarse cells where light is even, as
/// good as fine ones at the edge, and so better than either.
#[test]
fn errors_choose_the_level() {
    let params = params(1.0);
    let words = storage::<Measured>(1 << 14, &params);
    let table = Table::<Measured>::with_layout(&words, &params).unwrap();
    let edge = |x: f32| if x < 0.08 { 1.0 } else { 0.1 };
    fill(&table, &params, &wall(30_000, 3, 0, edge), 4);
    let fine = error(&table, &params, &Levels { least: 0, levels: 1 }, edge);
    let coarse = error(&table, &params, &Levels { least: 1000, levels: 4 }, edge);
    let by_error = error(&table, &params, &ByError { least: 8, levels: 4, tolerance: 3.0 }, edge);
    assert!(by_error[0] < 0.7 * fine[0] && by_error[0] < 0.7 * coarse[0], "{fine:?} {coarse:?} {by_error:?}");
}

/// With nothing to search for, the plain lookup; neighbours lie in the wall's plane, for walls across every axis.
#[test]
fn searches_agree_with_plain_lookups() {
    for axis in 0..3 {
        let params = params(1.0);
        let words = storage::<Measured>(1 << 14, &params);
        let table = Table::<Measured>::with_layout(&words, &params).unwrap();
        let vertices = wall(2000, 4, axis, |x| x + 2.0);
        fill(&table, &params, &vertices, 1);
        let (mut plain, mut searched, mut wide) = (vec![], vec![], 0);
        let mut counters = [Counters::default(); 3];
        estimate_vertices(&table, &params, &vertices, &mut counters[0], |_, estimate| plain.push(estimate));
        let none = Neighbours { least: 0 };
        estimate_by(&table, &params, &vertices, &none, &mut counters[1], |_, estimate| searched.push(estimate));
        let eight = Neighbours { least: 1 << 20 };
        estimate_by(&table, &params, &vertices, &eight, &mut counters[2], |i, estimate| {
            wide += u32::from(estimate.samples >= 4 * plain[i].samples);
        });
        assert_eq!(plain, searched);
        assert_eq!(counters[0], counters[1]);
        // Nine cells instead of one, for most.
        assert!(wide > 1000, "axis {axis}: {wide}");
    }
}

/// No light and no position: counted, and finite.
#[test]
fn searches_survive_anything() {
    let params = params(1.0);
    let words = storage::<Measured>(64, &params);
    let table = Table::<Measured>::with_layout(&words, &params).unwrap();
    let mut lost = wall(3, 1, 0, |_| 1.0);
    lost[0].position_footprint[1] = f32::NAN;
    lost[1].further = [f32::INFINITY; 4];
    lost[2].flags = 0;
    claim_levels(&table, &params, &lost, 40);
    let mut counters = Counters::default();
    deposit_levels(&table, &params, &lost, 40, &mut counters);
    assert_eq!(counters.balance(), 0);
    let levels = counters.deposits - 1;
    assert!(levels > 20 && levels <= 32 && counters.non_finite == 3 * levels, "{counters:?}");
    table.validate().expect("valid");
    let search = ByError { least: 0, levels: 40, tolerance: f32::NAN };
    let mut answers = 0;
    estimate_by(&table, &params, &lost, &search, &mut counters, |_, estimate| {
        assert!(estimate.further.is_finite());
        answers += 1;
    });
    assert_eq!((answers, counters.lookups, counters.hits, counters.fallbacks), (3, 2, 1, 1));
}
