//! Host bodies of the kernels: any cut of a dispatch into launches gives the same bytes.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use backend_api::{Kernel, Launch, Slot, Status};
use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use hashgrid::kernels::{CLAIM, CLEAR, DEPOSIT, LOOKUP};
use hashgrid::{CELL_WORDS, Params, Settings, Table};

const CELLS: usize = 256;

fn vertices() -> Vec<VertexRecord> {
    let mut vertices: Vec<_> = (0..1000_u32)
        .map(|i| VertexRecord {
            position_footprint: [(i % 40) as f32 * 0.01, (i / 40) as f32 * 0.01, 0.0, 0.0005],
            direct: [i as f32 * 0.01, 1.0, 1e-9, 0.0],
            further: [0.5, 20_000.0, 0.0, 0.0],
            seed: i,
            flags: u32::from(i % 50 != 7),
            ..VertexRecord::zeroed()
        })
        .collect();
    vertices[3].direct[0] = f32::NAN;
    vertices[4].position_footprint[0] = f32::INFINITY;
    vertices
}

struct Run {
    table: Vec<AtomicU64>,
    counters: Vec<AtomicU64>,
    estimates: Vec<EstimateRecord>,
    statuses: Vec<u32>,
}

/// Runs `kernel` over `items` items in launches of at most `cut`.
fn launch(kernel: &Kernel, params: &Params, run: &mut Run, vertices: &[VertexRecord], items: u32, cut: u32) {
    let status = AtomicU32::new(0);
    for first in (0..items).step_by(cut as usize) {
        let count = cut.min(items - first);
        let out = &mut run.estimates[first as usize % vertices.len()..][..(count as usize).min(vertices.len())];
        let mut slots = [
            Slot::AtomicU64(&run.table),
            Slot::In(bytemuck::cast_slice(vertices)),
            Slot::AtomicU64(&run.counters),
            Slot::Out(bytemuck::cast_slice_mut(out)),
        ];
        let params = bytemuck::bytes_of(params);
        let slots = &mut slots[..kernel.bindings.len()];
        (kernel.body)(&mut Launch { first, count, params, slots, status: &status, rays: None });
    }
    run.statuses.push(status.into_inner());
}

fn run(params: &Params, cells: usize, cut: u32) -> Run {
    let vertices = vertices();
    let word = |_| AtomicU64::new(0);
    let mut run = Run {
        table: (0..cells * CELL_WORDS).map(word).collect(),
        counters: (0..Counters::WORDS).map(word).collect(),
        estimates: vec![EstimateRecord::zeroed(); vertices.len()],
        statuses: vec![],
    };
    launch(&CLEAR, params, &mut run, &vertices, cells as u32, cut);
    for kernel in [&CLAIM, &DEPOSIT, &LOOKUP] {
        launch(kernel, params, &mut run, &vertices, vertices.len() as u32, cut);
    }
    run
}

fn words(atomics: &[AtomicU64]) -> Vec<u64> {
    atomics.iter().map(|word| word.load(Relaxed)).collect()
}

#[test]
fn cuts_do_not_matter() {
    let params = Params::new(&Settings { max_probes: 8, ..Settings::default() }).unwrap();
    let whole = run(&params, CELLS, 1000);
    Table::new(&whole.table, &params).unwrap().validate().expect("a valid table");
    let counters = Counters::from_words(&words(&whole.counters));
    assert_eq!((counters.deposits, counters.lookups, counters.balance()), (980, 980, 0));
    assert!(counters.clamped > 0 && counters.underflowed > 0 && counters.non_finite > 0 && counters.hits > 0);
    let flags = Status::from_bits(whole.statuses[2]);
    assert!(flags.contains(Status::NON_FINITE) && !flags.contains(Status::OVERFLOW));
    for cut in [1, 7, 16, 333] {
        let other = run(&params, CELLS, cut);
        assert!(words(&other.table) == words(&whole.table), "launches of {cut}");
        assert_eq!(words(&other.counters), words(&whole.counters), "launches of {cut}");
        assert_eq!(other.statuses, whole.statuses, "launches of {cut}");
        assert!(other.estimates == whole.estimates, "launches of {cut}");
    }
}

#[test]
fn a_table_of_a_wrong_size_raises_a_flag() {
    let params = Params::new(&Settings::default()).unwrap();
    let run = run(&params, 100, 1000);
    assert_eq!(run.statuses, [Status::TABLE_FULL.bits(); 4]);
    assert!(words(&run.table).iter().all(|word| *word == 0));
}
