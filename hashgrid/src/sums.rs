//! What a cell has gathered, as plain numbers: means, their standard error, and exact shares and sums of it.

use hashcache_core::exact::{Quantum, mean};
use hashcache_core::float::sqrt;

use crate::table::Quanta;

/// Weights of red, green and blue in the luminance, in 256ths: Rec. 709's 0.2126, 0.7152, 0.0722 to the nearest 256th
/// that adds up to one. Whole numbers, so that the sum of the luminances follows exactly from the colours' sums and only
/// the squares need words of their own.
pub const LUMINANCE: [u64; 3] = [54, 183, 19];

/// Luminance of a vertex's direct and further light together.
///
/// # Units
/// 256ths of a quantum; below 2⁴².
///
/// # Source
/// ITU-R BT.709-6.
#[inline]
pub const fn luminance(values: &Quanta) -> u64 {
    let [a, b, c, d, e, f] = *values;
    LUMINANCE[0] * (a + d) + LUMINANCE[1] * (b + e) + LUMINANCE[2] * (c + f)
}

/// The square of a luminance, below 2⁸⁴: 2³⁰ of them fit the 128 bits of a cell's sum.
#[inline]
pub const fn square(luminance: u64) -> u128 {
    luminance as u128 * luminance as u128
}

/// What a number of deposits makes together: count, sums of the light, sum of the squares of its luminance.
///
/// ```
/// use hashcache_core::exact::Quantum;
/// use hashgrid::sums::Sums;
///
/// let q = Quantum::new(0)?; // a quantum is 2⁻²⁰
/// let one = |light: u64| Sums::of(&[light << 20, light << 20, light << 20, 0, 0, 0]);
/// let sums = one(1).plus(&one(3));
/// assert_eq!((sums.count, sums.mean_direct(q)), (2, [2.0; 3]));
/// assert_eq!(sums.variance(q), Some(2.0)); // ((1 − 2)² + (3 − 2)²) / (2 − 1)
/// assert_eq!(sums.standard_error(q), Some(1.0));
/// # Ok::<(), hashcache_core::error::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sums {
    /// Deposits, or the weight of as many.
    pub count: u32,
    /// Sums of direct red, green, blue, further red, green, blue, in quanta.
    pub light: Quanta,
    /// Sum of the squares of the luminance, in (quantum/256)²; 0 where the layout has none.
    pub squares: u128,
}

impl Sums {
    /// One deposit.
    #[inline]
    #[must_use]
    pub const fn of(values: &Quanta) -> Self {
        Self { count: 1, light: *values, squares: square(luminance(values)) }
    }

    /// Both together. Sums wrap, which [`hashcache_core::exact::MAX_DEPOSITS`] in all keep them from.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut light = self.light;
        for (sum, more) in light.iter_mut().zip(other.light) {
            *sum = sum.wrapping_add(more);
        }
        Self { count: self.count.wrapping_add(other.count), light, squares: self.squares.wrapping_add(other.squares) }
    }

    /// What remains when a [part](Self::part) was taken away.
    #[must_use]
    pub fn minus(&self, part: &Self) -> Self {
        let mut light = self.light;
        for (sum, less) in light.iter_mut().zip(part.light) {
            *sum = sum.wrapping_sub(less);
        }
        Self { count: self.count.wrapping_sub(part.count), light, squares: self.squares.wrapping_sub(part.squares) }
    }

    /// The same mean with the weight of `count` deposits: every sum times `count`/own count, to the nearest quantum.
    /// Nothing when either is 0.
    #[must_use]
    pub fn part(&self, count: u32) -> Self {
        if count == 0 || self.count == 0 {
            return Self::default();
        }
        if count == self.count {
            return *self;
        }
        let (to, from) = (u128::from(count), u128::from(self.count));
        let light = self.light.map(|sum| ((u128::from(sum) * to + from / 2) / from) as u64);
        // Squares have up to 114 bits and counts 30: quotient and remainder apart stay within 128.
        let squares = self.squares / from * to + (self.squares % from * to + from / 2) / from;
        Self { count, light, squares }
    }

    /// All sums added, in quanta.
    pub fn energy(&self) -> u64 {
        self.light.iter().fold(0, |sum, v| sum.wrapping_add(*v))
    }

    /// Mean direct light; 0 without deposits.
    #[must_use]
    pub fn mean_direct(&self, quantum: Quantum) -> [f32; 3] {
        [0, 1, 2].map(|k| mean(quantum, self.light[k], self.count))
    }

    /// Mean further light; 0 without deposits.
    #[must_use]
    pub fn mean_further(&self, quantum: Quantum) -> [f32; 3] {
        [3, 4, 5].map(|k| mean(quantum, self.light[k], self.count))
    }

    /// Mean luminance of direct and further light together; 0 without deposits.
    ///
    /// # Units
    /// Radiance, as all light.
    #[must_use]
    pub fn mean_luminance(&self, quantum: Quantum) -> f32 {
        if self.count == 0 {
            return 0.0;
        }
        (self.luminance() as f64 / (256.0 * f64::from(self.count))) as f32 * quantum.quantum()
    }

    /// Sum of the luminances, in quantum/256: below 2⁷³.
    fn luminance(&self) -> u128 {
        let weighted =
            |k: usize| u128::from(LUMINANCE[k]) * (u128::from(self.light[k]) + u128::from(self.light[k + 3]));
        weighted(0) + weighted(1) + weighted(2)
    }

    /// Variance of one deposit's luminance, unbiased; `None` below two deposits. Meaningful where the layout has
    /// [moments](crate::layout::Layout::MOMENTS).
    ///
    /// Equal deposits give exactly 0: the squares of the deviations are taken from the whole part of the mean in
    /// integers, so nothing cancels.
    ///
    /// # Units
    /// Radiance squared. A quantum below 2⁻⁶⁰ or above 2⁶⁰ has squares that floats cannot hold: ask for the
    /// [standard error](Self::standard_error) there.
    pub fn variance(&self, quantum: Quantum) -> Option<f32> {
        let unit = quantum.quantum();
        Some(self.variance_in_quanta()? * unit * unit)
    }

    fn variance_in_quanta(&self) -> Option<f32> {
        if self.count < 2 {
            return None;
        }
        let (n, sum) = (u128::from(self.count), self.luminance());
        let (whole, rest) = (sum / n, (sum % n) as f64);
        // Σ(y − m)² = Σy² + n·m² − 2·m·Σy, below 2¹¹⁶. Rounded parts may leave it a little below 0.
        let about_whole = (self.squares + n * whole * whole).saturating_sub(2 * whole * sum);
        let n = f64::from(self.count);
        let about_mean = (about_whole as f64 - rest * (rest / n)).max(0.0);
        Some((about_mean / ((n - 1.0) * 65_536.0)) as f32)
    }

    /// Standard error of the mean luminance: √(variance/count); `None` below two deposits.
    ///
    /// # Units
    /// Radiance.
    pub fn standard_error(&self, quantum: Quantum) -> Option<f32> {
        Some(sqrt(self.variance_in_quanta()? / self.count as f32) * quantum.quantum())
    }
}
