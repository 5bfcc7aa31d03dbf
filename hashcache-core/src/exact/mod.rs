//! Sums that do not depend on the order of their terms.
//!
//! Radiance is rounded once, to a whole number of *quanta*, and integers are added from then on: any order, any
//! number of threads and any device give the same bits. A quantum is L0·2⁻²⁰, where L0 = 2^e is a power of two near
//! the scene's largest emission; a deposit is clamped to L0·2¹³ = 2³³ quanta, so that 2³⁰ of them fit 64 bits.
//!
//! Nothing vanishes unseen: [`Quantized`] tells what became of a deposit and how much of it was left out, and
//! [`crate::counters::Counters`] adds that up.

mod convert;
mod quantum;
mod sum;

pub use convert::{
    OUTCOME_CLAMPED, OUTCOME_EXACT, OUTCOME_NEGATIVE, OUTCOME_NON_FINITE, OUTCOME_SATURATED, OUTCOME_UNDERFLOW,
    Outcome, Quantized, dequantize, mean, quantize,
};
pub use quantum::{
    CEILING_BITS, CLAMP_BITS, FRACTION_BITS, L0_EXPONENT_MAX, L0_EXPONENT_MIN, MAX_DEPOSITS, Quantum, UNDERFLOW_BITS,
};
pub use sum::{add64, carry, hi, less64, lo, pair, shl64, sub64};
