//! The end of a frame: sorted samples are summed cell by cell, and the sums merged into the cells of a level.

use core::ops::Range;

use super::cell::{BACK, CellRecord, FRONT, Side, Sum};
use super::cells::{ReadCells, SharedCells};
use super::params::OctreeParams;
use super::sample::{Sample, same_cell};
use super::view::{NO_CELL, Octree};
use crate::counters::Counters;
use crate::exact::{Quantum, mean};
use crate::float;
use crate::hash::pcg4d;
use crate::pack::octahedral_decode_int;

/// Most samples of a frame: sums of two clamped values each, 2³⁴ quanta, stay below 2⁶⁴.
pub const MAX_SAMPLES: u32 = 1 << 28;

/// Cells and lookups that are worked on together, so that their cache misses overlap: each step is a loop of its own,
/// since only so close together do they. More than the misses that a core keeps in flight gains nothing.
pub(crate) const BATCH: usize = 16;

/// Which side of a surface with normal `normal` (decoded) the direction `n` (octahedral) points to.
#[inline]
pub(crate) const fn side_of(normal: [i32; 3], n: u32) -> usize {
    let ([a, b, c], [x, y, z]) = (normal, octahedral_decode_int(n));
    // At most 32767² in magnitude, whatever the order of additions.
    if a * x + b * y + c * z >= 0 { FRONT } else { BACK }
}

/// The samples of one cell: a run of the sorted samples.
#[derive(Clone, Copy, Default)]
struct Run {
    start: usize,
    end: usize,
}

/// Merges a frame's samples into the cells of a level: those of all cells whose first sample is one of `items`.
///
/// `samples` are in the order of their [places](super::sample_key), kept ones first. A frame ends by this for every level,
/// in any order: any number of threads may merge parts of `0..samples.len()`. A cell is written by one thread
/// and from exact sums, so it gets the same bits for any number of threads and any order of equal places.
///
/// Each sample goes to the side of the cell that its own normal points to, on every level as lookups do. One whose finest
/// level has no cell there (rounding may move a vertex off its surface) is found on the coarser ones, counted in
/// [`Counters::coarser`].
pub fn merge_samples<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &SharedCells<'_, C>,
    params: &OctreeParams,
    level: u32,
    samples: &[Sample],
    items: Range<u32>,
    counters: &mut Counters,
) {
    let last = (items.end as usize).min(samples.len());
    let mut next = items.start as usize;
    // A run that began before belongs to whoever has its first sample.
    if next > 0 {
        while next < last && same_cell(&samples[next - 1], &samples[next], level) {
            next += 1;
        }
    }
    while next < last && samples[next].is_kept() {
        let mut runs = [Run::default(); BATCH];
        let mut places = [[0; 3]; BATCH];
        let mut found = 0;
        while found < BATCH && next < last && samples[next].is_kept() {
            let start = next;
            next += 1;
            while next < samples.len() && same_cell(&samples[start], &samples[next], level) {
                next += 1;
            }
            runs[found] = Run { start, end: next };
            places[found] = samples[start].place().map(|c| c >> level);
            found += 1;
        }
        merge_runs(octree, cells, params, level, samples, &runs[..found], &places[..found], counters);
    }
}

#[expect(clippy::too_many_arguments, reason = "the inside of a loop, in a function of its own")]
#[inline]
fn merge_runs<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &SharedCells<'_, C>,
    params: &OctreeParams,
    level: u32,
    samples: &[Sample],
    runs: &[Run],
    places: &[[u32; 3]],
    counters: &mut Counters,
) {
    let mut indices = [NO_CELL; BATCH];
    octree.find_cells(level, places, &mut indices[..places.len()]);
    let mut old = [C::zeroed(); BATCH];
    for (cell, index) in old.iter_mut().zip(indices).filter(|(_, index)| *index != NO_CELL) {
        *cell = cells.get(index);
    }
    for ((run, index), cell) in runs.iter().zip(indices).zip(&mut old) {
        let run = &samples[run.start..run.end];
        if index == NO_CELL {
            counters.coarser += if level == 0 { run.len() as u64 } else { 0 };
            continue;
        }
        merge_run(cell, params, index, run);
        cells.set(index, cell);
    }
}

/// Merges samples into their cell.
#[inline]
fn merge_run<C: CellRecord>(cell: &mut C, params: &OctreeParams, index: u32, run: &[Sample]) {
    if cell.wiped() != params.wiped() {
        *cell = C::empty(cell.normal(), params.wiped());
    }
    let normal = octahedral_decode_int(cell.normal());
    // All of them, and those behind: sums in registers, without a branch on a side that is random.
    let (mut all, mut behind, mut back) = ([0_u64; 3], [0_u64; 3], 0);
    let (mut all_squares, mut behind_squares) = (0_u128, 0_u128);
    for sample in run {
        let side = side_of(normal, sample.normal()) as u64;
        let sums = sample.sums();
        for c in 0..3 {
            all[c] += sums[c];
            behind[c] += sums[c] & side.wrapping_neg();
        }
        let square = square_of_luminance(sums);
        all_squares += square;
        behind_squares += square & u128::from(side).wrapping_neg();
        back += side;
    }
    let sums = [[0, 1, 2].map(|c| all[c] - behind[c]), behind];
    let squares = [all_squares - behind_squares, behind_squares];
    let counts = [run.len() as u32 - back as u32, back as u32];
    for side in [FRONT, BACK] {
        if counts[side] > 0 {
            let random = [params.seed(), index * 2 + side as u32];
            merge_side(cell, params, side, sums[side], squares[side], counts[side], random);
        }
    }
}

/// Rec. 709's weights of red, green and blue, in 65536ths: 0.2126, 0.7152, 0.0722.
const LUMINANCE: [u64; 3] = [13_933, 46_871, 4_732];

/// Fixed point of a luminance beyond whole quanta.
const LUMINANCE_BITS: u32 = 8;

/// The square of a sample's luminance in 2⁻¹⁶ quanta², exact: at most 2⁸⁴, so that 2²⁸ samples stay below 2¹²⁸.
#[inline]
fn square_of_luminance(sums: [u64; 3]) -> u128 {
    let [r, g, b] = [0, 1, 2].map(|c| sums[c] * LUMINANCE[c]);
    let luminance = u128::from((r + g + b) >> (16 - LUMINANCE_BITS));
    luminance * luminance
}

/// Root of the mean of `count` squares of luminance, in radiance.
#[inline]
fn root_mean_square(quantum: Quantum, squares: u128, count: u32) -> f32 {
    float::sqrt(squares as f32 / count as f32) * (quantum.quantum() * (1.0 / (1 << LUMINANCE_BITS) as f32))
}

/// The root mean square of all when `new` has the share `weight` and `old` the rest. By ratios to the larger one: squares
/// of radiance would leave the range of f32.
#[inline]
fn blend_squares(old: f32, new: f32, weight: f32) -> f32 {
    let largest = old.max(new);
    if largest == 0.0 {
        return 0.0;
    }
    let (old, new) = (old / largest, new / largest);
    largest * float::sqrt(old * old + (new * new - old * old) * weight)
}

/// Moves one side's mean by a frame's `count` samples that sum to `sums`, with `squares` of luminance.
///
/// mean + (frame's mean − mean)·w with w = `count` / (all samples), the sum rounded by chance: with rounding to nearest,
/// a mean stops moving once its steps are below half a unit in its last place.
#[inline]
fn merge_side<C: CellRecord>(
    cell: &mut C,
    params: &OctreeParams,
    side: usize,
    sums: [u64; 3],
    squares: u128,
    count: u32,
    random: [u32; 2],
) {
    let quantum = params.quantum();
    let Side { mean: old, count: before } = cell.side(side, quantum);
    let most = params.max_samples().min(C::MAX_COUNT);
    let before = before.min(most);
    // At most 2³⁰ and 2²⁸.
    let all = before + count;
    let weight = count as f32 / all as f32;
    let new = sums.map(|sum| mean(quantum, sum, count));
    let moved = [0, 1, 2].map(|c| {
        if before == 0 { Sum { value: new[c], rest: 0.0 } } else { Sum::new(old[c], (new[c] - old[c]) * weight) }
    });
    let [r, g, b, _] = pcg4d([random[0], random[1], before, count]);
    cell.put(side, quantum, moved, all.min(most), [r, g, b]);
    if let Some(old) = cell.root_mean_square(side) {
        let new = root_mean_square(quantum, squares, count);
        cell.put_root_mean_square(side, if before == 0 { new } else { blend_squares(old, new, weight) });
    }
}
