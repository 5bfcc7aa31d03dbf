//! What launching costs: a kernel of one multiplication an item, beside the same loop without a backend.

use std::hint::black_box;

use backend_api::{Access, Backend, Binding, BindingDecl, BufferDesc, BufferId, Items, Kernel, Launch, Primitive};
use backend_cpu::CpuBackend;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// `values[i] = values[i]·3 + i`.
static STEP: Kernel = Kernel {
    name: "bench.step",
    bindings: &[BindingDecl { name: "values", access: Access::OutPerItem, stride: 4 }],
    params_size: 0,
    body: |launch: &mut Launch<'_>| {
        for (i, value) in launch.items().zip(launch.output::<u32>(0)) {
            *value = step(*value, i);
        }
    },
    wgsl: None,
    casts_rays: false,
};

#[inline]
fn step(value: u32, i: u32) -> u32 {
    value.wrapping_mul(3).wrapping_add(i)
}

fn backends() -> [(&'static str, CpuBackend); 3] {
    let rayon = |threads| CpuBackend::rayon(threads).expect("threads");
    [("serial", CpuBackend::serial()), ("rayon-1", rayon(1)), ("rayon-2", rayon(2))]
}

fn create(backend: &mut CpuBackend, words: u32) -> BufferId {
    backend.create(&BufferDesc { name: "bench", size: 4 * u64::from(words) }).expect("create")
}

/// One dispatch and its submit, over many numbers of items.
fn items(c: &mut Criterion) {
    let mut group = c.benchmark_group("backend-cpu/launch");
    for items in [0_u32, 1, 256, 4096, 65_536, 1 << 20] {
        group.throughput(Throughput::Elements(u64::from(items.max(1))));
        let mut values = vec![1_u32; items as usize];
        group.bench_function(BenchmarkId::new("loop", items), |b| {
            b.iter(|| {
                for (i, value) in (0..).zip(black_box(&mut values)) {
                    *value = step(*value, i);
                }
            });
        });
        for (name, mut backend) in backends() {
            let buffer = create(&mut backend, items.max(1));
            let binding = Binding { buffer, offset: 0, size: 4 * u64::from(items.max(1)) };
            group.bench_function(BenchmarkId::new(name, items), |b| {
                b.iter(|| {
                    backend.dispatch(&STEP, &[], &[binding], Items::Count(items)).expect("dispatch");
                    backend.submit().expect("submit");
                    backend.statuses().expect("statuses")
                });
            });
        }
    }
    group.finish();
}

/// A hundred small dispatches in one submit: what a dispatch adds.
fn batch(c: &mut Criterion) {
    let mut group = c.benchmark_group("backend-cpu/launch-batch");
    group.throughput(Throughput::Elements(100));
    for (name, mut backend) in backends() {
        // A backend's table is searched for a dispatch's buffers; a pipeline has a few dozen.
        let buffers: Vec<_> = (0..32).map(|_| create(&mut backend, 256)).collect();
        group.bench_function(BenchmarkId::new(name, 256), |b| {
            b.iter(|| {
                for k in 0..100 {
                    let binding = Binding { buffer: buffers[k % 32], offset: 0, size: 1024 };
                    backend.dispatch(&STEP, &[], &[binding], Items::Count(256)).expect("dispatch");
                }
                backend.submit().expect("submit");
                backend.statuses().expect("statuses")
            });
        });
    }
    group.finish();
}

/// Primitives over a million words; `serial` is the model, so the baseline of the others.
fn primitives(c: &mut Criterion) {
    const COUNT: u32 = 1 << 20;
    let words: Vec<u32> = (0..COUNT).map(|i| i.wrapping_mul(0x9e37_79b9) >> 12).collect();
    for operation in ["scan", "sort-pairs", "reduce-by-key", "compact"] {
        let mut group = c.benchmark_group(format!("backend-cpu/{operation}"));
        group.throughput(Throughput::Elements(u64::from(COUNT))).sample_size(20);
        for (name, mut backend) in backends() {
            let [keys, values, unique, sums, runs] = [COUNT; 5].map(|count| create(&mut backend, count + 1));
            let primitive = match operation {
                "scan" => Primitive::Scan { input: keys, output: values, count: COUNT },
                "sort-pairs" => Primitive::SortPairs { keys, values, count: COUNT },
                "reduce-by-key" => Primitive::ReduceByKey { keys, values, unique, sums, runs, count: COUNT },
                _ => Primitive::Compact { flags: keys, indices: unique, kept: runs, count: COUNT },
            };
            group.bench_function(BenchmarkId::new(name, COUNT), |b| {
                b.iter(|| {
                    backend.write(keys, 0, bytemuck::cast_slice(&words)).expect("write");
                    backend.primitive(primitive).expect("primitive");
                    backend.submit().expect("submit");
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, items, batch, primitives);
criterion_main!(benches);
