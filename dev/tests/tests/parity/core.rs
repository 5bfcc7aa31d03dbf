//! The functions of hashcache-core.

use hashcache_core::exact::{self, Quantum, hi, lo, pair};
use hashcache_core::glam::Vec3;
use hashcache_core::wgsl::ALL;
use hashcache_core::{hash, level, pack};
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::harness::{Item, call, expect, inputs};

/// Equal bits for all inputs.
fn tier_0<const N: usize>(name: &'static str, body: &str, twin: impl Fn(&Item) -> [u32; N]) {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let found = call(&mut backend, name, &ALL, body, &items);
    let expected = expect(&items, twin);
    for (item, (e, f)) in items.iter().zip(expected.iter().zip(&found)) {
        assert!(e == f, "{name}({item:x?}): {e:x?} in Rust, {f:x?} in WGSL");
    }
}

/// Words as floats, compared by `close`; returns what the GPU gave.
fn tier_1<const N: usize>(
    name: &'static str,
    body: &str,
    twin: impl Fn(&Item) -> [u32; N],
    close: impl Fn(&Item, u32, u32) -> bool,
) {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let found = call(&mut backend, name, &ALL, body, &items);
    let mut different = 0;
    for (item, f) in items.iter().zip(&found) {
        let e = twin(item);
        for (&e, &f) in e.iter().zip(f) {
            different += usize::from(e != f);
            assert!(close(item, e, f), "{name}({item:x?}): {e:x} in Rust, {f:x} in WGSL");
        }
    }
    eprintln!("{name}: {different} of {} words differ", items.len() * N);
}

fn quantum(word: u32) -> Quantum {
    let (low, high) = (exact::L0_EXPONENT_MIN, exact::L0_EXPONENT_MAX);
    Quantum::new(low + (word % (high - low + 1) as u32) as i32).expect("in range")
}

/// WGSL of [`quantum`].
fn quantum_wgsl(k: u32) -> String {
    let (low, high) = (exact::L0_EXPONENT_MIN, exact::L0_EXPONENT_MAX);
    format!("({low} + i32(word({k}u) % {}u))", high - low + 1)
}

fn two(v: u64) -> [u32; 2] {
    [lo(v), hi(v)]
}

#[test]
fn hashes() {
    tier_0("hc_pcg", "put(0u, hc_pcg(word(0u)));", |i| [hash::pcg(i[0])]);
    tier_0("hc_pcg2d", "put2(0u, hc_pcg2d(word2(0u)));", |i| hash::pcg2d([i[0], i[1]]));
    let three = "let v = hc_pcg3d(vec3<u32>(word(0u), word(1u), word(2u))); put2(0u, v.xy); put(2u, v.z);";
    tier_0("hc_pcg3d", three, |i| hash::pcg3d([i[0], i[1], i[2]]));
    let four = "let v = hc_pcg4d(vec4<u32>(word2(0u), word2(2u))); put2(0u, v.xy); put2(2u, v.zw);";
    tier_0("hc_pcg4d", four, |i| hash::pcg4d([i[0], i[1], i[2], i[3]]));
    tier_0("hc_mix", "put(0u, hc_mix(word(0u), word(1u)));", |i| [hash::mix(i[0], i[1])]);
    tier_0("hc_finish", "put(0u, hc_finish(word(0u)));", |i| [hash::finish(i[0])]);
    tier_0("hc_to_unit_f32", "put_f32(0u, hc_to_unit_f32(word(0u)));", |i| [hash::to_unit_f32(i[0]).to_bits()]);
}

#[test]
fn packing() {
    tier_0("hc_half_from_f32", "put(0u, hc_half_from_f32(word(0u)));", |i| [pack::half_from_f32(i[0])]);
    tier_0("hc_half_to_f32", "put(0u, hc_half_to_f32(word(0u) & 0xffffu));", |i| [pack::half_to_f32(i[0] & 0xffff)]);
    tier_0("hc_pack_half2", "put(0u, hc_pack_half2(vec2<f32>(word_f32(0u), word_f32(1u))));", |i| {
        [pack::pack_half2([f32::from_bits(i[0]), f32::from_bits(i[1])])]
    });
    let unpack = "let v = hc_unpack_half2(word(0u)); put_f32(0u, v.x); put_f32(1u, v.y);";
    tier_0("hc_unpack_half2", unpack, |i| pack::unpack_half2(i[0]).map(f32::to_bits));
    let decode = "let v = bitcast<vec3<u32>>(hc_octahedral_decode_int(word(0u))); put2(0u, v.xy); put(2u, v.z);";
    tier_0("hc_octahedral_decode_int", decode, |i| pack::octahedral_decode_int(i[0]).map(|v| v as u32));
}

/// Two divisions of 2.5 units each and a rounding: a coordinate that falls on the border between two codes may take
/// either.
#[test]
fn octahedral_codes_are_neighbours() {
    let body = "put(0u, hc_octahedral_encode(vec3<f32>(word_f32(0u), word_f32(1u), word_f32(2u))));";
    let twin = |i: &Item| [pack::octahedral_encode(Vec3::from([i[0], i[1], i[2]].map(f32::from_bits)))];
    tier_1("hc_octahedral_encode", body, twin, |_, e, f| {
        let near = |shift: u32| ((e >> shift) as i16).abs_diff((f >> shift) as i16) <= 1;
        near(0) && near(16)
    });
}

/// A root (an inverse root of 2 units, a division of 2.5) and a division of 2.5, of values up to 1: 8 times 2⁻²⁴.
const DIRECTION_ERROR: f32 = 8.0 / 16_777_216.0;

#[test]
fn octahedral_directions_are_close() {
    let body = "let v = hc_octahedral_decode(word(0u)); put_f32(0u, v.x); put_f32(1u, v.y); put_f32(2u, v.z);";
    let twin = |i: &Item| pack::octahedral_decode(i[0]).to_array().map(f32::to_bits);
    tier_1("hc_octahedral_decode", body, twin, |_, e, f| {
        (f32::from_bits(e) - f32::from_bits(f)).abs() <= DIRECTION_ERROR
    });
}

#[test]
fn levels() {
    tier_0("hc_exponent", "put(0u, bitcast<u32>(hc_exponent(word_f32(0u))));", |i| {
        [level::exponent(f32::from_bits(i[0])) as u32]
    });
    tier_0("hc_level_from_footprint", "put(0u, hc_level_from_footprint(word_f32(0u), word_f32(1u)));", |i| {
        [level::level_from_footprint(f32::from_bits(i[0]), f32::from_bits(i[1]))]
    });
}

#[test]
fn sums_of_64_bits() {
    tier_0("hc_carry", "put(0u, hc_carry(word(0u), word2(1u)));", |i| [exact::carry(i[0], pair(i[1], i[2]))]);
    tier_0("hc_add64", "put2(0u, hc_add64(word2(0u), word2(2u)));", |i| {
        two(exact::add64(pair(i[0], i[1]), pair(i[2], i[3])))
    });
    tier_0("hc_sub64", "put2(0u, hc_sub64(word2(0u), word2(2u)));", |i| {
        two(exact::sub64(pair(i[0], i[1]), pair(i[2], i[3])))
    });
    tier_0("hc_less64", "put(0u, u32(hc_less64(word2(0u), word2(2u))));", |i| {
        [u32::from(exact::less64(pair(i[0], i[1]), pair(i[2], i[3])))]
    });
    tier_0("hc_shl64", "put2(0u, hc_shl64(word2(0u), word(2u) % 64u));", |i| {
        two(exact::shl64(pair(i[0], i[1]), i[2] % 64))
    });
}

#[test]
fn quanta() {
    let body = format!(
        "let v = hc_quantize({}, word_f32(0u)); put2(0u, v.value); put2(2u, v.lost); put(4u, v.outcome);",
        quantum_wgsl(1)
    );
    tier_0("hc_quantize", &body, |i| {
        let quantized = exact::quantize(quantum(i[1]), f32::from_bits(i[0]));
        let ([a, b], [c, d]) = (two(quantized.value), two(quantized.lost));
        [a, b, c, d, quantized.outcome as u32]
    });
    let body = format!("put_f32(0u, hc_dequantize({}, word2(1u)));", quantum_wgsl(0));
    tier_0("hc_dequantize", &body, |i| [exact::dequantize(quantum(i[0]), pair(i[1], i[2])).to_bits()]);
}

/// WGSL allows a division 2.5 units in the last place of its result; a subnormal result may be 0.
#[test]
fn means_are_close() {
    let body = format!("put_f32(0u, hc_mean({}, word2(1u), word(3u)));", quantum_wgsl(0));
    let twin = |i: &Item| [exact::mean(quantum(i[0]), pair(i[1], i[2]), i[3]).to_bits()];
    tier_1("hc_mean", &body, twin, |_, e, f| {
        e.abs_diff(f) <= 3 || (f32::from_bits(e).is_subnormal() && f32::from_bits(f) == 0.0)
    });
}

/// The comparison itself: a shader that is wrong for one input of 65536, and one that writes a word too many.
#[test]
fn wrong_shaders_are_noticed() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let expected = expect(&items, |i| [hash::pcg(i[0])]);
    let right = call(&mut backend, "right", &ALL, "put(0u, hc_pcg(word(0u)));", &items);
    assert!(right == expected);
    let wrong = "put(0u, hc_pcg(word(0u)) + select(0u, 1u, word(0u) == 5u));";
    assert!(call(&mut backend, "wrong once", &ALL, wrong, &items) != expected);
    let wrong = "put(0u, hc_pcg(word(0u))); put(7u, 0u);";
    assert!(call(&mut backend, "one too many", &ALL, wrong, &items) != expected);
}
