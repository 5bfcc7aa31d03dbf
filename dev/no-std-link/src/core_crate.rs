//! `hashcache-core`.

use core::hint::black_box;

use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::exact::{
    Outcome, Quantum, add64, carry, dequantize, hi, less64, lo, mean, pair, quantize, shl64, sub64,
};
use hashcache_core::float;
use hashcache_core::geometry::{Geometry, Instance, Mesh, Opacity, OpacityMask};
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{finish, mix, pcg, pcg2d, pcg3d, pcg4d, to_unit_f32};
use hashcache_core::level::{exponent, level_from_footprint};
use hashcache_core::pack::{
    half_from_f32, half_to_f32, octahedral_decode, octahedral_decode_int, octahedral_encode, pack_half2, unpack_half2,
};
use hashcache_core::record::VertexRecord;
use hashcache_core::texel::{Wrap, texel_pair};

use crate::checks::Checks;

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    floats(checks);
    hashes(checks);
    packing(checks);
    sums(checks);
    geometry(checks);
}

fn floats(checks: &mut Checks) {
    let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
    let (half, two) = (black_box(0.5_f32), black_box(2.0_f32));
    checks.that("float::sqrt", float::sqrt(two * two).to_bits() == two.to_bits());
    checks.that("float::cbrt", near(float::cbrt(8.0 * half), 1.587_401));
    checks.that("float::sin_cos", float::sin_cos(half) == (float::sin(half), float::cos(half)));
    checks.that("float::tan", near(float::tan(half), float::sin(half) / float::cos(half)));
    checks.that("float::asin", near(float::asin(float::sin(half)), half));
    checks.that("float::acos", near(float::acos(float::cos(half)), half));
    checks.that("float::atan", near(float::atan(float::tan(half)), half));
    checks.that("float::atan2", near(float::atan2(float::sin(half), float::cos(half)), half));
    checks.that("float::ln", near(float::ln(float::exp(half)), half));
    checks.that("float::ln_1p", near(float::ln_1p(float::exp_m1(half)), half));
    checks.that("float::log2", near(float::log2(float::exp2(half)), half));
    checks.that("float::log10", near(float::log10(50.0 * two), 2.0));
    checks.that("float::powf", near(float::powf(two, half), float::sqrt(two)));
    checks.that("float::hypot", near(float::hypot(1.5 * two, 2.0 * two), 5.0));
    checks.that("float::floor", near(float::floor(-half), -1.0) && near(float::ceil(half), 1.0));
    checks.that("float::round", near(float::round(-half), -1.0) && near(float::trunc(-half), 0.0));
    checks.that("float::abs", near(float::abs(-half), half));
}

fn hashes(checks: &mut Checks) {
    let zero = black_box(0_u32);
    checks.that("hash::pcg", pcg(zero) == 129_708_002);
    checks.that("hash::pcg2d", pcg2d([zero, 1]) != pcg2d([1, zero]));
    checks.that("hash::pcg3d", pcg3d([17, 3 + zero, 0x7fff_0000])[0] & 0xffff == 49_265);
    checks.that("hash::pcg4d", pcg4d([zero; 4]) != [0; 4]);
    checks.that("hash::finish", finish(mix(zero, u32::from_le_bytes(*b"test")) ^ 4) == 0xba6b_d213);
    checks.that("hash::to_unit_f32", to_unit_f32(zero.wrapping_sub(1)) < 1.0);
    checks.that("level", level_from_footprint(black_box(0.09), 100.0) == 3 && exponent(black_box(0.75)) == -1);
}

fn packing(checks: &mut Checks) {
    let down = black_box(Vec3::new(0.6, 0.0, -0.8));
    let code = octahedral_encode(down);
    checks.that("pack::octahedral_encode", code == 0x4924_7fff);
    checks.that("pack::octahedral_decode", octahedral_decode(code).distance(down) < 1e-4);
    checks.that("pack::octahedral_decode_int", octahedral_decode_int(code) == [14043, 0, -18724]);
    let one = black_box(1.0_f32);
    checks.that("pack::half", half_to_f32(half_from_f32(one.to_bits())) == one.to_bits());
    checks.that(
        "pack::half2",
        unpack_half2(pack_half2([1.5 * one, -2.0])).map(f32::to_bits) == [1.5, -2.0_f32].map(f32::to_bits),
    );
}

fn sums(checks: &mut Checks) {
    let refused = Quantum::new(black_box(1000));
    checks.that("Quantum::new", matches!(refused, Err(ParamError::OutOfRange { .. })));
    checks.that("ParamError::check_range", ParamError::check_range("x", black_box(f64::NAN), 0.0, 1.0).is_err());
    let q = Quantum::for_scale(black_box(1.5));
    checks.that("Quantum", q.l0_exponent() == 0 && q.l0() > q.quantum() && q.clamp() > q.l0());
    let mut counters = Counters::default();
    let mut sum = 0;
    for x in black_box([0.25, 0.75, 1e9, f32::NAN]) {
        let deposit = quantize(q, x);
        counters.note(&deposit, true);
        sum = add64(sum, deposit.value);
    }
    checks.that("counters::note", counters.saturated == 1 && counters.non_finite == 1 && counters.balance() == 0);
    checks.that("counters::merge", Counters::from_words(counters.merge(&Counters::default()).words()) == counters);
    checks.that("exact::quantize", quantize(q, black_box(-1.0)).outcome == Outcome::Negative);
    checks.that("exact::dequantize", dequantize(q, sum).to_bits() == 8193.0_f32.to_bits());
    checks.that("exact::mean", mean(q, sum, 3).to_bits() == 2731.0_f32.to_bits());
    checks.that("Quantum::energy", q.energy(sum) > 8192.9 && q.underflow_energy(1) > 0.0);
    checks.that("exact::carry", carry(u32::MAX, black_box((7 << 32) | 1)) == 8);
    checks.that("exact::pair", pair(lo(sum), hi(sum)) == sum && sub64(shl64(sum, 1), sum) == sum && !less64(sum, sum));
}

fn geometry(checks: &mut Checks) {
    let mask = OpacityMask {
        width: 2,
        height: 1,
        cutoff: 0.5,
        factor: 1.0,
        uv_rows: OpacityMask::IDENTITY,
        ..bytemuck::Zeroable::zeroed()
    };
    let opacity = Opacity {
        mask_of_triangle: &[0],
        masks: &[mask],
        uv: &[[[0.0; 2], [1.0, 0.0], [0.0; 2]]],
        alpha: black_box(&[255, 0]),
    };
    let geometry = Geometry {
        positions: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        indices: &[[0, 1, 2]],
        meshes: &[Mesh { first_triangle: 0, triangle_count: 1 }],
        instances: &[Instance::identity(0)],
        opacity,
    };
    checks.that(
        "Opacity::check",
        black_box(&opacity).check(1).is_ok() && opacity.is_in_use() && mask.has_holes(&[255, 0]),
    );
    checks.that("Opacity::passes", opacity.passes(0, black_box(0.75), 0.0) && !opacity.passes(0, black_box(0.25), 0.0));
    checks.that("texel_pair", texel_pair(black_box(-0.125), 4, Wrap::word(Wrap::Clamp, Wrap::Repeat)).first == 0);
    let corner = Vec3::from_array(black_box(&geometry).positions[1]);
    checks.that("Instance::point", geometry.instances[0].point(corner) == corner);
    let mut vertex: VertexRecord = bytemuck::Zeroable::zeroed();
    vertex.flags = VertexRecord::VALID;
    vertex.throughput = [0.5; 4];
    checks.that(
        "VertexRecord",
        black_box(vertex).is_valid() && vertex.normal() == Vec3::Z && vertex.radiance() == Vec3::ZERO,
    );
    checks.that("VertexRecord::radiance_with", vertex.radiance_with(Vec3::ONE, Vec3::ONE) == Vec3::ONE);
}
