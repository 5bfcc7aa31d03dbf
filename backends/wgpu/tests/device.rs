//! What is particular to a GPU: refused shaders, lost devices, shared devices, sizes beyond one row of workgroups.

use std::sync::{Mutex, MutexGuard, PoisonError};

use backend_api::primitive::model;
use backend_api::{
    Access, Backend, Binding, BindingDecl, BufferDesc, BufferId, Error, Items, Kernel, Launch, Primitive, Status, Wgsl,
};
use backend_wgpu::{AdapterChoice, WgpuBackend};

/// Software renderers use all cores for one device; several at once only slow each other down.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn open() -> Option<(WgpuBackend, MutexGuard<'static, ()>)> {
    let wanted = std::env::var("HASHCACHE_GPU").unwrap_or_default();
    if wanted == "off" {
        eprintln!("skipped: HASHCACHE_GPU=off");
        return None;
    }
    let guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    match WgpuBackend::open(AdapterChoice::Fastest) {
        Ok(backend) => Some((backend, guard)),
        Err(error) => {
            assert!(wanted != "require", "HASHCACHE_GPU=require: {error}");
            eprintln!("skipped: {error}; on Debian: apt-get install mesa-vulkan-drivers");
            None
        }
    }
}

fn no_host_body(_: &mut Launch<'_>) {
    unreachable!("these kernels run on a GPU only");
}

const fn kernel(name: &'static str, source: &'static [&'static str]) -> Kernel {
    Kernel {
        name,
        bindings: &[BindingDecl { name: "t_words", access: Access::AtomicU32, stride: 4 }],
        params_size: 0,
        body: no_host_body,
        wgsl: Some(Wgsl { modules: source, entry: "t_main", workgroup_size: 64 }),
        casts_rays: false,
    }
}

const DECLARED: &str = "@group(0) @binding(0) var<storage, read_write> t_words: array<atomic<u32>>;";

static COUNT: Kernel = kernel(
    "test.count",
    &[
        DECLARED,
        "@compute @workgroup_size(64)
         fn t_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
             let item = hc_item(gid, groups);
             if (item >= hc_launch.count) { return; }
             atomicAdd(&t_words[0], 1u);
             atomicMax(&t_words[1], item);
         }",
    ],
);
static BROKEN: Kernel =
    kernel("test.broken", &[DECLARED, "@compute @workgroup_size(64) fn t_main() { let x = nowhere; }"]);
static NO_ENTRY: Kernel = kernel("test.no_entry", &[DECLARED]);
static WRONG_BINDING: Kernel = kernel(
    "test.wrong_binding",
    &["@group(0) @binding(3) var<storage, read_write> t_words: array<u32>;
         @compute @workgroup_size(64) fn t_main() { t_words[0] = 1u; }"],
);
static SILENT: Kernel =
    kernel("test.silent", &[DECLARED, "@compute @workgroup_size(64) fn t_main() { atomicAdd(&t_words[0], 1u); }"]);
static CASTS: Kernel = Kernel { casts_rays: true, ..kernel("test.casts", &[DECLARED]) };
static HOST_ONLY: Kernel = Kernel { wgsl: None, ..kernel("test.host_only", &[]) };

fn buffer(backend: &mut WgpuBackend, words: &[u32]) -> BufferId {
    let buffer = backend.create(&BufferDesc { name: "test", size: 4 * words.len() as u64 }).expect("create");
    backend.write(buffer, 0, bytemuck::cast_slice(words)).expect("write");
    buffer
}

fn words(backend: &mut WgpuBackend, buffer: BufferId, count: usize) -> Vec<u32> {
    let ticket = backend.read(buffer, 0, 4 * count as u64).expect("read");
    bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).expect("redeem").expect("waited for"))
}

fn all(buffer: BufferId, words: u64) -> [Binding; 1] {
    [Binding { buffer, offset: 0, size: 4 * words }]
}

#[test]
fn refused_shaders_are_errors_with_the_compilers_words() {
    let Some((mut backend, _guard)) = open() else { return };
    let target = buffer(&mut backend, &[0; 2]);
    for kernel in [&BROKEN, &NO_ENTRY, &WRONG_BINDING] {
        for _ in 0..2 {
            let refused = backend.dispatch(kernel, &[], &all(target, 2), Items::Count(1));
            assert_eq!(refused, Err(Error::Shader { kernel: kernel.name }));
        }
        assert!(!backend.message().is_empty());
    }
    backend.dispatch(&BROKEN, &[], &all(target, 2), Items::Count(1)).expect_err("still broken");
    // The backend goes on.
    backend.dispatch(&COUNT, &[], &all(target, 2), Items::Count(5)).expect("dispatch");
    backend.submit().expect("submit");
    assert_eq!(words(&mut backend, target, 2), [5, 4]);
    assert_eq!(backend.statuses(), Ok(vec![("test.count", Status::OK)]));
}

#[test]
fn rays_and_host_kernels_are_refused() {
    let Some((mut backend, _guard)) = open() else { return };
    let target = buffer(&mut backend, &[0; 2]);
    let refused = backend.dispatch(&HOST_ONLY, &[], &all(target, 2), Items::Count(1));
    assert_eq!(refused, Err(Error::Unsupported { what: "test.host_only" }));
    let refused = backend.dispatch(&CASTS, &[], &all(target, 2), Items::Count(1));
    assert_eq!(refused, Err(Error::NoGeometry { kernel: "test.casts" }));
}

#[test]
fn a_kernel_that_asks_for_no_item_counts_as_not_run() {
    let Some((mut backend, _guard)) = open() else { return };
    let target = buffer(&mut backend, &[0; 2]);
    backend.dispatch(&SILENT, &[], &all(target, 2), Items::Count(1)).expect("dispatch");
    backend.submit().expect("submit");
    assert_eq!(backend.statuses(), Err(Error::NotRun { kernel: "test.silent" }));
    assert_eq!(backend.statuses(), Ok(vec![]));
}

#[test]
fn items_fold_into_rows_with_known_and_with_counted_items() {
    let Some((mut backend, _guard)) = open() else { return };
    let per_row = 65_535 * 64;
    let counts = buffer(&mut backend, &[0, per_row, 2 * per_row + 65, u32::MAX]);
    for (index, count) in [(0, 0), (1, per_row), (2, 2 * per_row + 65), (3, 3 * per_row)] {
        for items in [Items::Count(count), Items::FromBuffer { buffer: counts, index, max: 3 * per_row }] {
            let target = buffer(&mut backend, &[0; 2]);
            backend.dispatch(&COUNT, &[], &all(target, 2), items).expect("dispatch");
            backend.submit().expect("submit");
            assert_eq!(words(&mut backend, target, 2), [count, count.saturating_sub(1)], "{items:?}");
        }
    }
    assert_eq!(backend.statuses().expect("statuses").len(), 8);
}

#[test]
fn a_lost_device_is_an_error_everywhere() {
    let Some((mut backend, _guard)) = open() else { return };
    let target = buffer(&mut backend, &[7; 2]);
    backend.dispatch(&COUNT, &[], &all(target, 2), Items::Count(1)).expect("dispatch");
    backend.submit().expect("submit");
    let early = backend.read(target, 0, 8).expect("read");
    backend.dispatch(&COUNT, &[], &all(target, 2), Items::Count(1)).expect("dispatch");
    backend.device().destroy();
    // While earlier work is under way the loss may not have shown yet; the statuses below tell.
    assert!(matches!(backend.submit(), Ok(()) | Err(Error::DeviceLost)));
    // The early ticket may have been served in time, but never with other bytes.
    if let Ok(bytes) = backend.redeem(early, true) {
        assert_eq!(bytes, Some(bytemuck::cast_slice(&[8_u32, 7]).to_vec()));
    }
    assert_eq!(backend.submit(), Err(Error::DeviceLost));
    assert_eq!(backend.read(target, 0, 8), Err(Error::DeviceLost));
    assert_eq!(backend.create(&BufferDesc { name: "late", size: 4 }), Err(Error::DeviceLost));
    assert_eq!(backend.write(target, 0, &[0; 4]), Err(Error::DeviceLost));
    assert_eq!(backend.statuses(), Err(Error::DeviceLost));
}

#[test]
fn a_callers_lost_device_shows_at_the_latest_when_read() {
    let Some((owner, _guard)) = open() else { return };
    let mut backend = WgpuBackend::new(owner.device().clone(), owner.queue().clone());
    let target = buffer(&mut backend, &[7; 2]);
    owner.device().destroy();
    let read = backend.read(target, 0, 8).and_then(|ticket| backend.redeem(ticket, true));
    assert_eq!(read, Err(Error::DeviceLost));
    let dispatched = backend.dispatch(&COUNT, &[], &all(target, 2), Items::Count(1)).and_then(|()| backend.submit());
    let told = dispatched.and_then(|()| backend.statuses());
    assert!(told.is_err(), "{told:?}");
}

#[test]
fn backends_share_a_device_and_give_out_its_buffers() {
    let Some((owner, _guard)) = open() else { return };
    let mut first = WgpuBackend::new(owner.device().clone(), owner.queue().clone());
    let mut second = WgpuBackend::new(owner.device().clone(), owner.queue().clone());
    let (a, b) = (buffer(&mut first, &[1, 2]), buffer(&mut second, &[3, 4]));
    let from = first.buffer(a).expect("alive").clone();
    let to = second.buffer(b).expect("alive").clone();
    let mut encoder = owner.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&from, 0, &to, 4, 4);
    owner.queue().submit([encoder.finish()]);
    assert_eq!(words(&mut second, b, 2), [3, 1]);
    first.destroy(a).expect("alive");
    assert!(first.buffer(a).is_none());
    assert!(!owner.adapter_name().is_empty());
}

/// Each thread waits for its own work, whichever thread's polling sees it done.
#[test]
fn backends_on_several_threads_share_a_device() {
    let Some((owner, _guard)) = open() else { return };
    let many = 1 << 18;
    std::thread::scope(|scope| {
        for thread in 1..7 {
            let mut backend = WgpuBackend::new(owner.device().clone(), owner.queue().clone());
            scope.spawn(move || {
                let target = buffer(&mut backend, &vec![0; many]);
                for round in 0..20 {
                    let word = thread * 1000 + round;
                    backend.primitive(Primitive::Fill { buffer: target, word }).expect("fill");
                    backend.submit().expect("submit");
                    assert!(words(&mut backend, target, many).iter().all(|&found| found == word));
                }
            });
        }
    });
}

#[test]
fn buffers_beyond_the_limit_are_refused() {
    let Some((mut backend, _guard)) = open() else { return };
    let limit = backend.max_binding_size();
    assert_eq!(limit, 128 << 20);
    let size = limit + 4;
    assert_eq!(backend.create(&BufferDesc { name: "big", size }), Err(Error::BadSize { at: "big", size, limit }));
    let most = backend.create(&BufferDesc { name: "most", size: limit }).expect("create");
    assert_eq!(words(&mut backend, most, 1), [0]);
}

fn noise(count: u32) -> Vec<u32> {
    (0..count)
        .map(|i| (i ^ 0x5bd1_e995).wrapping_mul(0x9e37_79b9).rotate_left(i % 31).wrapping_mul(0x85eb_ca6b))
        .collect()
}

/// Three levels of sums, and more workgroups than one row holds.
#[test]
fn primitives_agree_with_their_models_at_size() {
    let Some((mut backend, _guard)) = open() else { return };
    let many = 65_536 * 256 + 3_u32;
    let big = backend.create(&BufferDesc { name: "big", size: 4 * u64::from(many) }).expect("create");
    backend.primitive(Primitive::Fill { buffer: big, word: 0xdead_beef }).expect("fill");
    backend.submit().expect("submit");
    assert!(words(&mut backend, big, many as usize).iter().all(|&word| word == 0xdead_beef));

    for count in [0, 1, 255, 257, 1024, 1025, 70_000, 1024 * 1024 + 5] {
        let input = noise(count.max(1));
        let n = count as usize;
        let source = buffer(&mut backend, &input);
        let output = buffer(&mut backend, &vec![7; n + 3]);
        backend.primitive(Primitive::Scan { input: source, output, count }).expect("scan");
        let few: Vec<u32> = input.iter().map(|word| word % 5).collect();
        let keys = buffer(&mut backend, &few);
        let values = buffer(&mut backend, &input);
        let [unique, sums, indices] = [(); 3].map(|()| buffer(&mut backend, &vec![9; n + 1]));
        let [runs, kept] = [(); 2].map(|()| buffer(&mut backend, &[9]));
        backend.primitive(Primitive::ReduceByKey { keys, values, unique, sums, runs, count }).expect("reduce");
        backend.primitive(Primitive::Compact { flags: keys, indices, kept, count }).expect("compact");
        let (sorted, along) = (buffer(&mut backend, &input), buffer(&mut backend, &noise(count.max(1))));
        backend.primitive(Primitive::SortPairs { keys: sorted, values: along, count }).expect("sort");
        backend.submit().expect("submit");

        let mut expected = vec![7; n + 3];
        model::scan(&input[..n], &mut expected);
        assert_eq!(words(&mut backend, output, n + 3), expected, "scan {count}");
        let (mut expected_unique, mut expected_sums) = (vec![9; n + 1], vec![9; n + 1]);
        let expected_runs = model::reduce_by_key(&few[..n], &input[..n], &mut expected_unique, &mut expected_sums);
        assert_eq!(words(&mut backend, runs, 1), [expected_runs], "runs {count}");
        assert_eq!(words(&mut backend, unique, n + 1), expected_unique, "unique {count}");
        assert_eq!(words(&mut backend, sums, n + 1), expected_sums, "sums {count}");
        let mut expected = vec![9; n + 1];
        let expected_kept = model::compact(&few[..n], &mut expected);
        assert_eq!(words(&mut backend, kept, 1), [expected_kept], "kept {count}");
        assert_eq!(words(&mut backend, indices, n + 1), expected, "indices {count}");
        let (mut expected, mut expected_along) = (input.clone(), noise(count.max(1)));
        model::sort_pairs(&mut expected[..n], &mut expected_along[..n]);
        assert_eq!(words(&mut backend, sorted, n.max(1)), expected, "keys {count}");
        assert_eq!(words(&mut backend, along, n.max(1)), expected_along, "values {count}");
    }
    // Steps of primitives ran, and are not listed.
    assert_eq!(backend.statuses(), Ok(vec![]));
}
