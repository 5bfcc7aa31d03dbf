//! What is kept of a path vertex until the end of a frame.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::block::morton;
use super::grid::Grid;
use super::params::{Light, OctreeParams};
use crate::counters::Counters;
use crate::exact::{Outcome, Quantized, hi, lo, pair, quantize};
use crate::record::VertexRecord;

/// Bits of [`Grid::coordinates`] along an axis.
const PLACE_BITS: u32 = 17;

/// Bits of a key for each axis.
const KEY_BITS: u32 = 8;

/// The key of what is not kept: behind all others.
pub const NO_SAMPLE: u32 = 1 << (3 * KEY_BITS);

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

    /// Whether there is one.
    #[inline]
    pub const fn is_kept(&self) -> bool {
        self.place[1] != 0
    }

    /// The cell of the finest level that holds it.
    #[inline]
    pub fn place(&self) -> [u32; 3] {
        let packed = pair(self.place[0], self.place[1]);
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

/// A key by which samples that are near in space are near in order: a Morton code of 8 bits an axis.
///
/// Samples in this order meet cells, and parents of cells, in nearly the order in which these stand in memory.
#[inline]
pub fn sample_key(grid: &Grid, place: [u32; 3]) -> u32 {
    let shift = (grid.resolution.ilog2()).saturating_sub(KEY_BITS);
    let most = (1 << KEY_BITS) - 1;
    let axis = |k: usize| (place[k].saturating_sub(grid.corner[k]) >> shift).min(most);
    morton(super::block::block_key([axis(0), axis(1), axis(2)]))
}

/// What a frame keeps of vertices, in order: `keep(i, key, sample)`. [`NO_SAMPLE`] and an empty sample for those that are
/// not recorded.
///
/// A vertex outside the octree's cube is refused and counted; all others count as stored from here on.
pub fn sample_vertices(
    grid: &Grid,
    params: &OctreeParams,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut keep: impl FnMut(usize, u32, Sample),
) {
    for (i, vertex) in vertices.iter().enumerate() {
        let mut kept = None;
        if vertex.is_recordable() {
            let [x, y, z, _] = vertex.position_footprint;
            let place = grid.coordinates(Vec3::new(x, y, z));
            let values = quantize_vertex(params, vertex);
            counters.deposits += 1;
            counters.refusals += u64::from(place.is_none());
            note_all(&values, place.is_some(), counters);
            let sums = [0, 1, 2].map(|c| values[c].value + values[3 + c].value);
            kept = place.map(|place| (sample_key(grid, place), Sample::new(place, sums, vertex.normal)));
        }
        let (key, sample) = kept.unwrap_or((NO_SAMPLE, Sample::zeroed()));
        keep(i, key, sample);
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
