//! The hash grid on every launcher: equal tables, counters and refusals for equal recorded vertices.

use std::collections::BTreeSet;

use backend_api::{Backend, Binding, BufferDesc, Status};
use backend_cpu::CpuBackend;
use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages, EstimateRecord};
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::vertices::{Noise, Scene, vertices};
use hashgrid::jitter::SALT_DEPOSIT;
use hashgrid::key::key;
use hashgrid::{GridStages, Params, Settings};

/// Cells of the tables: enough for tags of all kinds, few enough to be quick on one thread.
const CELLS: u32 = 1 << 14;

const POISON: u32 = 0xa5a5_a5a5;

/// What a backend makes of a frame.
struct Outcome {
    table: Vec<u32>,
    counters: Counters,
    statuses: Vec<(&'static str, Status)>,
    estimates: Vec<EstimateRecord>,
}

/// Claims, deposits and looks up `frames` one after the other into one table, each cut into batches of `batch`.
fn run<B: Backend>(backend: &mut B, params: Params, frames: &[&[VertexRecord]], batch: usize) -> Outcome {
    let mut grid = GridStages::new(params, CELLS).expect("a valid size");
    grid.prepare(backend).expect("prepare");
    let mut estimates = Vec::new();
    for frame in frames {
        let mut buffers = Vec::new();
        for part in frame.chunks(batch) {
            let size = size_of_val(part) as u64;
            let records = backend.create(&BufferDesc { name: "records", size }).expect("create");
            backend.write(records, 0, bytemuck::cast_slice(part)).expect("write");
            let binding = Binding { buffer: records, offset: 0, size };
            grid.record(backend, binding, part.len() as u32).expect("record");
            buffers.push((binding, part.len()));
        }
        CacheStages::<B>::update(&mut grid, backend).expect("update");
        for (records, count) in buffers {
            let size = (count * size_of::<EstimateRecord>()) as u64;
            let answers = backend.create(&BufferDesc { name: "estimates", size }).expect("create");
            backend.write(answers, 0, bytemuck::cast_slice(&vec![POISON; size as usize / 4])).expect("write");
            let binding = Binding { buffer: answers, offset: 0, size };
            grid.query(backend, records, binding, count as u32).expect("query");
            backend.submit().expect("submit");
            let ticket = backend.read(answers, 0, size).expect("read");
            let bytes = backend.redeem(ticket, true).expect("redeem").expect("waited for");
            estimates.extend(bytemuck::pod_collect_to_vec::<u8, EstimateRecord>(&bytes));
            backend.destroy(answers).expect("alive");
            backend.destroy(records.buffer).expect("alive");
        }
    }
    let ticket = backend.read(grid.table().expect("prepared"), 0, grid.table_bytes()).expect("read");
    let table = bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).expect("redeem").expect("waited for"));
    let ticket = grid.read_counters(backend).expect("read");
    let counters = GridStages::counters(&backend.redeem(ticket, true).expect("redeem").expect("waited for"));
    let statuses = backend.statuses().expect("statuses");
    grid.release(backend).expect("release");
    Outcome { table, counters, statuses, estimates }
}

fn params(seed: u32) -> Params {
    let settings = Settings { seed, max_probes: 16, base_size: 1.0 / 64.0, ..Settings::default() };
    Params::new(&settings).expect("valid settings")
}

/// A frame whose keys, by their number, fill `load` of the table: 1 to 7 deposits a key, and 3000 bright ones in one
/// cell, whose sums carry into their high words.
fn frame(params: &Params, load: f64) -> Vec<VertexRecord> {
    let scene = Scene { extent: 4.0, footprints: &[-8.0, -6.5, -5.0, -3.0] };
    let mut all = vertices(17, 40_000, &scene);
    let wanted = (load * f64::from(CELLS)) as usize;
    let mut keys = BTreeSet::new();
    let last = all.iter().position(|vertex| {
        if vertex.flags & VertexRecord::VALID != 0 {
            keys.extend(key(params, vertex, SALT_DEPOSIT));
        }
        keys.len() == wanted
    });
    all.truncate(last.expect("enough different keys") + 1);
    let mut noise = Noise(23);
    let own = all.len();
    for i in 0..own {
        for _ in 0..noise.word() % 7 {
            let shine = noise.power(-4.0, 4.0);
            let mut again = all[i];
            again.direct = again.direct.map(|v| v * shine);
            all.push(again);
        }
    }
    let bright = VertexRecord { direct: [8000.0, 0.1, 7e-6, 0.0], further: [1e5, 3e-7, 1.0, 0.0], ..all[0] };
    all.extend(std::iter::repeat_n(bright, 3000));
    // Spread equal keys over the frame.
    for i in (1..all.len()).rev() {
        all.swap(i, noise.word() as usize % (i + 1));
    }
    all
}

/// WGSL allows a division 2.5 units in the last place of its result.
const DIVISION_ULPS: u32 = 3;

/// Means are quotients, all else is integers: equal bits, or as far apart as WGSL allows; subnormal results may be 0.
/// Returns the number of words that differ.
fn assert_close(expected: &[EstimateRecord], found: &[EstimateRecord], at: &str) -> usize {
    assert_eq!(expected.len(), found.len(), "{at}");
    let (expected, found) = (bytemuck::cast_slice::<_, f32>(expected), bytemuck::cast_slice::<_, f32>(found));
    let mut different = 0;
    for (i, (e, f)) in expected.iter().zip(found).enumerate() {
        if e.to_bits() != f.to_bits() {
            different += 1;
            let flushed = e.is_subnormal() && *f == 0.0;
            let ulps = e.to_bits().abs_diff(f.to_bits());
            assert!(flushed || ulps <= DIVISION_ULPS, "{at}: word {i}: {e:e}, found {f:e}");
        }
    }
    different
}

fn compare(expected: &Outcome, found: &Outcome, at: &str) {
    let first = expected.table.iter().zip(&found.table).position(|(e, f)| e != f);
    if let Some(word) = first {
        let (cell, word) = (word / 16, word % 16);
        panic!("{at}: cell {cell} word {word}: {:x?}, found {:x?}", cell_of(expected, cell), cell_of(found, cell));
    }
    assert_eq!(expected.table.len(), found.table.len(), "{at}");
    assert_eq!(expected.counters, found.counters, "{at}");
    assert_eq!(expected.statuses, found.statuses, "{at}");
    let different = assert_close(&expected.estimates, &found.estimates, at);
    eprintln!("{at}: equal tables and counters; {different} of {} estimate words differ", found.estimates.len() * 8);
}

fn cell_of(outcome: &Outcome, cell: usize) -> &[u32] {
    &outcome.table[cell * 16..cell * 16 + 16]
}

/// Runs the frames everywhere and compares with the serial launcher, which is returned.
fn everywhere(params: Params, frames: &[&[VertexRecord]], batch: usize, at: &str) -> Outcome {
    let serial = run(&mut CpuBackend::serial(), params, frames, batch);
    for threads in [1, 2, 3] {
        let mut backend = CpuBackend::rayon(threads).expect("threads").with_launch_items(1000);
        let found = run(&mut backend, params, frames, batch);
        compare(&serial, &found, &format!("{at}, rayon with {threads} threads"));
    }
    if let Some(mut backend) = gpu::backend() {
        let found = run(&mut backend, params, frames, batch);
        compare(&serial, &found, &format!("{at}, wgpu"));
    }
    serial
}

fn check_balance(outcome: &Outcome) {
    assert_eq!(outcome.counters.balance(), 0);
    assert!(outcome.estimates.iter().all(|e| e.direct.iter().chain(&e.further).all(|v| v.is_finite())));
    let poisoned = bytemuck::cast_slice::<_, u32>(&outcome.estimates).iter().filter(|&&word| word == POISON).count();
    assert_eq!(poisoned, 0);
}

#[test]
fn a_table_with_room() {
    let params = params(1);
    let frame = frame(&params, 0.3);
    let outcome = everywhere(params, &[&frame], frame.len(), "load 0.3");
    check_balance(&outcome);
    assert!(outcome.counters.non_finite > 0 && outcome.counters.negative > 0 && outcome.counters.clamped > 0);
}

#[test]
fn a_table_that_is_nearly_full() {
    let params = params(2);
    let frame = frame(&params, 0.9);
    let outcome = everywhere(params, &[&frame], frame.len(), "load 0.9");
    check_balance(&outcome);
    assert!(outcome.counters.refusals > 0, "some key should lie beyond 16 probes");
}

#[test]
fn more_keys_than_cells() {
    let params = params(3);
    let frame = frame(&params, 1.2);
    let outcome = everywhere(params, &[&frame], frame.len(), "load 1.2");
    check_balance(&outcome);
    assert!(outcome.statuses.contains(&("hashgrid.claim", Status::TABLE_FULL)));
    let occupied = outcome.table.chunks(16).filter(|cell| cell[1] != u32::MAX).count();
    assert!(occupied as u32 <= CELLS && occupied as u32 > CELLS / 10 * 9, "{occupied} cells");
}

#[test]
fn frames_and_batches_one_after_the_other() {
    let params = params(4);
    let frame = frame(&params, 1.0);
    let (first, second) = frame.split_at(frame.len() / 2);
    let outcome = everywhere(params, &[first, second], 5000, "two frames in batches");
    check_balance(&outcome);
}

/// The law behind all: the order of vertices within a batch plays no part, even when keys are refused.
#[test]
fn the_order_of_vertices_does_not_matter() {
    let params = params(5);
    let mut frame = frame(&params, 1.2);
    let forwards = run(&mut CpuBackend::serial(), params, &[&frame], frame.len());
    frame.reverse();
    let mut backwards = run(&mut CpuBackend::serial(), params, &[&frame], frame.len());
    backwards.estimates.reverse();
    compare(&forwards, &backwards, "backwards");
}
