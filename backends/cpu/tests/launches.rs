//! How a dispatch is cut makes no difference, and what only the CPU can be asked.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use backend_api::{
    Access, Backend, Binding, BindingDecl, BufferDesc, BufferId, Error, HitRecord, Items, Kernel, Launch, RayRecord,
    Status,
};
use backend_cpu::CpuBackend;
use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::stages::CastsRays;
use proptest::prelude::*;

const fn decl(name: &'static str, access: Access, stride: u32) -> BindingDecl {
    BindingDecl { name, access, stride }
}

const fn kernel(name: &'static str, bindings: &'static [BindingDecl], body: fn(&mut Launch<'_>)) -> Kernel {
    Kernel { name, bindings, params_size: 0, body, wgsl: None, casts_rays: false }
}

/// Touches a buffer in every way.
static MIXED: Kernel = Kernel {
    params_size: 16,
    ..kernel(
        "toy.mixed",
        &[
            decl("input", Access::In, 4),
            decl("triples", Access::OutPerItem, 12),
            decl("counts", Access::AtomicU32, 4),
            decl("sums", Access::AtomicU64, 8),
            decl("steps", Access::OutPerItem, 4),
        ],
        mixed,
    )
};

fn mixed(launch: &mut Launch<'_>) {
    let &[salt, ..] = launch.params::<[u32; 4]>();
    let (input, counts, sums): (_, &[AtomicU32], &[AtomicU64]) =
        (launch.input::<u32>(0), launch.atomic_u32(2), launch.atomic_u64(3));
    let (triples, steps) = (launch.output::<[u32; 3]>(1), launch.output::<u32>(4));
    for (i, (triple, step)) in launch.items().zip(triples.iter_mut().zip(steps)) {
        let value = input[i as usize * 31 % input.len()];
        *triple = [i, value ^ salt, triple[2].wrapping_add(1)];
        *step = step.wrapping_mul(5).wrapping_add(i);
        counts[value as usize % counts.len()].fetch_add(i, Ordering::Relaxed);
        sums[i as usize % sums.len()].fetch_add(u64::from(value) << 20, Ordering::Relaxed);
    }
}

/// Tells each item which launch ran it.
static WHO: Kernel = kernel("toy.who", &[decl("launches", Access::OutPerItem, 8)], |launch| {
    let own = [launch.first, launch.count];
    launch.output::<[u32; 2]>(0).fill(own);
});

/// Raises a flag when a binding does not start on a cache line.
static ALIGNED: Kernel = kernel(
    "toy.aligned",
    &[decl("input", Access::In, 4), decl("output", Access::OutPerItem, 64), decl("cells", Access::AtomicU64, 64)],
    |launch| {
        let starts = [
            launch.input::<u32>(0).as_ptr().addr(),
            launch.output::<[u32; 16]>(1).as_ptr().addr(),
            launch.atomic_u64(2).as_ptr().addr(),
        ];
        if launch.rays.is_some() || starts.iter().any(|start| !start.is_multiple_of(64)) {
            launch.raise(Status::OVERFLOW);
        }
    },
);

/// Waits until as many launches run as the first word says.
static MEET: Kernel =
    kernel("toy.meet", &[decl("wanted", Access::In, 4), decl("here", Access::AtomicU32, 4)], |launch| {
        let (wanted, here) = (launch.input::<u32>(0)[0], &launch.atomic_u32(1)[0]);
        here.fetch_add(1, Ordering::Relaxed);
        let patience = Instant::now() + Duration::from_secs(60);
        while here.load(Ordering::Relaxed) < wanted {
            if Instant::now() > patience {
                launch.raise(Status::OVERFLOW);
                return;
            }
            std::thread::yield_now();
        }
    });

static PANICS: Kernel = kernel("toy.panics", &[], |_| panic!("a body that panics, as the test wants"));

static CASTS: Kernel = Kernel {
    casts_rays: true,
    ..kernel("toy.casts", &[decl("rays", Access::In, 32), decl("hits", Access::OutPerItem, 20)], |launch| {
        let (rays, hits, scene) = (launch.input::<RayRecord>(0), launch.output::<HitRecord>(1), launch.rays());
        for (i, hit) in launch.items().zip(hits) {
            *hit = scene.trace_closest(&rays[i as usize]);
        }
    })
};

fn buffer(backend: &mut CpuBackend, words: &[u32]) -> BufferId {
    let id = backend.create(&BufferDesc { name: "test", size: 4 * words.len() as u64 }).expect("create");
    backend.write(id, 0, bytemuck::cast_slice(words)).expect("write");
    id
}

fn words(backend: &mut CpuBackend, buffer: BufferId, count: usize) -> Vec<u32> {
    let ticket = backend.read(buffer, 0, 4 * count as u64).expect("read");
    bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).expect("redeem").expect("ready"))
}

fn bind(buffer: BufferId, words: usize) -> Binding {
    Binding { buffer, offset: 0, size: 4 * words as u64 }
}

/// What [`MIXED`] leaves in its buffers.
fn run_mixed(mut backend: CpuBackend, input: &[u32], items: u32, salt: u32) -> [Vec<u32>; 4] {
    let n = items.max(1) as usize;
    let lengths = [input.len(), 3 * n, 3, 4, n];
    let buffers = lengths.map(|length| buffer(&mut backend, &vec![7; length]));
    backend.write(buffers[0], 0, bytemuck::cast_slice(input)).expect("write");
    let bindings: Vec<_> = buffers.into_iter().zip(lengths).map(|(buffer, length)| bind(buffer, length)).collect();
    let params = [salt, 0, 0, 0];
    backend.dispatch(&MIXED, bytemuck::cast_slice(&params), &bindings, Items::Count(items)).expect("dispatch");
    backend.submit().expect("submit");
    assert_eq!(backend.statuses(), Ok(vec![("toy.mixed", Status::OK)]));
    [1, 2, 3, 4].map(|k| words(&mut backend, buffers[k], lengths[k]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_cut_gives_the_same_bits(
        input in prop::collection::vec(any::<u32>(), 1..100),
        items in prop_oneof![0..5_u32, 0..3000_u32],
        step in prop_oneof![Just(0_u32), 1..10_u32, 1..4000_u32, Just(u32::MAX)],
        threads in 1..5_usize,
        salt in any::<u32>(),
    ) {
        let whole = run_mixed(CpuBackend::serial().with_launch_items(u32::MAX), &input, items, salt);
        let cut = run_mixed(CpuBackend::serial().with_launch_items(step), &input, items, salt);
        prop_assert_eq!(&cut, &whole);
        let pool = CpuBackend::rayon(threads).expect("threads").with_launch_items(step);
        prop_assert_eq!(&run_mixed(pool, &input, items, salt), &whole);
    }
}

/// The launches that ran `items`, in order.
fn launches(mut backend: CpuBackend, items: u32) -> Vec<[u32; 2]> {
    let target = buffer(&mut backend, &vec![0; 2 * items as usize]);
    backend.dispatch(&WHO, &[], &[bind(target, 2 * items as usize)], Items::Count(items)).expect("dispatch");
    backend.submit().expect("submit");
    let told = words(&mut backend, target, 2 * items as usize);
    let distinct: BTreeSet<[u32; 2]> = told.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    distinct.into_iter().collect()
}

#[test]
fn launches_cover_all_items_once_in_bounded_pieces() {
    for items in [1, 255, 257, 5000, 300_000] {
        for backend in
            [CpuBackend::serial(), CpuBackend::rayon(2).expect("threads"), CpuBackend::rayon(7).expect("threads")]
        {
            let threads = backend.threads();
            let mut next = 0;
            let ran = launches(backend, items);
            for (k, &[first, count]) in ran.iter().enumerate() {
                assert_eq!(first, next);
                assert!(count <= 16_384 && (count >= 256 || k + 1 == ran.len()), "{count} of {items} items");
                next += count;
            }
            assert_eq!(next, items);
            assert!(items < 100_000 || ran.len() >= 8 * threads, "{} launches for {threads} threads", ran.len());
        }
    }
    assert_eq!(launches(CpuBackend::serial().with_launch_items(4), 10), [[0, 4], [4, 4], [8, 2]]);
}

#[test]
fn launches_of_a_pool_run_at_the_same_time() {
    let mut backend = CpuBackend::rayon(3).expect("threads").with_launch_items(1);
    let (wanted, here) = (buffer(&mut backend, &[3]), buffer(&mut backend, &[0]));
    backend.dispatch(&MEET, &[], &[bind(wanted, 1), bind(here, 1)], Items::Count(3)).expect("dispatch");
    backend.submit().expect("submit");
    assert_eq!(backend.statuses(), Ok(vec![("toy.meet", Status::OK)]));
}

#[test]
fn bindings_start_on_cache_lines_and_rays_are_for_those_who_ask() {
    let mut backend = CpuBackend::rayon(2).expect("threads").with_launch_items(3);
    backend.set_geometry(&square().geometry()).expect("geometry");
    let buffers = [64, 16 * 100, 64 * 3].map(|length| (buffer(&mut backend, &vec![0; length]), length));
    let bindings = buffers.map(|(buffer, length)| bind(buffer, length));
    backend.dispatch(&ALIGNED, &[], &bindings, Items::Count(100)).expect("dispatch");
    backend.submit().expect("submit");
    assert_eq!(backend.statuses(), Ok(vec![("toy.aligned", Status::OK)]));
}

struct Square {
    positions: [[f32; 3]; 4],
    indices: [[u32; 3]; 2],
    meshes: [Mesh; 1],
    instances: [Instance; 1],
}

impl Square {
    fn geometry(&self) -> Geometry<'_> {
        Geometry {
            positions: &self.positions,
            indices: &self.indices,
            meshes: &self.meshes,
            instances: &self.instances,
            ..Geometry::default()
        }
    }
}

/// The square (0, 0)..(1, 1) at z = 0, in two triangles parted by the diagonal x = y.
fn square() -> Square {
    Square {
        positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        indices: [[0, 1, 2], [0, 2, 3]],
        meshes: [Mesh { first_triangle: 0, triangle_count: 2 }],
        instances: [Instance::identity(0)],
    }
}

#[test]
fn kernels_cast_rays_once_there_is_geometry() {
    for mut backend in [CpuBackend::serial(), CpuBackend::rayon(2).expect("threads").with_launch_items(1)] {
        let ray = |x, y| RayRecord { origin: [x, y, 3.0], t_min: 0.0, direction: [0.0, 0.0, -2.0], t_max: 9.0 };
        let rays = [ray(0.75, 0.25), ray(2.0, 0.5), ray(0.25, 0.75)];
        let source = buffer(&mut backend, bytemuck::cast_slice(&rays));
        let target = buffer(&mut backend, &[0; 15]);
        let bindings = [bind(source, 24), bind(target, 15)];
        let refused = backend.dispatch(&CASTS, &[], &bindings, Items::Count(3));
        assert_eq!(refused, Err(Error::NoGeometry { kernel: "toy.casts" }));
        backend.set_geometry(&square().geometry()).expect("geometry");
        backend.dispatch(&CASTS, &[], &bindings, Items::Count(3)).expect("dispatch");
        backend.submit().expect("submit");
        let hits: Vec<HitRecord> = bytemuck::pod_collect_to_vec(&words(&mut backend, target, 15));
        assert_eq!([hits[0].triangle, hits[1].triangle, hits[2].triangle], [0, HitRecord::MISS, 1]);
        assert!((hits[0].t - 1.5).abs() < 1e-6 && (hits[2].t - 1.5).abs() < 1e-6, "{hits:?}");
    }
}

#[test]
fn a_panic_is_told_and_survived() {
    for mut backend in [CpuBackend::serial(), CpuBackend::rayon(2).expect("threads")] {
        let target = buffer(&mut backend, &[0; 2]);
        let spare = buffer(&mut backend, &[0; 2]);
        let who = |backend: &mut CpuBackend| {
            backend.dispatch(&WHO, &[], &[bind(target, 2)], Items::Count(1)).expect("dispatch");
        };
        backend.dispatch(&PANICS, &[], &[], Items::Count(1)).expect("dispatch");
        who(&mut backend);
        backend.destroy(spare).expect("destroy");
        assert!(catch_unwind(AssertUnwindSafe(|| backend.submit())).is_err());
        assert_eq!(words(&mut backend, target, 2), [0, 0]);
        assert_eq!(backend.statuses(), Err(Error::NotRun { kernel: "toy.panics" }));
        assert_eq!(backend.statuses(), Ok(vec![]));
        who(&mut backend);
        backend.submit().expect("submit");
        assert_eq!(words(&mut backend, target, 2), [0, 1]);
        assert_eq!(backend.statuses(), Ok(vec![("toy.who", Status::OK)]));
        assert_eq!(backend.read(spare, 0, 4), Err(Error::UnknownBuffer { at: "read" }));
    }
}

#[test]
fn no_memory_is_an_error() {
    let mut backend = CpuBackend::serial();
    for size in [1 << 48, backend.max_binding_size()] {
        assert_eq!(backend.create(&BufferDesc { name: "huge", size }), Err(Error::OutOfMemory { size }));
    }
    let (size, limit) = (backend.max_binding_size() + 64, backend.max_binding_size());
    let refused = backend.create(&BufferDesc { name: "huge", size });
    assert_eq!(refused, Err(Error::BadSize { at: "huge", size, limit }));
}

#[test]
fn pools_have_the_threads_asked_for() {
    assert_eq!(CpuBackend::serial().threads(), 1);
    assert_eq!(CpuBackend::rayon(3).expect("threads").threads(), 3);
    assert!(CpuBackend::rayon(0).expect("threads").threads() >= 1);
    let wanted = CpuBackend::MAX_THREADS + 1;
    assert_eq!(CpuBackend::rayon(wanted).err(), Some(Error::Threads { wanted: wanted as u32 }));
    assert_eq!(CpuBackend::rayon(usize::MAX).err(), Some(Error::Threads { wanted: u32::MAX }));
}

#[test]
fn backends_move_between_threads() {
    fn is_send<T: Send>(_: &T) {}
    let backend = CpuBackend::serial();
    is_send(&backend);
    assert_eq!(backend.name(), "serial");
    assert_eq!(CpuBackend::rayon(1).expect("threads").name(), "rayon");
}
