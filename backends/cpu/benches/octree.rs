//! An octree's data on a room of 2048 cells along its side: recording, updating and asking, by frames of 150 thousand
//! and 1.2 million records (three vertices a path), beside the alternatives and what memory can do.
//!
//! Times are CPU time of all threads together. `HASHCACHE_BENCH_RESOLUTION` is another resolution than 2048 (which
//! needs 2 GiB).

#[path = "octree/atomic.rs"]
mod atomic;
#[path = "octree/scene.rs"]
mod scene;

use std::env;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use atomic::Atomic;
use backend_api::{Backend, Binding, BufferDesc};
use backend_cpu::CpuBackend;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::hash::pcg;
use hashcache_core::octree::{Layout, OctreeParams, OctreeSettings, OctreeStages, OwnedOctree, PaperCell};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages, EstimateRecord};

/// CPU time that the process has used.
#[cfg(target_os = "linux")]
fn cpu_time(_threads: usize) -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Elapsed time, as if all threads had worked throughout.
#[cfg(not(target_os = "linux"))]
fn cpu_time(threads: usize) -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed() * threads as u32
}

fn bind<B: Backend>(backend: &mut B, name: &'static str, size: u64) -> Binding {
    let buffer = backend.create(&BufferDesc { name, size }).expect("create");
    Binding { buffer, offset: 0, size }
}

/// Measures `work`; `prepare` runs before each time, unmeasured.
fn measure<T>(
    c: &mut Criterion,
    [operation, case]: [&str; 2],
    [elements, threads]: [usize; 2],
    state: &mut T,
    prepare: impl Fn(&mut T),
    work: impl Fn(&mut T),
) {
    let mut group = c.benchmark_group(format!("octree/{operation}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Elements(elements as u64));
    group.bench_function(BenchmarkId::new(case, format!("{}k/{threads}t", elements / 1000)), |b| {
        b.iter_custom(|runs| {
            let mut total = Duration::ZERO;
            for _ in 0..runs {
                prepare(state);
                let start = cpu_time(threads);
                work(state);
                total += cpu_time(threads).saturating_sub(start);
            }
            total
        });
    });
    group.finish();
}

struct Octrees {
    backend: CpuBackend,
    stages: OctreeStages,
    records: Binding,
    seen: Binding,
    estimates: Binding,
    counts: [u32; 2],
}

impl Octrees {
    fn record(&mut self) {
        self.stages.record(&mut self.backend, self.records, self.counts[0]).expect("record");
        self.run();
    }

    fn update(&mut self) {
        CacheStages::<CpuBackend>::update(&mut self.stages, &mut self.backend).expect("update");
        self.run();
    }

    fn query(&mut self) {
        self.stages.query(&mut self.backend, self.seen, self.estimates, self.counts[1]).expect("query");
        self.run();
    }

    fn run(&mut self) {
        self.backend.submit().expect("submit");
        self.backend.statuses().expect("statuses");
    }
}

fn octree_stages(c: &mut Criterion, octree: &Arc<OwnedOctree>, frame: &[VertexRecord], layout: Layout, threads: usize) {
    let seen: Vec<VertexRecord> = frame.iter().copied().step_by(3).collect();
    let settings = OctreeSettings { jitter: 0.5, ..OctreeSettings::default() };
    let params = OctreeParams::new(&settings).expect("settings of a bench");
    let mut backend = CpuBackend::rayon(threads).expect("threads");
    let mut stages = OctreeStages::new(Arc::clone(octree), params).with_layout(layout);
    stages.reserve(&mut backend, frame.len() as u32).expect("reserve");
    stages.prepare(&mut backend).expect("prepare");
    let records = bind(&mut backend, "records", size_of_val(frame) as u64);
    backend.write(records.buffer, 0, bytemuck::cast_slice(frame)).expect("write");
    let seen_binding = bind(&mut backend, "seen", size_of_val(seen.as_slice()) as u64);
    backend.write(seen_binding.buffer, 0, bytemuck::cast_slice(&seen)).expect("write");
    let estimates = bind(&mut backend, "estimates", (seen.len() * size_of::<EstimateRecord>()) as u64);
    let counts = [frame.len() as u32, seen.len() as u32];
    let mut all = Octrees { backend, stages, records, seen: seen_binding, estimates, counts };
    let name = if layout == Layout::Exact { "exact" } else { "paper" };
    measure(c, ["record", name], [frame.len(), threads], &mut all, Octrees::update, Octrees::record);
    measure(c, ["update", name], [frame.len(), threads], &mut all, Octrees::record, Octrees::update);
    measure(c, ["query", name], [seen.len(), threads], &mut all, |_| {}, Octrees::query);
}

fn atomics(c: &mut Criterion, octree: &OwnedOctree, frame: &[VertexRecord], threads: usize) {
    let mut backend = CpuBackend::rayon(threads).expect("threads");
    let atomic = Atomic::new(&mut backend, octree, frame.len() as u32);
    let records = bind(&mut backend, "records", size_of_val(frame) as u64);
    backend.write(records.buffer, 0, bytemuck::cast_slice(frame)).expect("write");
    let mut state = (atomic, backend);
    let count = frame.len();
    let record = |(atomic, backend): &mut (Atomic, CpuBackend)| atomic.record(backend, records, count as u32);
    let update = |(atomic, backend): &mut (Atomic, CpuBackend)| atomic.update(backend);
    measure(c, ["record", "atomic"], [count, threads], &mut state, update, record);
    measure(c, ["update", "atomic"], [count, threads], &mut state, record, update);
}

/// As many cells as a query reads, at random.
fn raw_reads(c: &mut Criterion, cells: usize, lookups: usize) {
    let data: Vec<PaperCell> = bytemuck::zeroed_vec(cells);
    let places: Vec<u32> = (0..lookups as u32).map(|i| ((u64::from(pcg(i)) * cells as u64) >> 32) as u32).collect();
    measure(
        c,
        ["query", "raw_24_bytes"],
        [lookups, 1],
        &mut (),
        |()| {},
        |()| {
            let sum = places.iter().fold(0_u32, |sum, place| {
                let cell = &data[*place as usize];
                sum.wrapping_add(cell.halves[0] ^ cell.counts ^ cell.wiped)
            });
            black_box(sum);
        },
    );
}

fn octree(c: &mut Criterion) {
    let resolution = env::var("HASHCACHE_BENCH_RESOLUTION").map_or(2048, |r| r.parse().expect("a number"));
    let quads = scene::room();
    let octree = Arc::new(scene::octree(&quads, resolution));
    eprintln!("{} cells on {} levels", octree.normals.len(), octree.view().grid().levels);
    for [width, height] in [[256, 192], [720, 540]] {
        let frame = scene::vertices(&quads, width, height, 3, 7);
        for threads in [1, 2] {
            octree_stages(c, &octree, &frame, Layout::Exact, threads);
            atomics(c, &octree, &frame, threads);
        }
        octree_stages(c, &octree, &frame, Layout::Paper, 1);
        raw_reads(c, octree.normals.len(), frame.len() / 3);
    }
}

criterion_group!(benches, octree);
criterion_main!(benches);
