//! The octree's data on every launcher: equal cells, counters and estimates for equal recorded vertices.

use std::sync::Arc;

use backend_api::{Backend, Binding, BufferDesc, Status};
use backend_cpu::CpuBackend;
use hashcache_core::counters::Counters;
use hashcache_core::exact::Quantum;
use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::octree::{
    BuildSettings, ExactCell, Layout, OctreeCache, OctreeParams, OctreeSettings, OctreeStages, OwnedOctree, Serial,
    build,
};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages, EstimateRecord};
use hashcache_core::traits::RadianceCache;
use hashcache_dev_tests::vertices::{Scene, vertices};

/// The walls of the room that [`vertices`] puts its vertices on; those on its spheres have no cell of their own.
fn room() -> Arc<OwnedOctree> {
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -4.0 } else { 4.0 });
    let positions: Vec<[f32; 3]> = (0..8).map(corner).collect();
    let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let indices: Vec<_> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let geometry = Geometry {
        positions: &positions,
        indices: &indices,
        meshes: &[Mesh { first_triangle: 0, triangle_count: 12 }],
        instances: &[Instance::identity(0)],
        ..Geometry::default()
    };
    let settings = BuildSettings { resolution: 128, ..BuildSettings::default() };
    Arc::new(build(&geometry, &settings, &Serial).expect("a room"))
}

/// What a backend makes of a few frames.
#[derive(PartialEq, Debug)]
struct Outcome {
    cells: Vec<u32>,
    counters: Counters,
    statuses: Vec<(&'static str, Status)>,
    estimates: Vec<[u32; 8]>,
}

struct Case {
    octree: Arc<OwnedOctree>,
    params: OctreeParams,
    layout: Layout,
    /// Records of a batch.
    batch: usize,
    /// Frame before which everything is wiped.
    wipe: usize,
}

fn run<B: Backend>(backend: &mut B, case: &Case, frames: &[Vec<VertexRecord>], room_for: u32) -> Outcome {
    let mut stages = OctreeStages::new(Arc::clone(&case.octree), case.params).with_layout(case.layout);
    stages.reserve(backend, room_for).expect("reserve");
    stages.prepare(backend).expect("prepare");
    let mut estimates = Vec::new();
    let create = |backend: &mut B, name, size| backend.create(&BufferDesc { name, size }).expect("create");
    for (f, frame) in frames.iter().enumerate() {
        if f == case.wipe {
            stages.wipe();
        }
        let mut buffers = Vec::new();
        for part in frame.chunks(case.batch) {
            let size = size_of_val(part) as u64;
            let records = create(backend, "records", size);
            backend.write(records, 0, bytemuck::cast_slice(part)).expect("write");
            let binding = Binding { buffer: records, offset: 0, size };
            stages.record(backend, binding, part.len() as u32).expect("record");
            buffers.push((binding, part.len()));
        }
        CacheStages::<B>::update(&mut stages, backend).expect("update");
        for (records, count) in buffers {
            let size = (count * size_of::<EstimateRecord>()) as u64;
            let answers = create(backend, "estimates", size);
            backend.write(answers, 0, &vec![0xa5; size as usize]).expect("write");
            stages.query(backend, records, Binding { buffer: answers, offset: 0, size }, count as u32).expect("query");
            backend.submit().expect("submit");
            let ticket = backend.read(answers, 0, size).expect("read");
            let bytes = backend.redeem(ticket, true).expect("redeem").expect("waited for");
            estimates.extend(bytemuck::pod_collect_to_vec::<u8, [u32; 8]>(&bytes));
            backend.destroy(answers).expect("alive");
            backend.destroy(records.buffer).expect("alive");
        }
    }
    let ticket = backend.read(stages.cell_buffer().expect("prepared"), 0, stages.data_bytes()).expect("read");
    let cells = bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).expect("redeem").expect("waited for"));
    let ticket = stages.read_counters(backend).expect("read");
    let counters = OctreeStages::counters(&backend.redeem(ticket, true).expect("redeem").expect("waited for"));
    let statuses = backend.statuses().expect("statuses");
    stages.release(backend).expect("release");
    Outcome { cells, counters, statuses, estimates }
}

fn frames() -> Vec<Vec<VertexRecord>> {
    let scene = Scene { extent: 4.0, footprints: &[-6.0, -4.0, -2.0] };
    (0..4).map(|f| vertices(40 + f, 6000 + 1000 * f as usize, &scene)).collect()
}

fn compare(expected: &Outcome, found: &Outcome, at: &str) {
    assert!(expected.cells == found.cells, "{at}: cells differ");
    assert_eq!(expected.counters, found.counters, "{at}");
    assert_eq!(expected.statuses, found.statuses, "{at}");
    let first = expected.estimates.iter().zip(&found.estimates).position(|(e, f)| e != f);
    assert!(first.is_none() && expected.estimates.len() == found.estimates.len(), "{at}: estimate {first:?}");
}

fn case(layout: Layout) -> Case {
    let settings = OctreeSettings {
        jitter: 1.0,
        level_jitter: 0.5,
        min_samples: 8,
        max_climb: 5,
        finer: 1,
        seed: 3,
        quantum: Quantum::for_scale(16.0),
        ..OctreeSettings::default()
    };
    Case { octree: room(), params: OctreeParams::new(&settings).expect("valid"), layout, batch: 2500, wipe: 2 }
}

#[test]
fn all_launchers_agree() {
    let frames = frames();
    for layout in [Layout::Exact, Layout::Paper] {
        let case = case(layout);
        let serial = run(&mut CpuBackend::serial(), &case, &frames, 20_000);
        assert_eq!(serial.counters.balance(), 0);
        assert!(serial.counters.hits > 10_000 && serial.counters.coarser > 1000, "{:?}", serial.counters);
        assert!(serial.counters.non_finite > 0 && serial.counters.refusals > 0, "{:?}", serial.counters);
        for threads in [1, 2, 3] {
            for items in [0, 100] {
                let mut backend = CpuBackend::rayon(threads).expect("threads").with_launch_items(items);
                let found = run(&mut backend, &case, &frames, 20_000);
                compare(&serial, &found, &format!("{layout:?}, {threads} threads, launches of {items}"));
            }
        }
    }
}

/// How a frame is cut into batches plays no part, nor does the order of its records.
#[test]
fn batches_and_order_do_not_matter() {
    let mut frames = frames();
    let case = case(Layout::Exact);
    let cut = run(&mut CpuBackend::serial(), &case, &frames, 20_000);
    let whole = run(&mut CpuBackend::serial(), &Case { batch: 20_000, ..case }, &frames, 20_000);
    assert!(cut.cells == whole.cells && cut.estimates == whole.estimates);
    assert_eq!(cut.counters, whole.counters);
    for frame in &mut frames {
        frame.reverse();
    }
    let case = Case { batch: 20_000, ..self::case(Layout::Exact) };
    let backwards = run(&mut CpuBackend::serial(), &case, &frames, 20_000);
    assert!(cut.cells == backwards.cells && cut.counters == backwards.counters);
}

/// Without room for the first frame it is merged in two parts; all light is kept, and later frames are whole.
#[test]
fn a_frame_that_outgrows_its_room_is_merged_in_parts() {
    let frame = &frames()[3];
    let case = Case { batch: 40_000, wipe: usize::MAX, ..case(Layout::Exact) };
    let frames = [frame.repeat(4), frame.repeat(5), frame.repeat(8)];
    let roomy = run(&mut CpuBackend::serial(), &case, &frames, 100_000);
    let tight = run(&mut CpuBackend::serial(), &case, &frames, 0);
    assert_eq!(tight.counters.balance(), 0);
    assert_eq!(tight.counters.energy_stored, roomy.counters.energy_stored);
    let counts = |outcome: &Outcome| outcome.cells.chunks(12).map(|cell| [cell[6], cell[7]]).collect::<Vec<_>>();
    assert!(counts(&tight) == counts(&roomy));
    assert!(tight.statuses.iter().filter(|status| status.0 == "octree.merge").count() > 3 * 10);
}

/// The owned cache, without buffers and launches, holds the same.
#[test]
fn the_owned_cache_is_the_same() {
    let frames = frames();
    let case = Case { wipe: usize::MAX, ..case(Layout::Exact) };
    let stages = run(&mut CpuBackend::serial(), &case, &frames, 20_000);
    let mut cache = OctreeCache::<ExactCell>::new(Arc::clone(&case.octree), case.params);
    let mut estimates = Vec::new();
    for frame in &frames {
        for vertex in frame {
            cache.record(vertex);
        }
        cache.end_frame();
        for vertex in frame {
            let estimate = cache.estimate(vertex);
            let [x, y, z] = estimate.further.to_array();
            estimates.push([0.0, 0.0, 0.0, estimate.samples as f32, x, y, z, estimate.variance].map(f32::to_bits));
        }
    }
    let counters = cache.counters();
    assert_eq!(counters, stages.counters);
    assert!(estimates == stages.estimates);
    let cells: Vec<u32> =
        (0..stages.cells.len() as u32 / 12).flat_map(|i| bytemuck::cast::<_, [u32; 12]>(cache.cell(i))).collect();
    assert!(cells == stages.cells);
}

/// Buffers that do not fit are refused before anything is made.
#[test]
fn sizes_are_checked() {
    let case = case(Layout::Exact);
    let mut backend = CpuBackend::serial();
    let mut stages = OctreeStages::new(case.octree, case.params);
    assert!(stages.reserve(&mut backend, u32::MAX).is_err());
    assert!(CacheStages::<CpuBackend>::update(&mut stages, &mut backend).is_ok());
    assert!(stages.read_counters(&mut backend).is_err());
    assert_eq!(stages.data_bytes(), 48 * u64::from(stages.cells()));
    assert!(stages.table_bytes() * 10 < stages.data_bytes() * 11 && stages.frame_bytes() > 0);
}
