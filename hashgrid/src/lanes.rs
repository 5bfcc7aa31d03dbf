//! Keys of many vertices at once: [`crate::key::key`] without branches and integer divisions, over arrays.
//!
//! Compilers turn the loops into vector instructions, four vertices at a time where there is nothing newer than SSE2.
//! That has no integer division, no shift by a different number in each lane, no cheap integer product and no cast from
//! floats that Rust's own, which saturates, would become; floats have what stands for each. All of it is exact, for these
//! reasons:
//!
//! - Whole numbers below 2²⁴ are floats, so are their sums and products below that.
//! - The quotient p/q of whole numbers, |p| < 2²⁴, rounded to a float and then cut, is the integer quotient: if it is not
//!   whole, it is at least 1/|q| away from a whole number, and rounding moves it by at most |p/q|·2⁻²⁴ < 1/|q|.
//! - A power of two as a factor is a shift.

use hashcache_core::hash::pcg3d;
use hashcache_core::jitter::draw;
use hashcache_core::level::MAX_LEVEL;
use hashcache_core::pack::{OCTAHEDRAL_ONE, octahedral_decode_int};
use hashcache_core::record::VertexRecord;

use crate::batch::BATCH;
use crate::key::{Key, has_key, largest_magnitude, lowest_level, origin_shift};
use crate::params::{CELL_BITS, Params};

/// What a key depends on, an array for each field; 0 throughout for what has no key.
struct Fields {
    /// Bits of the position.
    place: [[u32; BATCH]; 3],
    /// Bits of the footprint.
    footprint: [u32; BATCH],
    normal: [u32; BATCH],
    direction: [u32; BATCH],
    seed: [u32; BATCH],
}

/// The keys of up to [`BATCH`] vertices, `None` for those that are not valid or have no key.
#[inline]
pub(crate) fn keys(params: &Params, vertices: &[VertexRecord], salt: u32) -> [Option<Key>; BATCH] {
    let none = [0; BATCH];
    let mut fields = Fields { place: [none; 3], footprint: none, normal: none, direction: none, seed: none };
    let mut has = [false; BATCH];
    for (i, vertex) in vertices.iter().enumerate().take(BATCH) {
        let [x, y, z, footprint] = vertex.position_footprint.map(f32::to_bits);
        has[i] = vertex.flags & VertexRecord::VALID != 0 && has_key(params, [x, y, z], footprint);
        if has[i] {
            (fields.place[0][i], fields.place[1][i], fields.place[2][i]) = (x, y, z);
            fields.footprint[i] = footprint;
            (fields.normal[i], fields.direction[i], fields.seed[i]) = (vertex.normal, vertex.direction, vertex.seed);
        }
    }
    // Whole vectors: what is left over would be taken one by one.
    let count = vertices.len().next_multiple_of(8).min(BATCH);
    let (mut cells, mut offsets) = ([none; 3], [[0.0; BATCH]; 3]);
    let (mut bins, mut changes) = (none, [0; BATCH]);
    let (mut levels, mut raised) = ([0; BATCH], [0; BATCH]);
    // In several loops, each so short that a core looks ahead over a few of its rounds: while one waits for a division, the
    // next goes on.
    for i in 0..count {
        let random = pcg3d([fields.seed[i], params.seed(), salt]);
        ([offsets[0][i], offsets[1][i], offsets[2][i]], bins[i]) = moved_normal(params, fields.normal[i], random);
    }
    for i in 0..count {
        let offset = [offsets[0][i], offsets[1][i], offsets[2][i]];
        changes[i] = whole(path_change(offset, octahedral_decode_int(fields.direction[i])));
    }
    for i in 0..count {
        let largest = largest_magnitude([fields.place[0][i], fields.place[1][i], fields.place[2][i]]);
        let lowest = lowest_level(largest, params.base_exponent());
        let [level, size] = footprint_level(params.footprint_in_cells(fields.footprint[i]), lowest);
        levels[i] = moved_level(level, size + params.level_rate() * changes[i], lowest);
        raised[i] = levels[i] - level;
    }
    for i in 0..count {
        let scale = f64::from(power(CELL_BITS as i32 - params.base_exponent() - levels[i]));
        let (rescale, shift) = (power(-raised[i]), origin_shift(levels[i] as u32));
        for axis in 0..3 {
            let offset = whole(lowered(offsets[axis][i] * rescale, 2));
            cells[axis][i] = (fixed(fields.place[axis][i], scale) + offset + shift) as u32;
        }
    }
    core::array::from_fn(|i| {
        let cell = [cells[0][i], cells[1][i], cells[2][i]].map(|c| c as i32 >> CELL_BITS);
        has[i].then(|| Key { cell, attributes: levels[i] as u32 | (bins[i] << 8) })
    })
}

/// The way that a vertex moves in its tangent plane, and the bin of its normal.
#[inline(always)]
fn moved_normal(params: &Params, normal: u32, random: [u32; 3]) -> ([f32; 3], u32) {
    let normal = octahedral_decode_int(normal).map(|c| c as f32);
    let axis = Axis::of(normal);
    let [a, b, c] = axis.turn(normal);
    let (jitter, lean) = (params.jitter(), params.normal_jitter());
    let [u, v] = [draw(random[0] >> 16, jitter) as f32, draw(random[1] >> 16, jitter) as f32];
    // |b·u + c·v| ≤ 2·|a|·128 < 2²³.
    let offset = axis.turn_back([-cut((b * u + c * v) / a), u, v]);
    let lean = [draw(random[2] >> 16, lean), draw(random[0], lean)];
    (offset, normal_bin(axis, [a, b, c], lean, params.normal_bins()))
}

/// 2^`exponent`, for exponents of normal floats.
#[inline(always)]
const fn power(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// Added to this float, a number below 2²² in magnitude is rounded to a whole one, which its last bits hold.
const ONES: f32 = 12_582_912.0;

/// A whole number below 2²² in magnitude as an integer.
#[inline(always)]
const fn whole(x: f32) -> i32 {
    (x + ONES).to_bits() as i32 - ONES.to_bits() as i32
}

/// What rounds to the next whole number downwards from `x`, a multiple of 2⁻`bits` below 2¹³ in magnitude; `bits` of at
/// most 10.
#[inline(always)]
const fn lowered(x: f32, bits: u32) -> f32 {
    x - (0.5 - 0.5 / (1 << bits) as f32)
}

/// The next whole number downwards from 0 or above, below 2²².
#[inline(always)]
const fn below(x: f32) -> f32 {
    let nearest = x + ONES - ONES;
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// A number below 2²² in magnitude without what is behind its point.
#[inline(always)]
const fn cut(x: f32) -> f32 {
    below(x.abs()).copysign(x)
}

/// The largest component of three: [`hashcache_core::jitter::max_component`] as two answers.
#[derive(Clone, Copy)]
struct Axis {
    is_x: bool,
    is_y: bool,
}

impl Axis {
    #[inline(always)]
    const fn of(v: [f32; 3]) -> Self {
        let [x, y, z] = [v[0].abs(), v[1].abs(), v[2].abs()];
        let is_x = x >= y && x >= z;
        Self { is_x, is_y: !is_x && y >= z }
    }

    #[inline(always)]
    fn choose<T>(self, x: T, y: T, z: T) -> T {
        let rest = if self.is_y { y } else { z };
        if self.is_x { x } else { rest }
    }

    /// 0, 1 or 2.
    #[inline(always)]
    fn index(self) -> f32 {
        self.choose(0.0, 1.0, 2.0)
    }

    /// [`hashcache_core::jitter::turn`].
    #[inline(always)]
    fn turn<T: Copy>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        [self.choose(x, y, z), self.choose(y, z, x), self.choose(z, x, y)]
    }

    /// [`hashcache_core::jitter::turn_back`].
    #[inline(always)]
    fn turn_back<T: Copy>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        [self.choose(a, c, b), self.choose(b, a, c), self.choose(c, b, a)]
    }
}

/// [`crate::jitter::normal_bin`] of a normal that was turned to `axis` already.
#[inline(always)]
fn normal_bin(axis: Axis, [a, b, c]: [f32; 3], lean: [i32; 2], bins: u32) -> u32 {
    // Compilers are told that both factors are halves of words, for whose products there is an instruction.
    let m = whole(a.abs()) & 0x7fff;
    let leant = |t: f32, by: i32| t + ((m * by as i16 as i32) >> 15) as f32;
    let moved = [a, leant(b, lean[0]), leant(c, lean[1])];
    let beyond = Axis::of(moved);
    let [a, b, c] = beyond.turn(moved);
    let (m, bins) = (a.abs(), bins as f32);
    // At most 2·65534·15 < 2²¹ above the line.
    let part = |t: f32| lesser(below((t + m) * bins / (2.0 * m)), bins - 1.0);
    let turns = axis.index() + beyond.index();
    let face = 2.0 * (turns - if turns >= 3.0 { 3.0 } else { 0.0 }) + if a < 0.0 { 1.0 } else { 0.0 };
    whole((face * bins + part(b)) * bins + part(c)) as u32
}

/// [`crate::jitter::path_change`].
#[inline(always)]
fn path_change(offset: [f32; 3], direction: [i32; 3]) -> f32 {
    let d = direction.map(|c| c as f32);
    // The direction's components add up to 32767 and the offset's are at most 256: below 2²³.
    let dot = offset[0] * d[0] + offset[1] * d[1] + offset[2] * d[2];
    let [x, y, z] = d.map(f32::abs);
    let largest = greater(x, greater(y, z));
    let smallest = lesser(x, lesser(y, z));
    let middle = OCTAHEDRAL_ONE as f32 - largest - smallest;
    // 962 = 1024 − 62, since 962 times the largest is no float.
    let rest = 399.0 * middle + 306.0 * smallest - 62.0 * largest;
    cut(dot / (largest + (lowered(rest / 1024.0, 10) + ONES - ONES)))
}

/// As `max`, but for NaN: one instruction.
#[inline(always)]
const fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// As `min`, but for NaN: one instruction.
#[inline(always)]
const fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// [`crate::key::footprint_level`].
#[inline(always)]
fn footprint_level(cells: f32, lowest: i32) -> [i32; 2] {
    let bits = cells.to_bits() as i32;
    let exact = (bits >> 23) - 127;
    let level = exact.max(lowest).min(MAX_LEVEL as i32);
    let mantissa = (bits & 0x007f_ffff) | 0x0080_0000;
    [level, (mantissa << 5) >> (level - exact + 5).clamp(0, 31)]
}

/// [`crate::key::moved_level`].
#[inline(always)]
fn moved_level(level: i32, size: i32, lowest: i32) -> i32 {
    let size = size.max(1);
    // Without the bits that could round it up to the next power of two.
    let exponent = (((size & !(size >> 8)) as f32).to_bits() >> 23) as i32 - 127;
    let (from, to) = ((level - 2).max(lowest), (level + 2).min(MAX_LEVEL as i32));
    (level + exponent - 23).max(from).min(to)
}

/// [`crate::key::fixed`] with the power of two itself.
#[inline(always)]
fn fixed(x: u32, scale: f64) -> i32 {
    /// [`ONES`] for numbers below 2⁵¹ in magnitude.
    const WIDE_ONES: f64 = 6_755_399_441_055_744.0;
    let normal = if x & 0x7f80_0000 == 0 { 0 } else { x };
    let exact = f64::from(f32::from_bits(normal)) * scale;
    let nearest = exact + WIDE_ONES;
    let above = nearest - WIDE_ONES > exact;
    nearest.to_bits() as i32 - i32::from(above)
}

#[cfg(test)]
mod tests;
