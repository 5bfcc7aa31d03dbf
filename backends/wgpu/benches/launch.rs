//! What launching on a GPU costs: dispatches, the way back to the host, and the primitives beside plain loops.

use std::hint::black_box;

use backend_api::primitive::model;
use backend_api::{
    Access, Backend, Binding, BindingDecl, BufferDesc, BufferId, Error, Items, Kernel, Launch, Primitive, Wgsl,
};
use backend_wgpu::{AdapterChoice, WgpuBackend};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// `values[i] = values[i]·3 + i`.
static STEP: Kernel = Kernel {
    name: "bench.step",
    bindings: &[BindingDecl { name: "values", access: Access::OutPerItem, stride: 4 }],
    params_size: 0,
    body: |_: &mut Launch<'_>| unreachable!("runs on a GPU only"),
    wgsl: Some(Wgsl {
        modules: &["@group(0) @binding(0) var<storage, read_write> values: array<u32>;
            @compute @workgroup_size(64)
            fn step_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
                let item = hc_item(gid, groups);
                if item < hc_launch.count { values[item] = values[item] * 3u + item; }
            }"],
        entry: "step_main",
        workgroup_size: 64,
    }),
    casts_rays: false,
};

fn open() -> Option<WgpuBackend> {
    match WgpuBackend::open(AdapterChoice::Fastest) {
        Ok(backend) => Some(backend),
        Err(Error::NoAdapter) => {
            eprintln!("skipped: no GPU adapter; install mesa-vulkan-drivers");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn create(backend: &mut WgpuBackend, words: u32) -> BufferId {
    backend.create(&BufferDesc { name: "bench", size: 4 * u64::from(words) }).expect("create")
}

fn wait(backend: &mut WgpuBackend) {
    backend.submit().expect("submit");
    // The shortest wait: four bytes of any buffer behind all work.
    backend.statuses().expect("statuses");
}

/// One dispatch, its submit and its status, over many numbers of items.
fn launches(c: &mut Criterion) {
    let Some(mut backend) = open() else { return };
    let mut group = c.benchmark_group("backend-wgpu/launch");
    for items in [1_u32, 65_536, 1 << 20] {
        group.throughput(Throughput::Elements(u64::from(items)));
        let buffer = create(&mut backend, items);
        let binding = Binding { buffer, offset: 0, size: 4 * u64::from(items) };
        let mut values = vec![1_u32; items as usize];
        group.bench_function(BenchmarkId::new("loop", items), |b| {
            b.iter(|| {
                for (value, i) in black_box(&mut values).iter_mut().zip(0..) {
                    *value = value.wrapping_mul(3).wrapping_add(i);
                }
            });
        });
        // A hundred small ones in one submit: what a dispatch adds.
        let counts =
            if items == 1 { [("dispatch", 1), ("hundred-dispatches", 100)].as_slice() } else { &[("dispatch", 1)] };
        for &(name, count) in counts {
            group.bench_function(BenchmarkId::new(name, items), |b| {
                b.iter(|| {
                    for _ in 0..count {
                        backend.dispatch(&STEP, &[], &[binding], Items::Count(items)).expect("dispatch");
                    }
                    wait(&mut backend);
                });
            });
        }
    }
    group.finish();
}

/// Bytes to the device and back.
fn transfers(c: &mut Criterion) {
    let Some(mut backend) = open() else { return };
    let mut group = c.benchmark_group("backend-wgpu/transfer");
    for words in [1_u32, 1 << 22] {
        group.throughput(Throughput::Bytes(4 * u64::from(words)));
        let buffer = create(&mut backend, words);
        let bytes = vec![1_u8; 4 * words as usize];
        group.bench_function(BenchmarkId::new("write-read", bytes.len()), |b| {
            b.iter(|| {
                backend.write(buffer, 0, &bytes).expect("write");
                let ticket = backend.read(buffer, 0, bytes.len() as u64).expect("read");
                backend.redeem(ticket, true).expect("redeem")
            });
        });
    }
    group.finish();
}

/// Primitives over a million words, each beside its model on one thread.
fn primitives(c: &mut Criterion) {
    let Some(mut backend) = open() else { return };
    let count = 1 << 20;
    let noise: Vec<u32> = (0..count).map(|i: u32| i.wrapping_mul(0x9e37_79b9) ^ (i << 7)).collect();
    let [keys, values, output] = [(); 3].map(|()| create(&mut backend, count + 1));
    let mut group = c.benchmark_group("backend-wgpu/primitive");
    group.sample_size(10).throughput(Throughput::Elements(u64::from(count)));
    let mut sums = vec![0; noise.len() + 1];
    group.bench_function("scan/model", |b| b.iter(|| model::scan(black_box(&noise), &mut sums)));
    group.bench_function("scan/wgpu", |b| {
        b.iter(|| {
            backend.primitive(Primitive::Scan { input: keys, output, count }).expect("scan");
            wait(&mut backend);
        });
    });
    group.bench_function("sort_pairs/model", |b| {
        b.iter(|| {
            let (mut keys, mut values) = (noise.clone(), noise.clone());
            model::sort_pairs(&mut keys, &mut values);
            keys
        });
    });
    group.bench_function("sort_pairs/wgpu", |b| {
        b.iter(|| {
            backend.write(keys, 0, bytemuck::cast_slice(&noise)).expect("write");
            backend.primitive(Primitive::SortPairs { keys, values, count }).expect("sort");
            wait(&mut backend);
        });
    });
    group.finish();
}

criterion_group!(benches, launches, transfers, primitives);
criterion_main!(benches);
