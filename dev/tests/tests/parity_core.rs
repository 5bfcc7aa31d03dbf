//! The core's integer functions, host against GPU: equal bits for random and for hostile words.

use backend_api::{Access, Backend, Binding, BindingDecl, BufferDesc, Items, Kernel, Launch, Wgsl};
use backend_cpu::CpuBackend;
use hashcache_core::exact::{Quantum, add64, carry, dequantize, hi, less64, lo, pair, quantize, shl64, sub64};
use hashcache_core::hash::{finish, mix, pcg, pcg2d, pcg3d, pcg4d, to_unit_f32};
use hashcache_core::level::{exponent, level_from_footprint};
use hashcache_core::pack::{half_from_f32, half_to_f32, octahedral_decode_int, pack_half2, unpack_half2};
use hashcache_core::wgsl;
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::vertices::Noise;

const INPUTS: usize = 4;
const OUTPUTS: usize = 40;
const POISON: u32 = 0xa5a5_a5a5;

/// Which function wrote which words, for messages.
const NAMES: [(usize, &str); 19] = [
    (0, "pcg"),
    (1, "pcg2d"),
    (3, "pcg3d"),
    (6, "pcg4d"),
    (10, "mix"),
    (11, "finish"),
    (12, "to_unit_f32"),
    (13, "half_from_f32"),
    (14, "half_to_f32"),
    (15, "pack_half2 of unpack_half2"),
    (16, "octahedral_decode_int"),
    (19, "exponent"),
    (20, "level_from_footprint"),
    (21, "quantize"),
    (26, "dequantize"),
    (27, "add64"),
    (29, "sub64"),
    (31, "less64, carry"),
    (33, "shl64"),
];

static KERNEL: Kernel = Kernel {
    name: "parity.core",
    bindings: &[
        BindingDecl { name: "inputs", access: Access::In, stride: (INPUTS * 4) as u32 },
        BindingDecl { name: "outputs", access: Access::OutPerItem, stride: (OUTPUTS * 4) as u32 },
    ],
    params_size: 0,
    body,
    wgsl: Some(Wgsl {
        modules: &[wgsl::HASH, wgsl::PACK, wgsl::LEVEL, wgsl::EXACT, include_str!("parity_core.wgsl")],
        entry: "parity_core",
        workgroup_size: 64,
    }),
    casts_rays: false,
};

fn body(launch: &mut Launch<'_>) {
    let outputs = launch.output::<[u32; OUTPUTS]>(1);
    let inputs = &launch.input::<[u32; INPUTS]>(0)[launch.first as usize..];
    for (output, input) in outputs.iter_mut().zip(inputs) {
        *output = words(*input);
    }
}

fn words([a, b, c, d]: [u32; INPUTS]) -> [u32; OUTPUTS] {
    let [p, q] = pcg2d([a, b]);
    let [r, s, t] = pcg3d([a, b, c]);
    let [u, v, w, x] = pcg4d([a, b, c, d]);
    let octahedral = octahedral_decode_int(a).map(|v| v as u32);
    let quantum = Quantum::new((d % 181) as i32 - 100).expect("in range");
    let quanta = quantize(quantum, f32::from_bits(a));
    let (left, right) = (pair(a, b), pair(c, d));
    let (sum, difference, shifted) = (add64(left, right), sub64(left, right), shl64(left, c & 63));
    let mut out = [0; OUTPUTS];
    out[..35].copy_from_slice(&[
        pcg(a),
        p,
        q,
        r,
        s,
        t,
        u,
        v,
        w,
        x,
        mix(a, b),
        finish(a),
        to_unit_f32(a).to_bits(),
        half_from_f32(a),
        half_to_f32(a & 0xffff),
        pack_half2(unpack_half2(b)),
        octahedral[0],
        octahedral[1],
        octahedral[2],
        exponent(f32::from_bits(a)) as u32,
        level_from_footprint(f32::from_bits(a), f32::from_bits(b)),
        lo(quanta.value),
        hi(quanta.value),
        lo(quanta.lost),
        hi(quanta.lost),
        quanta.outcome as u32,
        dequantize(quantum, pair(b, c)).to_bits(),
        lo(sum),
        hi(sum),
        lo(difference),
        hi(difference),
        u32::from(less64(left, right)),
        carry(a, right),
        lo(shifted),
        hi(shifted),
    ]);
    out
}

/// Random words; floats of every exponent; every pair of hostile words.
fn inputs() -> Vec<[u32; INPUTS]> {
    let mut noise = Noise(5);
    let mut all: Vec<_> = (0..20_000).map(|_| [noise.word(), noise.word(), noise.word(), noise.word()]).collect();
    for exponent in 0..512 {
        for _ in 0..16 {
            let mantissa = noise.word() & noise.word() & 0x007f_ffff;
            let small = noise.word() >> (noise.word() & 31);
            all.push([exponent << 23 | mantissa, small, noise.word() >> (noise.word() & 31), noise.word()]);
        }
    }
    let hostile: Vec<u32> = [0.0, -0.0, 1.0, -1.0, 0.5, f32::MAX, f32::INFINITY, -f32::INFINITY, f32::NAN, -f32::NAN]
        .map(f32::to_bits)
        .into_iter()
        .chain([1, 2, 0x007f_ffff, 0x0080_0000, 0x8000_8000, 0x7fff_7fff, 0xffff_0000, u32::MAX, 0x7f80_0001])
        .chain([0x477f_efff, 0x477f_f000, 0x3300_0000, 0x3300_0001, 0x387f_ffff, 0x3880_0000])
        .collect();
    for &a in &hostile {
        for &b in &hostile {
            all.push([a, b, b ^ a, 100]);
            all.push([a, b, 0, 0]);
            all.push([a, b, u32::MAX, 180]);
        }
    }
    all
}

fn run(backend: &mut impl Backend, inputs: &[[u32; INPUTS]]) -> Vec<[u32; OUTPUTS]> {
    let bytes: &[u8] = bytemuck::cast_slice(inputs);
    let size = (inputs.len() * OUTPUTS * 4) as u64;
    let from = backend.create(&BufferDesc { name: "inputs", size: bytes.len() as u64 }).expect("create");
    let to = backend.create(&BufferDesc { name: "outputs", size }).expect("create");
    backend.write(from, 0, bytes).expect("write");
    backend.write(to, 0, bytemuck::cast_slice(&vec![POISON; inputs.len() * OUTPUTS])).expect("write");
    let bindings =
        [Binding { buffer: from, offset: 0, size: bytes.len() as u64 }, Binding { buffer: to, offset: 0, size }];
    backend.dispatch(&KERNEL, &[], &bindings, Items::Count(inputs.len() as u32)).expect("dispatch");
    backend.submit().expect("submit");
    let ticket = backend.read(to, 0, size).expect("read");
    let bytes = backend.redeem(ticket, true).expect("redeem").expect("waited for");
    bytemuck::pod_collect_to_vec(&bytes)
}

#[test]
fn equal_bits_on_host_and_gpu() {
    let inputs = inputs();
    let host = run(&mut CpuBackend::serial(), &inputs);
    let Some(mut backend) = gpu::backend() else { return };
    let device = run(&mut backend, &inputs);
    for (input, (expected, found)) in inputs.iter().zip(host.iter().zip(&device)) {
        if let Some(word) = expected.iter().zip(found).position(|(e, f)| e != f) {
            let (_, name) = NAMES.iter().rev().find(|(first, _)| *first <= word).expect("the first is 0");
            panic!("{name}, word {word}: {:#x}, found {:#x} for {input:#x?}", expected[word], found[word]);
        }
    }
    eprintln!("{} inputs, 35 words each: equal", inputs.len());
}
