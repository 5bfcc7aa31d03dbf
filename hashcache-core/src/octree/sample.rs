//! What is kept of a path vertex until the end of a frame.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::block::{block_key, morton};
use super::grid::Grid;
use super::params::{Light, OctreeParams};
use crate::counters::Counters;
use crate::exact::{Outcome, Quantized, hi, lo, pair, quantize};
use crate::record::VertexRecord;

/// Bits of [`Grid::coordinates`] along an axis.
const PLACE_BITS: u32 = 17;

/// Bits of a key for each axis.
const KEY_BITS: u32 = 10;

/// The key of what is not kept: behind all others.
pub const NO_SAMPLE: u32 = u32::MAX;

/// A vertex's place, side and light in 24 bytes.
///
/// | words | meaning |
/// |---|---|
/// | 0..3 | sums of red, green, blue in quanta: the low words |
/// | 3, 4 | a 64-bit number, low word first: coordinates x, y, z of the finest level in bits 0..17, 17..34, 34..51; the sums' high words in bits 51..54, 54..57, 57..60; bit 60 is set |
/// | 5 | normal, octahedral |
///
/// All words are 0 where nothing is kept. A sum is that of two clamped numbers at most, 2³⁴ quanta.
///
/// Example: x = 5, y = 1, z = 0, and red of 2³² + 7 quanta: word 0 is 7, and the 64-bit number
///
/// ```text
/// 1 000 000 001 00000000000000000 00000000000000001 00000000000000101 = 0x1008_0000_0002_0005
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Sample {
    low: [u32; 3],
    place: [u32; 2],
    normal: u32,
}

impl Sample {
    /// A sample of its parts: `place` in cells of the finest level, `sums` in quanta.
    pub fn new(place: [u32; 3], sums: [u64; 3], normal: u32) -> Self {
        let mut packed = 1 << 60;
        for axis in 0..3 {
            packed |= u64::from(place[axis]) << (PLACE_BITS * axis as u32);
            packed |= u64::from(hi(sums[axis])) << (3 * PLACE_BITS + 3 * axis as u32);
        }
        Self { low: sums.map(lo), place: [lo(packed), hi(packed)], normal }
    }

    #[inline]
    const fn packed(&self) -> u64 {
        pair(self.place[0], self.place[1])
    }

    /// Whether there is one.
    #[inline]
    pub const fn is_kept(&self) -> bool {
        self.place[1] != 0
    }

    /// The cell of the finest level that holds it.
    #[inline]
    pub fn place(&self) -> [u32; 3] {
        let packed = self.packed();
        [0, 1, 2].map(|axis| (packed >> (PLACE_BITS * axis)) as u32 & ((1 << PLACE_BITS) - 1))
    }

    /// Its light in quanta.
    #[inline]
    pub fn sums(&self) -> [u64; 3] {
        let high = self.place[1] >> (3 * PLACE_BITS - 32);
        core::array::from_fn(|c| pair(self.low[c], (high >> (3 * c)) & 7))
    }

    /// The normal on the side that it lies on, octahedral.
    #[inline]
    pub const fn normal(&self) -> u32 {
        self.normal
    }
}

/// Whether two samples lie in the same cell of a level. What is not kept shares a cell with nothing that is.
#[inline]
pub(crate) const fn same_cell(a: &Sample, b: &Sample, level: u32) -> bool {
    // The coordinates above their low `level` bits, and the bit of what is kept.
    let axis = (1_u64 << PLACE_BITS) - (1 << level);
    let mask = axis | (axis << PLACE_BITS) | (axis << (2 * PLACE_BITS)) | (1 << 60);
    (a.packed() ^ b.packed()) & mask == 0
}

/// How many keys tell the cells of the finest level apart: keys of 10 bits an axis.
pub const fn sample_keys(grid: &Grid) -> u32 {
    if grid.levels - 1 > KEY_BITS { 2 } else { 1 }
}

/// Part `part` of a sample's key; sorted by part 0, then (keeping the order of equals) by the next, samples of a cell of
/// any level stand together: all parts are a Morton code of the place. [`NO_SAMPLE`] for what is not kept.
///
/// Samples in this order meet cells, and parents of cells, in the order in which these stand in memory.
///
/// ```
/// use hashcache_core::glam::Vec3;
/// use hashcache_core::octree::{Grid, NO_SAMPLE, Sample, sample_key, sample_keys};
///
/// let grid = Grid::new(Vec3::ZERO, Vec3::ONE, 1024)?;
/// let sample = Sample::new([3, 0, 1], [0; 3], 0);
/// assert_eq!(sample_keys(&grid), 2); // 2048 cells along the cube take 11 bits: one in part 0, ten in part 1
/// assert_eq!((sample_key(&grid, &sample, 0), sample_key(&grid, &sample, 1)), (0b101, 0b001));
/// assert_eq!(sample_key(&grid, &bytemuck::Zeroable::zeroed(), 0), NO_SAMPLE);
/// # Ok::<(), hashcache_core::error::ParamError>(())
/// ```
#[inline]
pub fn sample_key(grid: &Grid, sample: &Sample, part: u32) -> u32 {
    if !sample.is_kept() {
        return NO_SAMPLE;
    }
    let low = (grid.levels - 1).saturating_sub(KEY_BITS);
    let last = sample_keys(grid) - 1;
    let place = sample.place();
    let bits = if part < last { place.map(|c| c & ((1 << low) - 1)) } else { place.map(|c| c >> low) };
    morton(block_key(bits))
}

/// What a frame keeps of vertices, in order: `keep(i, sample)`, with an empty sample for those that are not recorded.
///
/// A vertex outside the octree's cube is refused and counted; all others count as stored from here on.
pub fn sample_vertices(
    grid: &Grid,
    params: &OctreeParams,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut keep: impl FnMut(usize, Sample),
) {
    for (i, vertex) in vertices.iter().enumerate() {
        let mut sample = Sample::zeroed();
        if vertex.is_recordable() {
            let [x, y, z, _] = vertex.position_footprint;
            let place = grid.coordinates(Vec3::new(x, y, z));
            let values = quantize_vertex(params, vertex);
            counters.deposits += 1;
            counters.refusals += u64::from(place.is_none());
            note_all(&values, place.is_some(), counters);
            let sums = [0, 1, 2].map(|c| values[c].value + values[3 + c].value);
            sample = place.map_or(sample, |place| Sample::new(place, sums, vertex.normal));
        }
        keep(i, sample);
    }
}

/// The light of a vertex that a cache holds, in quanta: direct red, green, blue (0 where only further light is
/// recorded), further red, green, blue.
#[inline]
fn quantize_vertex(params: &OctreeParams, vertex: &VertexRecord) -> [Quantized; 6] {
    let q = params.quantum();
    let ([a, b, c, _], [d, e, f, _]) = (vertex.direct, vertex.further);
    let [a, b, c] = match params.light() {
        Light::All => [quantize(q, a), quantize(q, b), quantize(q, c)],
        Light::Further => [Quantized { value: 0, lost: 0, outcome: Outcome::Exact }; 3],
    };
    [a, b, c, quantize(q, d), quantize(q, e), quantize(q, f)]
}

/// [`Counters::note`] for all channels of a vertex.
#[inline]
fn note_all(values: &[Quantized; 6], stored: bool, counters: &mut Counters) {
    if values.iter().all(|value| value.outcome == Outcome::Exact) {
        // Nearly always, and then there is one number to add: six of 2³³ at most.
        let energy = values.iter().map(|value| value.value).sum();
        counters.note(&Quantized { value: energy, lost: 0, outcome: Outcome::Exact }, stored);
        return;
    }
    for value in values {
        counters.note(value, stored);
    }
}
