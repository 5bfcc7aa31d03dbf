//! The whole life of a lasting table, and of points, at the ends of every range: cells of 10 µm and of 100 km, scenes a
//! thousand kilometres off, tables with half and with six fifths as many keys as cells, light from 2⁻⁴⁰ to 2⁴⁰.

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::exact::Quantum;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::evict::{CountAndAge, evict};
use hashgrid::layout::{Complete, Layout};
use hashgrid::levels::{inherit, touch_vertices};
use hashgrid::merge::Merge;
use hashgrid::names::{Naming, name_vertices};
use hashgrid::temporal::{Adaptive, FixedCount, Integrate, MovingAverage, Rule};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{Params, Settings, Table, Word, points};

const CELLS: usize = 1024;

fn storage(params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..CELLS * Complete::WORDS).map(|_| Word::new(7)).collect();
    table(&words, params).clear();
    words
}

fn table<'a>(words: &'a [Word], params: &Params) -> Table<'a, Complete> {
    Table::with_layout(words, params).expect("storage of a test")
}

/// A wall of about `cells` cells of `size`, `offset` away from the origin.
fn wall(cells: f32, size: f32, offset: f32, light: f32, seed: u32) -> Vec<VertexRecord> {
    let edge = size * cells.sqrt();
    (0..3000)
        .map(|i| {
            let [a, b, c, d] = pcg4d([i, seed, 31, 9]).map(to_unit_f32);
            VertexRecord {
                position_footprint: [offset + a * edge, b * edge - offset, offset, size / 8.0],
                direct: [light * c, light * d, 0.0, 0.0],
                further: [light; 4],
                normal: octahedral_encode(Vec3::new(0.1, 0.2, 1.0).normalize()),
                direction: octahedral_encode(Vec3::NEG_Z),
                seed: i ^ (seed << 16),
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

/// Five frames with a camera that goes away: merged by the rule, levels changed, cells evicted; energy agrees after every
/// step to the last quantum, and every answer is finite.
fn live(rule: &impl Rule, size: f32, offset: f32, light: f32, load: f32) {
    let at = format!("cells of {size} m, {offset} m off, light {light:e}, load {load}");
    let settings = Settings {
        base_size: size,
        max_probes: 16,
        normal_bins: 1,
        pixel_angle: 0.01,
        quantum: Quantum::for_scale(light),
        ..Settings::default()
    };
    let params = Params::new(&settings).unwrap();
    let words = [storage(&params), storage(&params)];
    let [lasting, frame] = [0, 1].map(|k| table(&words[k], &params));
    let energy = || lasting.validate().unwrap_or_else(|violation| panic!("{at}: {violation}")).energy;
    let mut balance = 0_u64;
    for index in 0..5_u32 {
        let scale = if index < 3 { 1.0 } else { 2.0 };
        let vertices = wall(load * CELLS as f32 * 0.2, size * scale, offset, light, index);
        let mut counters = Counters::default();
        frame.clear();
        claim_vertices(&frame, &params, &vertices);
        name_vertices(&frame, &params, &vertices, Naming::First);
        name_vertices(&frame, &params, &vertices, Naming::Second);
        touch_vertices(&frame, &params, &vertices, index);
        deposit_vertices(&frame, &params, &vertices, &mut counters);
        assert_eq!((counters.balance(), counters.deposits), (0, 3000), "{at}");
        let merge = Merge::new(&lasting, &frame).unwrap();
        let slots = 0..merge.slots();
        merge.claim(slots.clone());
        merge.name(slots.clone(), Naming::First);
        merge.name(slots.clone(), Naming::Second);
        merge.touch(slots.clone(), index);
        inherit(&lasting, index, 100);
        assert_eq!(energy(), balance, "{at}");
        let merged = merge.add(slots, rule, index);
        assert_eq!(merged.energy_added + merged.energy_refused, counters.energy_stored, "{at}");
        balance = balance.wrapping_add(merged.energy_added).wrapping_sub(merged.energy_faded);
        assert_eq!(energy(), balance, "{at}");
        let evicted = evict(&lasting, CELLS as u32 / 2, index, &CountAndAge { half_life: 2 });
        balance = balance.wrapping_sub(evicted.energy_lost);
        assert_eq!(energy(), balance, "{at}");
        let mut answers = 0;
        estimate_vertices(&lasting, &params, &vertices, &mut counters, |_, estimate| {
            let most = 1.01 * light;
            let fits = |v: Vec3| v.is_finite() && v.min_element() >= 0.0 && v.max_element() <= most;
            answers += u32::from(fits(estimate.direct) && fits(estimate.further));
        });
        assert_eq!(answers, 3000, "{at}");
        assert!(counters.hits > 500, "{at}: {counters:?}");
    }
}

#[test]
fn lasting_tables_live_at_every_scale() {
    for size in [1e-5, 0.1, 1e5] {
        for offset in [0.0, 1e6, -1e6] {
            live(&FixedCount { most: 50 }, size, offset, 1.0, 0.5);
        }
    }
}

#[test]
fn lasting_tables_live_at_every_load_and_brightness() {
    for load in [0.5, 0.7, 0.9, 1.0, 1.2] {
        live(&Integrate, 0.1, 0.0, 1.0, load);
        live(&MovingAverage::new(0.8).unwrap(), 0.1, -3.0, 3.0, load);
    }
    for exponent in [-40, -20, 20, 40] {
        live(&Adaptive { gain: 1, most: 1 << 20 }, 0.1, 10.0, 2.0_f32.powi(exponent), 0.7);
    }
}

/// Points at the same ends: light comes back, and far off, where floats are coarser than cubes, levels rise by themselves.
#[test]
fn points_live_at_every_scale() {
    for size in [1e-5, 0.1, 1e5] {
        for offset in [0.0, 1e6, -1e6] {
            let params = Params::new(&Settings { base_size: size, ..Settings::default() }).unwrap();
            let words = storage(&params);
            let table = table(&words, &params);
            let vertices = &wall(100.0, size, offset, 1.0, 1)[..500];
            let mut counters = Counters::default();
            points::claim_vertices(&table, &params, vertices);
            points::name_vertices(&table, &params, vertices, Naming::First);
            points::name_vertices(&table, &params, vertices, Naming::Second);
            points::deposit_vertices(&table, &params, vertices, &mut counters);
            assert_eq!((counters.refusals, counters.balance()), (0, 0));
            points::estimate_vertices(&table, &params, vertices, 1.0, 0, &mut counters, |_, estimate| {
                assert!((estimate.further.x - 1.0).abs() < 1e-5 && estimate.samples > 0, "{size} {offset}");
            });
        }
    }
}
