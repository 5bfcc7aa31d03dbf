//! The unit of exact sums.

use bytemuck::{Pod, Zeroable};

use crate::error::ParamError;
use crate::level::exponent;

/// A quantum is L0·2⁻²⁰: an eighth of a step of an 8-bit display at one 500th of L0. Fewer bits show in dark corners,
/// more leave no room for [`MAX_DEPOSITS`].
pub const FRACTION_BITS: u32 = 20;

/// A deposit is clamped to 2³³ quanta = L0·2¹³. Diffuse illumination above 8192 times the strongest emitter is a
/// firefly; with [`MAX_DEPOSITS`] the sum stays below 2⁶⁴.
pub const CLAMP_BITS: u32 = 33;

/// What a clamp cuts off is counted exactly up to 2⁴⁴ quanta = L0·2²⁴; above, the deposit counts as saturated.
/// Higher bounds let fewer than 2²⁰ such deposits overflow the energy's 64 bits.
pub const CEILING_BITS: u32 = 44;

/// Energy lost to underflow is counted in units of quantum·2⁻²⁰, since it is below a quantum by nature.
pub const UNDERFLOW_BITS: u32 = 20;

/// Deposits that one sum takes: 2³⁰ of 2³³ quanta make 2⁶³, which leaves one bit as reserve.
pub const MAX_DEPOSITS: u32 = 1 << 30;

/// Smallest exponent of L0: the quantum stays a normal float, which no GPU flushes to 0.
pub const L0_EXPONENT_MIN: i32 = -100;

/// Largest exponent of L0: the largest sum, L0·2⁴³, stays below the largest float.
pub const L0_EXPONENT_MAX: i32 = 80;

/// The unit of a family of exact sums, by the exponent e of L0 = 2^e. Four bytes, the same on GPUs (an `i32`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Quantum {
    l0_exponent: i32,
}

impl Quantum {
    /// The unit for L0 = 2^`l0_exponent`.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] unless [`L0_EXPONENT_MIN`] ≤ `l0_exponent` ≤ [`L0_EXPONENT_MAX`].
    ///
    /// ```
    /// # use hashcache_core::exact::Quantum;
    /// assert_eq!(Quantum::new(4).unwrap().quantum(), 16.0 / 1_048_576.0);
    /// ```
    pub const fn new(l0_exponent: i32) -> Result<Self, ParamError> {
        if l0_exponent < L0_EXPONENT_MIN || l0_exponent > L0_EXPONENT_MAX {
            return Err(ParamError::OutOfRange {
                name: "l0_exponent",
                value: l0_exponent as f64,
                min: L0_EXPONENT_MIN as f64,
                max: L0_EXPONENT_MAX as f64,
            });
        }
        Ok(Self { l0_exponent })
    }

    /// The unit for a scene whose largest emission is `max_emission`: L0 is the largest power of two not above it,
    /// brought into the accepted range. A value that is not a positive finite number counts as 1.
    ///
    /// # Units
    /// `max_emission`: radiance.
    ///
    /// ```
    /// # use hashcache_core::exact::Quantum;
    /// assert_eq!(Quantum::for_scale(17.0).l0(), 16.0);
    /// ```
    #[must_use]
    pub fn for_scale(max_emission: f32) -> Self {
        let usable = max_emission.is_finite() && max_emission > 0.0;
        let l0_exponent = if usable { exponent(max_emission) } else { 0 };
        Self { l0_exponent: l0_exponent.clamp(L0_EXPONENT_MIN, L0_EXPONENT_MAX) }
    }

    /// The exponent e of L0 = 2^e.
    pub const fn l0_exponent(self) -> i32 {
        self.l0_exponent
    }

    /// L0, in radiance.
    pub const fn l0(self) -> f32 {
        power_of_two(self.l0_exponent)
    }

    /// One quantum, in radiance.
    pub const fn quantum(self) -> f32 {
        power_of_two(self.l0_exponent - FRACTION_BITS as i32)
    }

    /// The largest deposit, in radiance.
    pub const fn clamp(self) -> f32 {
        power_of_two(self.l0_exponent + (CLAMP_BITS - FRACTION_BITS) as i32)
    }

    /// A sum of quanta in radiance, for reports (relative error at most 2⁻⁵³).
    pub const fn energy(self, sum: u64) -> f64 {
        sum as f64 * power_of_two_f64(self.l0_exponent - FRACTION_BITS as i32)
    }

    /// A sum of what underflowed ([`UNDERFLOW_BITS`]) in radiance, for reports.
    pub const fn underflow_energy(self, sum: u64) -> f64 {
        sum as f64 * power_of_two_f64(self.l0_exponent - (FRACTION_BITS + UNDERFLOW_BITS) as i32)
    }
}

/// 2^`exponent` for the exponents of normal floats.
const fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

const fn power_of_two_f64(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
