//! From a path vertex to the cell it falls into, in integers.

use bytemuck::{Pod, Zeroable};
use hashcache_core::exact::{hi, lo, pair};
use hashcache_core::hash::{finish, mix, pcg3d, pcg4d};
use hashcache_core::level::{MAX_LEVEL, exponent};
use hashcache_core::pack::octahedral_decode_int;
use hashcache_core::record::VertexRecord;

use crate::jitter::{draw, normal_bin, path_change, tangent_offset};
use crate::params::{CELL_BITS, Params};
use crate::tag::FINGERPRINT_MAX;

/// Everything that tells cells apart (16 bytes, `HgKey` in WGSL). The table stores a hash of it.
///
/// | word | meaning |
/// |---|---|
/// | 0..3 | the cell's whole coordinates on its level, two's complement |
/// | 3 | level in bits 0..8, bin of the normal in 8..19, 1 + bin of the direction or 0 in 19..30, layer in 30..32 |
///
/// Direction and layer are 0 but for glossy layers, see [`crate::lobe`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
#[repr(C)]
pub struct Key {
    /// Whole coordinates on the cell's level, the origin's shift included.
    pub cell: [i32; 3],
    /// Level, bins of normal and direction, layer.
    pub attributes: u32,
}

/// What stands for the attributes of a vertex without a key in WGSL, where there is no `Option`.
pub const NO_KEY: u32 = u32::MAX;

impl Key {
    /// Level of the cell: its edge is 2^level times the smallest.
    pub const fn level(&self) -> u32 {
        self.attributes & 0xff
    }

    /// Bin of the normal, see [`crate::jitter::normal_bin`].
    pub const fn normal_bin(&self) -> u32 {
        (self.attributes >> 8) & 0x7ff
    }

    /// Bin of the direction from which the vertex was seen, as of a normal; `None` where it plays no part.
    pub const fn direction_bin(&self) -> Option<u32> {
        ((self.attributes >> 19) & 0x7ff).checked_sub(1)
    }

    /// Layer of the material.
    pub const fn layer(&self) -> u32 {
        self.attributes >> 30
    }

    /// The key in two words, of which the first is never all ones.
    #[inline]
    #[must_use]
    pub const fn words(self) -> [u64; 2] {
        let [x, y, z] = self.cell;
        [pair(z as u32, self.attributes), pair(x as u32, y as u32)]
    }

    /// The key of such words.
    #[inline]
    #[must_use]
    pub const fn from_words(words: [u64; 2]) -> Self {
        let cell = [lo(words[1]) as i32, hi(words[1]) as i32, lo(words[0]) as i32];
        Self { cell, attributes: hi(words[0]) }
    }

    /// Where the cell begins on each axis, in metres. For reports and pictures; inexact far from the origin.
    #[must_use]
    pub fn corner(&self, params: &Params) -> [f32; 3] {
        let size = params.cell_size(self.level());
        let shift = f64::from(origin_shift(self.level())) / 256.0;
        self.cell.map(|c| ((f64::from(c) - shift) * f64::from(size)) as f32)
    }
}

/// The key of a vertex whose draws are salted by `salt` ([`crate::jitter::SALT_DEPOSIT`] or
/// [`crate::jitter::SALT_LOOKUP`]); `None` when position or footprint is NaN or infinite, or the position beyond
/// 2⁵³ smallest cells.
///
/// The level follows from the footprint, rounded down, and is raised where a coordinate would leave 22 bits (cells
/// there would be finer than floats are). The vertex moves in its tangent plane by up to half a cell; the level
/// is taken anew at the place it moved to, and the cell is the one of that level that holds this place.
///
/// # Source
/// Binder et al. 2021, algorithm 1.
///
/// # Deviation
/// Sizes are powers of two times a power of two, so no rounding enters: the way from floats to the key is shifts,
/// additions and one exact multiplication, and gives equal bits on every machine. The level moves by at most two.
/// The normal's bin is part of the key.
#[inline]
pub fn key(params: &Params, vertex: &VertexRecord, salt: u32) -> Option<Key> {
    let [x, y, z, footprint] = vertex.position_footprint.map(f32::to_bits);
    if !has_key(params, [x, y, z], footprint) {
        return None;
    }
    let lowest = lowest_level(largest_magnitude([x, y, z]), params.base_exponent());
    let [level, size] = footprint_level(params.footprint_in_cells(footprint), lowest);

    let random = pcg3d([vertex.seed, params.seed(), salt]);
    let normal = octahedral_decode_int(vertex.normal);
    let (jitter, lean) = (params.jitter(), params.normal_jitter());
    let offset = tangent_offset(normal, draw(random[0] >> 16, jitter), draw(random[1] >> 16, jitter));
    let bin = normal_bin(normal, draw(random[2] >> 16, lean), draw(random[0], lean), params.normal_bins());

    let change = path_change(offset, octahedral_decode_int(vertex.direction));
    let there = moved_level(level, size + params.level_rate() * change, lowest);
    let scale = CELL_BITS as i32 - params.base_exponent() - there;
    let shift = origin_shift(there as u32);
    let coordinate = |x: u32, o: i32| (fixed(x, scale) + rescale(o, there - level) + shift) >> CELL_BITS;
    let cell = [coordinate(x, offset[0]), coordinate(y, offset[1]), coordinate(z, offset[2])];
    Some(Key { cell, attributes: there as u32 | (bin << 8) })
}

/// Whether a vertex with such bits of position and footprint has a key.
#[inline]
pub(crate) const fn has_key(params: &Params, place: [u32; 3], footprint: u32) -> bool {
    let largest = largest_magnitude(place);
    let lowest = lowest_level(largest, params.base_exponent());
    largest < INFINITE && footprint & MAGNITUDE < INFINITE && lowest <= MAX_LEVEL as i32
}

/// The bits of the largest coordinate, without its sign.
#[inline]
pub(crate) const fn largest_magnitude(place: [u32; 3]) -> u32 {
    let [x, y, z] = [place[0] & MAGNITUDE, place[1] & MAGNITUDE, place[2] & MAGNITUDE];
    let first = if x > y { x } else { y };
    if first > z { first } else { z }
}

/// A float's bits without the sign.
const MAGNITUDE: u32 = 0x7fff_ffff;

/// The bits of infinity; above it lies NaN.
const INFINITE: u32 = 0x7f80_0000;

/// The lowest level on which a coordinate with these bits (without sign) stays below 2³⁰ 256ths of a cell.
#[inline]
pub const fn lowest_level(magnitude: u32, base_exponent: i32) -> i32 {
    let level = (magnitude >> 23) as i32 - 148 - base_exponent;
    if level > 0 { level } else { 0 }
}

/// Level of a footprint given in smallest cells (0 or above, finite), at least `lowest`; and the footprint in cells of that level, in 2⁻²³.
#[inline]
#[must_use]
pub const fn footprint_level(cells: f32, lowest: i32) -> [i32; 2] {
    let bits = cells.to_bits();
    // What is below the normal floats is far below level 0.
    if bits < 0x0080_0000 {
        return [lowest, 0];
    }
    let exact = exponent(cells);
    let level = clamp(exact, lowest, MAX_LEVEL as i32);
    let mantissa = (bits & 0x007f_ffff) | 0x0080_0000;
    // Five bits more than the mantissa's 24 leave room for the jitter's part below 2³¹.
    [level, rescale(mantissa as i32, clamp(level - exact, -5, 31))]
}

/// The level of a footprint of `size` (in 2⁻²³ cells of `level`), within two levels of `level` and at least `lowest`.
#[inline]
pub const fn moved_level(level: i32, size: i32, lowest: i32) -> i32 {
    let size = if size > 1 { size as u32 } else { 1 };
    let moved = level + 8 - size.leading_zeros() as i32;
    let (from, to) = (clamp(level - 2, lowest, level), clamp(level + 2, level, MAX_LEVEL as i32));
    clamp(moved, from, to)
}

/// ⌊x·2^scale⌋ of a float given by its bits, for results below 2³⁰; 0 for subnormal numbers.
#[inline]
pub const fn fixed(x: u32, scale: i32) -> i32 {
    let biased = ((x >> 23) & 0xff) as i32;
    if biased == 0 {
        return 0;
    }
    let mantissa = ((x & 0x007f_ffff) | 0x0080_0000) as i32;
    let signed = if x > MAGNITUDE { -mantissa } else { mantissa };
    rescale(signed, clamp(150 - biased - scale, -6, 31))
}

/// ⌊v/2^shift⌋; negative shifts multiply.
#[inline]
pub const fn rescale(v: i32, shift: i32) -> i32 {
    if shift < 0 { v << -shift } else { v >> shift }
}

/// How far the cells' borders are shifted from the origin, in 256ths of a cell of `level`: a third of the coarsest cell
/// (modulo 2²² cells), which is one third or two thirds of a cell on every level.
///
/// # Source
/// A third is 0.010101…₂: whatever power of two it is divided by, a third or two thirds remain behind the point.
#[inline]
pub const fn origin_shift(level: u32) -> i32 {
    0x2aaa_aaaa >> (if level < 8 { level & 1 } else { level - 8 })
}

/// How many whole cells the cells of the level above `level` are counted from farther on, beside half their index: what
/// the modulo of [`origin_shift`] leaves.
#[inline]
pub const fn coarser_offset(level: u32) -> i32 {
    (origin_shift(level + 1) - (origin_shift(level) >> 1)) >> CELL_BITS
}

/// The key of the cell on the next level that holds this cell, up to a 256th of its edge; `None` on [`MAX_LEVEL`].
///
/// ```
/// # use hashgrid::{Key, key::{coarser, finer}};
/// let key = Key { cell: [5, -3, 0], attributes: 9 | (4 << 8) };
/// assert_eq!(coarser(&key).unwrap().cell, [2, -2, 0]);
/// assert_eq!(finer(&coarser(&key).unwrap(), 0b011), Some(key)); // odd x, odd y, even z
/// ```
#[inline]
#[must_use]
pub const fn coarser(key: &Key) -> Option<Key> {
    let level = key.level();
    if level >= MAX_LEVEL {
        return None;
    }
    let ([x, y, z], off) = (key.cell, coarser_offset(level));
    Some(Key { cell: [(x >> 1) + off, (y >> 1) + off, (z >> 1) + off], attributes: key.attributes + 1 })
}

/// The key of one of the eight cells of the next finer level inside this cell, up to a 256th of its edge: `octant` has
/// a bit for x, y, z (from the lowest) that chooses the upper half. `None` on level 0.
#[inline]
#[must_use]
pub const fn finer(key: &Key, octant: u32) -> Option<Key> {
    let level = key.level();
    if level == 0 {
        return None;
    }
    let ([x, y, z], off) = (key.cell, coarser_offset(level - 1));
    let [a, b, c] = [(octant & 1) as i32, ((octant >> 1) & 1) as i32, ((octant >> 2) & 1) as i32];
    let cell = [2 * (x - off) + a, 2 * (y - off) + b, 2 * (z - off) + c];
    Some(Key { cell, attributes: key.attributes - 1 })
}

/// The hash whose low bits are the slot a key begins at.
#[inline]
pub const fn home(key: &Key) -> u32 {
    let [x, y, z] = key.cell;
    pcg4d([x as u32, y as u32, z as u32, key.attributes])[3]
}

/// The second hash, of another family, cut to the bits that a tag holds; never all ones.
///
/// # Source
/// Binder et al. 2021, section 3.2.1.
#[inline]
pub const fn fingerprint(key: &Key) -> u32 {
    let [x, y, z] = key.cell;
    let h = mix(mix(mix(mix(0x5bd1_e995, x as u32), y as u32), z as u32), key.attributes);
    let bits = finish(h) >> 7;
    if bits > FINGERPRINT_MAX { FINGERPRINT_MAX } else { bits }
}

const fn clamp(v: i32, low: i32, high: i32) -> i32 {
    if v < low {
        low
    } else if v > high {
        high
    } else {
        v
    }
}
