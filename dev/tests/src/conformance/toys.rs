//! Small kernels with both bodies, one for each way to touch a buffer.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use backend_api::{Access, BindingDecl, Kernel, Launch, Status, Wgsl};

const fn binding(name: &'static str, access: Access, stride: u32) -> BindingDecl {
    BindingDecl { name, access, stride }
}

const fn wgsl(source: &'static [&'static str], entry: &'static str) -> Wgsl {
    Wgsl { modules: source, entry, workgroup_size: 64 }
}

/// `output[i] = [input[(7·i + 3) mod n]·factor + summand, i]`; params: factor, summand, 0, 0.
pub static SCALE: Kernel = Kernel {
    name: "toy.scale",
    bindings: &[binding("toy_input", Access::In, 4), binding("toy_output", Access::OutPerItem, 8)],
    params_size: 16,
    body: scale,
    wgsl: Some(wgsl(&[include_str!("wgsl/scale.wgsl")], "toy_scale")),
    casts_rays: false,
};

fn scale(launch: &mut Launch<'_>) {
    let &[factor, summand, ..] = launch.params::<[u32; 4]>();
    let input = launch.input::<u32>(0);
    for (i, out) in launch.items().zip(launch.output::<[u32; 2]>(1)) {
        *out = scaled(input, i, factor, summand);
    }
}

/// What [`SCALE`] writes for item `i`.
pub fn scaled(input: &[u32], i: u32, factor: u32, summand: u32) -> [u32; 2] {
    let place = i.wrapping_mul(7).wrapping_add(3) as usize % input.len();
    [input[place].wrapping_mul(factor).wrapping_add(summand), i]
}

/// `values[i] = values[i]·3 + i`.
pub static STEP: Kernel = Kernel {
    name: "toy.step",
    bindings: &[binding("toy_values", Access::OutPerItem, 4)],
    params_size: 0,
    body: step,
    wgsl: Some(wgsl(&[include_str!("wgsl/step.wgsl")], "toy_step")),
    casts_rays: false,
};

fn step(launch: &mut Launch<'_>) {
    for (i, value) in launch.items().zip(launch.output::<u32>(0)) {
        *value = value.wrapping_mul(3).wrapping_add(i);
    }
}

/// `bins[values[i] mod bins]` grows by 1.
pub static HISTOGRAM: Kernel = Kernel {
    name: "toy.histogram",
    bindings: &[binding("toy_values", Access::In, 4), binding("toy_bins", Access::AtomicU32, 4)],
    params_size: 0,
    body: histogram,
    wgsl: Some(wgsl(&[include_str!("wgsl/histogram.wgsl")], "toy_histogram")),
    casts_rays: false,
};

fn histogram(launch: &mut Launch<'_>) {
    let (values, bins) = (launch.input::<u32>(0), launch.atomic_u32(1));
    for i in launch.items() {
        bins[values[i as usize] as usize % bins.len()].fetch_add(1, Ordering::Relaxed);
    }
}

/// `sums[values[i].low mod sums] += values[i]` in 64 bits, low word first.
pub static SUM: Kernel = Kernel {
    name: "toy.sum",
    bindings: &[binding("toy_values", Access::In, 8), binding("toy_sums", Access::AtomicU64, 8)],
    params_size: 0,
    body: sum,
    wgsl: Some(wgsl(&[include_str!("wgsl/sum.wgsl")], "toy_sum")),
    casts_rays: false,
};

fn sum(launch: &mut Launch<'_>) {
    let (values, sums) = (launch.input::<u64>(0), launch.atomic_u64(1));
    for i in launch.items() {
        let value = values[i as usize];
        sums[value as u32 as usize % sums.len()].fetch_add(value, Ordering::Relaxed);
    }
}

/// Raises `flags[i]` in the status word.
pub static RAISE: Kernel = Kernel {
    name: "toy.raise",
    bindings: &[binding("toy_flags", Access::In, 4)],
    params_size: 0,
    body: raise,
    wgsl: Some(wgsl(&[include_str!("wgsl/raise.wgsl")], "toy_raise")),
    casts_rays: false,
};

fn raise(launch: &mut Launch<'_>) {
    let flags = launch.input::<u32>(0);
    for i in launch.items() {
        launch.raise(Status::from_bits(flags[i as usize]));
    }
}

/// Every way at once: `sums[0] += a[i]·b[i]`, `bins[i mod bins] += a[i]`, `results[i] = a[i]·b[i] + weight`.
/// The parameter block is 272 bytes long, and `weight` is its last word.
pub static FIVE: Kernel = Kernel {
    name: "toy.five",
    bindings: &[
        binding("toy_a", Access::In, 4),
        binding("toy_b", Access::In, 4),
        binding("toy_results", Access::OutPerItem, 4),
        binding("toy_bins", Access::AtomicU32, 4),
        binding("toy_sums", Access::AtomicU64, 8),
    ],
    params_size: 272,
    body: five,
    wgsl: Some(wgsl(&[include_str!("wgsl/five.wgsl")], "toy_five")),
    casts_rays: false,
};

fn five(launch: &mut Launch<'_>) {
    let weight = launch.params::<[u32; 68]>()[67];
    let (a, b) = (launch.input::<u32>(0), launch.input::<u32>(1));
    let results = launch.output::<u32>(2);
    let (bins, sums): (&[AtomicU32], &[AtomicU64]) = (launch.atomic_u32(3), launch.atomic_u64(4));
    for (i, result) in launch.items().map(|i| i as usize).zip(results) {
        let product = a[i].wrapping_mul(b[i]);
        sums[0].fetch_add(u64::from(product), Ordering::Relaxed);
        bins[i % bins.len()].fetch_add(a[i], Ordering::Relaxed);
        *result = product.wrapping_add(weight);
    }
}
