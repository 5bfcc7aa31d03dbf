//! What the pieces of the grid cost beside the plain one: layouts, points, searches, merging and eviction.
//!
//! One thread, a table of 2¹⁸ cells with 2¹⁷ keys (8 to 28 MiB). Times are CPU time, as in the grid's bench.

mod common;

use std::hint::black_box;
use std::time::Duration;

use common::{cpu_time, vertex};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::counters::Counters;
use hashcache_core::hash::pcg;
use hashcache_core::record::VertexRecord;
use hashgrid::evict::{CountAndAge, evict};
use hashgrid::few::{Levels, Neighbours, estimate_by};
use hashgrid::layout::{Complete, Lasting, Layout, Measured, Minimal, Standard};
use hashgrid::merge::Merge;
use hashgrid::names::{Naming, name_vertices};
use hashgrid::points;
use hashgrid::temporal::{FixedCount, Integrate, MovingAverage, Rule};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{Params, Settings, Table, Word};

const CELLS: usize = 1 << 18;
const KEYS: u32 = 1 << 17;
const OPERATIONS: usize = 1 << 15;

fn params() -> Params {
    Params::new(&Settings { jitter: 0.0, ..Settings::default() }).expect("settings of a bench")
}

fn storage<L: Layout>() -> Vec<Word> {
    (0..CELLS * L::WORDS).map(|_| Word::new(0)).collect()
}

fn fill<L: Layout>(table: &Table<'_, L>, vertices: &[VertexRecord]) {
    table.clear();
    claim_vertices(table, &params(), vertices);
    name_vertices(table, &params(), vertices, Naming::First);
    name_vertices(table, &params(), vertices, Naming::Second);
    deposit_vertices(table, &params(), vertices, &mut Counters::default());
}

fn measure(c: &mut Criterion, group: &str, case: &str, elements: usize, mut work: impl FnMut()) {
    let mut group = c.benchmark_group(format!("hashgrid/{group}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(700));
    group.throughput(Throughput::Elements(elements as u64));
    group.bench_function(BenchmarkId::from_parameter(case), |b| {
        b.iter_custom(|runs| {
            let start = cpu_time(1);
            (0..runs).for_each(|_| work());
            cpu_time(1).saturating_sub(start)
        });
    });
    group.finish();
}

fn chosen() -> Vec<VertexRecord> {
    (0..OPERATIONS as u32).map(|i| vertex(pcg(i) % KEYS)).collect()
}

fn layout<L: Layout>(c: &mut Criterion, name: &str) {
    let (params, words, vertices) = (params(), storage::<L>(), chosen());
    let table = Table::<L>::with_layout(&words, &params).expect("storage of a bench");
    fill(&table, &(0..KEYS).map(vertex).collect::<Vec<_>>());
    let case = format!("{name}, {} bytes", L::BYTES);
    measure(c, "layout_deposit", &case, OPERATIONS, || {
        deposit_vertices(&table, &params, &vertices, &mut Counters::default());
    });
    measure(c, "layout_lookup", &case, OPERATIONS, || {
        let mut sum = 0.0;
        estimate_vertices(&table, &params, &vertices, &mut Counters::default(), |_, estimate| {
            sum += estimate.further.z;
        });
        black_box(sum);
    });
}

fn layouts(c: &mut Criterion) {
    layout::<Minimal>(c, "minimal");
    layout::<Standard>(c, "standard");
    layout::<Measured>(c, "measured");
    layout::<Lasting>(c, "lasting");
    layout::<Complete>(c, "complete");
}

fn searches(c: &mut Criterion) {
    let (params, words, vertices) = (params(), storage::<Standard>(), chosen());
    let table = Table::<Standard>::with_layout(&words, &params).expect("storage of a bench");
    fill(&table, &(0..KEYS).map(vertex).collect::<Vec<_>>());
    let mut counters = Counters::default();
    measure(c, "search", "none", OPERATIONS, || {
        estimate_by(&table, &params, &vertices, &Neighbours { least: 0 }, &mut counters, |_, estimate| {
            black_box(estimate);
        });
    });
    measure(c, "search", "eight neighbours", OPERATIONS, || {
        estimate_by(&table, &params, &vertices, &Neighbours { least: u32::MAX }, &mut counters, |_, estimate| {
            black_box(estimate);
        });
    });
    measure(c, "search", "three levels above", OPERATIONS, || {
        let search = Levels { least: u32::MAX, levels: 4 };
        estimate_by(&table, &params, &vertices, &search, &mut counters, |_, estimate| {
            black_box(estimate);
        });
    });
}

fn implicit_points(c: &mut Criterion) {
    let (params, words, vertices) = (params(), storage::<Minimal>(), chosen());
    let table = Table::<Minimal>::with_layout(&words, &params).expect("storage of a bench");
    table.clear();
    points::claim_vertices(&table, &params, &vertices);
    let few = &vertices[..OPERATIONS / 8];
    measure(c, "points", "chosen", few.len(), || {
        for vertex in few {
            black_box(points::chosen(&params, &vertex.position_footprint));
        }
    });
    measure(c, "points", "deposit", few.len(), || {
        points::deposit_vertices(&table, &params, few, &mut Counters::default());
    });
    measure(c, "points", "interpolation", few.len(), || {
        points::estimate_vertices(&table, &params, few, 1.0, 0, &mut Counters::default(), |_, estimate| {
            black_box(estimate);
        });
    });
}

fn merge<R: Rule>(c: &mut Criterion, name: &str, rule: &R) {
    let (params, words) = (params(), [storage::<Standard>(), storage::<Standard>()]);
    let [lasting, frame] = [0, 1].map(|k| Table::new(&words[k], &params).expect("storage of a bench"));
    lasting.clear();
    fill(&frame, &(0..KEYS).map(vertex).collect::<Vec<_>>());
    let merge = Merge::new(&lasting, &frame).expect("equal sizes");
    measure(c, "merge", name, KEYS as usize, || {
        black_box(merge.all(rule, 1));
    });
}

fn over_time(c: &mut Criterion) {
    merge(c, "integration", &Integrate);
    merge(c, "fixed count", &FixedCount { most: 64 });
    merge(c, "moving average", &MovingAverage::new(0.9).expect("a share"));
    let (params, words) = (params(), storage::<Lasting>());
    let table = Table::<Lasting>::with_layout(&words, &params).expect("storage of a bench");
    let vertices: Vec<_> = (0..KEYS).map(vertex).collect();
    let mut group = c.benchmark_group("hashgrid/evict");
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    group.throughput(Throughput::Elements(u64::from(KEYS / 4)));
    group.bench_function("a quarter of the cells", |b| {
        b.iter_custom(|runs| {
            let mut spent = Duration::ZERO;
            for _ in 0..runs {
                fill(&table, &vertices);
                let start = cpu_time(1);
                black_box(evict(&table, KEYS / 4 * 3, 9, &CountAndAge { half_life: 8 }));
                spent += cpu_time(1).saturating_sub(start);
            }
            spent
        });
    });
    group.finish();
}

criterion_group!(benches, layouts, searches, implicit_points, over_time);
criterion_main!(benches);
