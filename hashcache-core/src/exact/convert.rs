//! From floats to quanta and back, by integer operations on the float's bits.

use super::quantum::{CEILING_BITS, CLAMP_BITS, FRACTION_BITS, Quantum, UNDERFLOW_BITS};

/// [`Outcome::Exact`] as a word.
pub const OUTCOME_EXACT: u32 = 0;
/// [`Outcome::Underflow`] as a word.
pub const OUTCOME_UNDERFLOW: u32 = 1;
/// [`Outcome::Clamped`] as a word.
pub const OUTCOME_CLAMPED: u32 = 2;
/// [`Outcome::Saturated`] as a word.
pub const OUTCOME_SATURATED: u32 = 3;
/// [`Outcome::NonFinite`] as a word.
pub const OUTCOME_NON_FINITE: u32 = 4;
/// [`Outcome::Negative`] as a word.
pub const OUTCOME_NEGATIVE: u32 = 5;

/// What became of a number on its way into an exact sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Outcome {
    /// Stored, at most half a quantum from the given value (0 for a given 0).
    Exact = OUTCOME_EXACT,
    /// Above 0 and below half a quantum: stored as 0.
    Underflow = OUTCOME_UNDERFLOW,
    /// Above the clamp: stored as the clamp, the rest is in [`Quantized::lost`].
    Clamped = OUTCOME_CLAMPED,
    /// Above 2^[`CEILING_BITS`] quanta: stored as the clamp, and [`Quantized::lost`] holds only what lies below that
    /// ceiling.
    Saturated = OUTCOME_SATURATED,
    /// NaN or infinite: stored as 0, energy unknown.
    NonFinite = OUTCOME_NON_FINITE,
    /// Below 0: stored as 0. Radiance has no negative values, so this is an error upstream.
    Negative = OUTCOME_NEGATIVE,
}

/// A number as a deposit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantized {
    /// What to add to the sum, in quanta, at most 2^[`CLAMP_BITS`].
    pub value: u64,
    /// What was left out: in quanta when clamped or saturated, in quantum·2^−[`UNDERFLOW_BITS`] when underflowed,
    /// else 0.
    pub lost: u64,
    /// What became of the number.
    pub outcome: Outcome,
}

/// `x` as a whole number of quanta: nearest, ties up.
///
/// # Units
/// `x` in radiance.
///
/// ```
/// # use hashcache_core::exact::{Outcome, Quantum, quantize};
/// let q = Quantum::new(0).unwrap();
/// assert_eq!(quantize(q, 1.0).value, 1 << 20);
/// assert_eq!(quantize(q, 1e-7).outcome, Outcome::Underflow);
/// let firefly = quantize(q, 10_000.0);
/// assert_eq!((firefly.value, firefly.lost), (8192 << 20, 1808 << 20));
/// ```
#[inline]
#[must_use]
pub const fn quantize(q: Quantum, x: f32) -> Quantized {
    let bits = x.to_bits();
    let magnitude = bits & 0x7fff_ffff;
    if magnitude >= 0x7f80_0000 {
        return Quantized { value: 0, lost: 0, outcome: Outcome::NonFinite };
    }
    if magnitude == 0 {
        return Quantized { value: 0, lost: 0, outcome: Outcome::Exact };
    }
    if bits != magnitude {
        return Quantized { value: 0, lost: 0, outcome: Outcome::Negative };
    }
    // x = mantissa · 2^shift quanta. Subnormal numbers have no hidden bit and the exponent of the smallest normal.
    let biased = magnitude >> 23;
    let fraction = magnitude & 0x007f_ffff;
    let (mantissa, biased) = if biased == 0 { (fraction, 1) } else { (fraction | 0x0080_0000, biased) };
    let shift = biased as i32 - 150 - (q.l0_exponent() - FRACTION_BITS as i32);
    if shift < 0 {
        return quantize_below(mantissa, -shift as u32);
    }
    // Mantissas here have 24 bits: from shift 22 on the value is above the ceiling whatever they are.
    let wide = (mantissa as u64) << if shift > 22 { 22 } else { shift };
    let clamp = 1 << CLAMP_BITS;
    if wide <= clamp {
        return Quantized { value: wide, lost: 0, outcome: Outcome::Exact };
    }
    let ceiling = 1 << CEILING_BITS;
    if wide > ceiling {
        return Quantized { value: clamp, lost: ceiling - clamp, outcome: Outcome::Saturated };
    }
    Quantized { value: clamp, lost: wide - clamp, outcome: Outcome::Clamped }
}

/// `mantissa / 2^shift` quanta, for `shift` above 0.
#[inline]
const fn quantize_below(mantissa: u32, shift: u32) -> Quantized {
    let value = round_shift(mantissa, shift);
    if value > 0 {
        return Quantized { value: value as u64, lost: 0, outcome: Outcome::Exact };
    }
    // A normal mantissa rounds to 0 from shift 25 on; subnormal numbers have a shift of at least 29.
    let lost = round_shift(mantissa, shift - UNDERFLOW_BITS);
    Quantized { value: 0, lost: lost as u64, outcome: Outcome::Underflow }
}

/// `mantissa / 2^shift` to the nearest integer, ties up, for mantissas of at most 24 bits.
#[inline]
const fn round_shift(mantissa: u32, shift: u32) -> u32 {
    if shift == 0 {
        return mantissa;
    }
    if shift > 24 {
        return 0;
    }
    (mantissa + (1 << (shift - 1))) >> shift
}

/// A sum of quanta as radiance: the nearest float, ties to even.
///
/// ```
/// # use hashcache_core::exact::{Quantum, dequantize};
/// assert_eq!(dequantize(Quantum::new(1).unwrap(), 3 << 19), 3.0);
/// ```
#[inline]
pub const fn dequantize(q: Quantum, sum: u64) -> f32 {
    // The product is exact: the factor is a power of two and the result is normal for every accepted L0.
    sum as f32 * q.quantum()
}

/// The mean of `count` deposits that sum to `sum`, in radiance; 0 when `count` is 0. Within 1.5 units in the last
/// place.
///
/// ```
/// # use hashcache_core::exact::{Quantum, mean};
/// assert_eq!(mean(Quantum::new(0).unwrap(), 3 << 20, 2), 1.5);
/// ```
#[inline]
pub const fn mean(q: Quantum, sum: u64, count: u32) -> f32 {
    if count == 0 {
        return 0.0;
    }
    dequantize(q, sum) / count as f32
}
