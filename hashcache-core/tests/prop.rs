//! Laws of the core's numbers, at the extremes.
#![expect(clippy::float_cmp, reason = "the laws state equal bits")]

#[path = "prop/exact.rs"]
mod exact;
#[path = "prop/float.rs"]
mod float;
#[path = "prop/hash.rs"]
mod hash;
#[path = "prop/level.rs"]
mod level;
#[path = "prop/pack.rs"]
mod pack;
#[path = "prop/texel.rs"]
mod texel;

use proptest::prelude::*;

/// Floats of every kind: all bit patterns, so NaN, infinities, subnormal numbers and both zeros too.
fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        prop::sample::select(vec![
            0.0,
            -0.0,
            f32::MIN_POSITIVE,
            f32::from_bits(1),
            f32::MAX,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            -f32::NAN,
            1.0,
            -1.0,
        ]),
    ]
}

/// `m·2^e` for e in the range: every order of magnitude is as likely as the others.
fn log_uniform(exponents: core::ops::Range<i32>) -> impl Strategy<Value = f32> {
    (exponents, 1.0_f32..2.0).prop_map(|(e, m)| (f64::from(m) * 2.0_f64.powi(e)) as f32)
}

/// The float with the next bits.
fn next_up(x: f32) -> f32 {
    f32::from_bits(x.to_bits() + 1)
}

/// The float with the bits before.
fn next_down(x: f32) -> f32 {
    f32::from_bits(x.to_bits() - 1)
}
