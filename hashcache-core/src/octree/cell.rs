//! What a cell holds, in two layouts.

use core::mem::offset_of;

use bytemuck::{Pod, Zeroable};

use crate::exact::{MAX_DEPOSITS, Quantum};
use crate::hash::to_unit_f32;
use crate::level::exponent;
use crate::pack::{half_from_f32, half_to_f32};

/// How many bits a cell's means have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Layout {
    /// [`ExactCell`], 48 bytes: f32 means and scatter, 2³⁰ samples a side.
    #[default]
    Exact,
    /// [`PaperCell`], 24 bytes: half float means without their scatter, 65535 samples a side.
    Paper,
}

impl Layout {
    /// Bytes of a cell.
    pub const fn cell_bytes(self) -> u32 {
        match self {
            Self::Exact => size_of::<ExactCell>() as u32,
            Self::Paper => size_of::<PaperCell>() as u32,
        }
    }
}

/// The side of a cell that its normal points to.
pub const FRONT: usize = 0;

/// The other side.
pub const BACK: usize = 1;

/// The running mean of one side of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side {
    /// Mean illumination: red, green, blue.
    pub mean: [f32; 3],
    /// Samples behind it, up to [`CellRecord::MAX_COUNT`] or less by `max_samples` of the settings.
    pub count: u32,
}

/// A number in two parts: a float and what rounding left out of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sum {
    /// The nearest float.
    pub value: f32,
    /// The rest, at most half a unit in the last place of `value`.
    pub rest: f32,
}

impl Sum {
    /// `a + b` without loss.
    ///
    /// # Source
    /// Knuth 1997, section 4.2.2, theorem B.
    #[inline]
    pub fn new(a: f32, b: f32) -> Self {
        let value = a + b;
        let added = value - a;
        Self { value, rest: (a - (value - added)) + (b - added) }
    }

    /// One of the two neighbouring floats, by chance, such that the expected value is exact. `random` decides.
    ///
    /// # Source
    /// Connolly, Higham & Mary 2021 (stochastic rounding, mode 1).
    #[inline]
    pub fn dither(self, random: u32) -> f32 {
        let Self { value, rest } = self;
        let step = if rest > 0.0 { 1 } else { u32::MAX };
        let beyond = f32::from_bits(value.to_bits().wrapping_add(step));
        // False where nothing is left out.
        let moves = rest.abs() > (beyond - value).abs() * to_unit_f32(random) && value > 0.0;
        if moves { beyond } else { value }
    }

    /// The same among half floats, for a number from 0 to 65504: its 16 bits.
    #[inline]
    pub fn dither_half(self, random: u32) -> u32 {
        let v = self.value.clamp(0.0, 65_504.0);
        // A half float's last bit: 2^(e − 10), and 2⁻²⁴ below 2⁻¹⁴. Products with powers of two are exact.
        let last = exponent(v).clamp(-14, 15) - 10;
        let scaled = v * power_of_two(-last);
        let low = scaled as u32;
        let up = scaled - low as f32 > to_unit_f32(random);
        half_from_f32(((low + u32::from(up)) as f32 * power_of_two(last)).to_bits())
    }
}

/// 2^`exponent` for the exponents of normal floats.
#[inline]
const fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// A cell's record in a buffer: two sides, a normal, and the frame of the last wipe.
///
/// # Laws
/// `put` then `side` returns the count and, within the layout's precision, the means. The other side stays as it is.
pub trait CellRecord: Pod {
    /// Words of a record.
    const WORDS: usize = size_of::<Self>() / 4;

    /// Which word is the normal.
    const NORMAL_WORD: usize;

    /// Largest count of a side.
    const MAX_COUNT: u32;

    /// A cell without samples. `normal` is octahedral.
    fn empty(normal: u32, wiped: u32) -> Self;

    /// The normal that tells front from back, octahedral.
    fn normal(&self) -> u32;

    /// Index of the frame in which the cell was emptied.
    fn wiped(&self) -> u32;

    /// One side's mean; `side` is [`FRONT`] or [`BACK`].
    fn side(&self, side: usize, quantum: Quantum) -> Side;

    /// Replaces one side's mean. `random` decides how it is rounded, a word a channel.
    fn put(&mut self, side: usize, quantum: Quantum, mean: [Sum; 3], count: u32, random: [u32; 3]);

    /// Root of the mean square of one side's samples' luminance, in radiance; `None` in layouts that do not keep it.
    #[inline]
    fn root_mean_square(&self, side: usize) -> Option<f32> {
        let _ = side;
        None
    }

    /// Replaces it, in layouts that keep it.
    #[inline]
    fn put_root_mean_square(&mut self, side: usize, value: f32) {
        let _ = (side, value);
    }
}

/// Layout [`Layout::Exact`].
///
/// | bytes | field | meaning |
/// |---|---|---|
/// | 0..12 | `means[0]` | front: red, green, blue |
/// | 12..24 | `means[1]` | back: red, green, blue |
/// | 24..32 | `counts` | samples: front, back |
/// | 32..36 | `normal` | octahedral, see [`crate::pack`] |
/// | 36..40 | `wiped` | frame of the last wipe |
/// | 40..48 | `scatter` | root mean square of luminance: front, back |
///
/// The root and not the square, so that it has the means' range; and rounded to nearest: it says how noisy a mean is,
/// for which three digits do.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ExactCell {
    /// Means of both sides, in radiance.
    pub means: [[f32; 3]; 2],
    /// Samples of both sides.
    pub counts: [u32; 2],
    /// The normal of the cell's largest triangle, octahedral.
    pub normal: u32,
    /// Frame of the last wipe.
    pub wiped: u32,
    /// Root mean squares of both sides' luminance, in radiance.
    pub scatter: [f32; 2],
}

impl CellRecord for ExactCell {
    const NORMAL_WORD: usize = offset_of!(Self, normal) / 4;
    const MAX_COUNT: u32 = MAX_DEPOSITS;

    fn empty(normal: u32, wiped: u32) -> Self {
        Self { means: [[0.0; 3]; 2], counts: [0; 2], normal, wiped, scatter: [0.0; 2] }
    }

    #[inline]
    fn normal(&self) -> u32 {
        self.normal
    }

    #[inline]
    fn wiped(&self) -> u32 {
        self.wiped
    }

    #[inline]
    fn side(&self, side: usize, _: Quantum) -> Side {
        Side { mean: self.means[side], count: self.counts[side] }
    }

    #[inline]
    fn put(&mut self, side: usize, _: Quantum, mean: [Sum; 3], count: u32, random: [u32; 3]) {
        self.means[side] = core::array::from_fn(|c| mean[c].dither(random[c]));
        self.counts[side] = count;
    }

    #[inline]
    fn root_mean_square(&self, side: usize) -> Option<f32> {
        Some(self.scatter[side])
    }

    #[inline]
    fn put_root_mean_square(&mut self, side: usize, value: f32) {
        self.scatter[side] = value;
    }
}

/// Layout [`Layout::Paper`].
///
/// | bytes | field | bits 0..16 | bits 16..32 |
/// |---|---|---|---|
/// | 0..4 | `halves[0]` | front red | front green |
/// | 4..8 | `halves[1]` | front blue | back red |
/// | 8..12 | `halves[2]` | back green | back blue |
/// | 12..16 | `normal` | octahedral x | octahedral y |
/// | 16..20 | `counts` | front samples | back samples |
/// | 20..24 | `wiped` | frame of the last wipe | (32 bits) |
///
/// Means are half floats in units of L0 (see [`Quantum`]), so that their range, 2⁻²⁴ to 65504, lies where the sums'
/// does. Beyond 65535 samples a side is a moving average.
///
/// # Drift
/// Error of the mean after frames of four samples of path traced light (mostly dark, now and then bright), root mean
/// square of 16 runs. Rounding to nearest, as in the paper, a mean stops moving once a frame's share is below half of its
/// last bit, and does so early where light is mostly dark; rounding by chance ([`Sum::dither_half`]) leaves noise
/// instead, which does not grow with time.
///
/// | frames | `paper` | the same, rounded to nearest | `exact` |
/// |---|---|---|---|
/// | 16 | 0.06 % | 0.04 % | 0.00001 % |
/// | 256 | 0.17 % | 0.12 % | 0.00003 % |
/// | 4096 | 0.89 % | 6.1 % | 0.0001 % |
/// | 16384 | 0.79 % | 10.3 % | |
///
/// Example: a back of (1.5, −, 0.25)·L0 with 3 samples, front empty. 1.5 is `0x3e00`, 0.25 is `0x3400`:
///
/// ```text
/// halves[1] = 0011_1110_0000_0000 0000_0000_0000_0000 = 0x3e00_0000
/// halves[2] = 0011_0100_0000_0000 0000_0000_0000_0000 = 0x3400_0000
/// counts    = 0000_0000_0000_0011 0000_0000_0000_0000 = 0x0003_0000
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct PaperCell {
    /// Six half floats.
    pub halves: [u32; 3],
    /// The normal of the cell's largest triangle, octahedral.
    pub normal: u32,
    /// Samples of both sides.
    pub counts: u32,
    /// Frame of the last wipe.
    pub wiped: u32,
}

impl CellRecord for PaperCell {
    const NORMAL_WORD: usize = offset_of!(Self, normal) / 4;
    const MAX_COUNT: u32 = 0xffff;

    fn empty(normal: u32, wiped: u32) -> Self {
        Self { halves: [0; 3], normal, counts: 0, wiped }
    }

    #[inline]
    fn normal(&self) -> u32 {
        self.normal
    }

    #[inline]
    fn wiped(&self) -> u32 {
        self.wiped
    }

    #[inline]
    fn side(&self, side: usize, quantum: Quantum) -> Side {
        let mean = |c: usize| {
            let k = 3 * side + c;
            let half = (self.halves[k / 2] >> (16 * (k % 2))) & 0xffff;
            f32::from_bits(half_to_f32(half)) * quantum.l0()
        };
        Side { mean: [mean(0), mean(1), mean(2)], count: (self.counts >> (16 * side)) & 0xffff }
    }

    #[inline]
    fn put(&mut self, side: usize, quantum: Quantum, mean: [Sum; 3], count: u32, random: [u32; 3]) {
        let unit = power_of_two(-quantum.l0_exponent());
        let set = |word: &mut u32, shift: usize, v: u32| *word = (*word & !(0xffff << shift)) | (v << shift);
        for c in 0..3 {
            let (k, Sum { value, rest }) = (3 * side + c, mean[c]);
            let half = Sum { value: value * unit, rest: rest * unit }.dither_half(random[c]);
            set(&mut self.halves[k / 2], 16 * (k % 2), half);
        }
        set(&mut self.counts, 16 * side, count);
    }
}

const _: () = assert!(size_of::<ExactCell>() == 48 && size_of::<PaperCell>() == 24);
