//! The end of a frame: a level's sums are merged into its cells and handed on to the next coarser level.

use core::ops::Range;

use super::cell::{BACK, CellRecord, FRONT, Side, Sum};
use super::cells::{ReadCells, SharedCells};
use super::deposit::{BATCH, side_of};
use super::params::OctreeParams;
use super::pending::{Entry, Owner, Pending};
use super::view::{NO_CELL, Octree};
use crate::exact::mean;
use crate::hash::pcg4d;

/// Merges the entries `entries` of a level's list into their cells, and adds them to the list of the next coarser level.
///
/// A frame ends by this for every level, the finest first, and once more for the level behind the coarsest
/// ([`Grid::levels`](super::Grid::levels)), each after the one before has ended. Entries beyond the list's end are fine: any number of threads may
/// merge parts of `0..`[`Pending::capacity`].
///
/// A cell is written by one thread and from an exact sum, so it gets the same bits for any number of threads. A cell of
/// a coarser level gets the light of all cells below it: front adds to the side that the two normals agree on.
pub fn merge_entries<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &SharedCells<'_, C>,
    pending: &Pending<'_>,
    params: &OctreeParams,
    level: u32,
    entries: Range<u32>,
) {
    if entries.start == 0 && level > 0 {
        pending.forget(level - 1);
    }
    let end = entries.end.min(pending.len(level));
    let mut first = entries.start;
    while first < end {
        let last = end.min(first + BATCH as u32);
        merge_batch(octree, cells, pending, params, level, first..last);
        first = last;
    }
}

/// Merges a batch of entries, in steps that each overlap their cache misses.
#[inline]
fn merge_batch<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &SharedCells<'_, C>,
    pending: &Pending<'_>,
    params: &OctreeParams,
    level: u32,
    entries: Range<u32>,
) {
    let above = level + 1;
    let mut taken = [None; BATCH];
    for (to, entry) in taken.iter_mut().zip(entries) {
        *to = pending.take(level, entry);
    }
    let mut normals = [0; BATCH];
    let mut places = [[u32::MAX; 3]; BATCH];
    for ((normal, place), entry) in normals.iter_mut().zip(&mut places).zip(&taken) {
        let Some(entry) = entry else { continue };
        *normal = match entry.owner {
            Owner::Cell(cell) => cells.normal(cell),
            Owner::Sample(normal) => normal,
        };
        *place = entry.place.map(|c| c >> above);
    }
    let has_parents = above < octree.grid().levels;
    let mut parents = [NO_CELL; BATCH];
    let mut parent_normals = normals;
    let mut wanted = 0;
    if has_parents {
        octree.find_cells(above, &places, &mut parents);
        for ((parent, normal), entry) in parents.iter().zip(&mut parent_normals).zip(&taken) {
            if *parent != NO_CELL {
                *normal = cells.normal(*parent);
                wanted += u32::from(pending.mark(*parent) == 0);
            } else {
                wanted += u32::from(entry.is_some());
            }
        }
    }
    for entry in taken.iter().flatten() {
        if let Owner::Cell(cell) = entry.owner {
            pending.unmark(cell);
            merge_cell(cells, params, cell, entry);
        }
    }
    if !has_parents {
        return;
    }
    let mut reserved = pending.reserve(above, wanted);
    for (((entry, normal), parent), parent_normal) in taken.iter().zip(normals).zip(parents).zip(parent_normals) {
        let Some(entry) = entry else { continue };
        let parent = if parent == NO_CELL { Owner::Sample(normal) } else { Owner::Cell(parent) };
        // As many are reserved as are wanted, and a level has no more entries than the one below.
        let Some(to) = pending.claim(above, parent, entry.place, &mut reserved) else { continue };
        let front = side_of(parent_normal, normal);
        for (side, to_side) in [(FRONT, front), (BACK, 1 - front)] {
            if entry.counts[side] > 0 {
                pending.add(above, to, to_side, entry.sums[side], entry.counts[side]);
            }
        }
    }
}

/// Merges an entry into its cell.
#[inline]
fn merge_cell<C: CellRecord>(cells: &SharedCells<'_, C>, params: &OctreeParams, index: u32, entry: &Entry) {
    let mut cell = cells.get(index);
    if cell.wiped() != params.wiped() {
        cell = C::empty(cell.normal(), params.wiped());
    }
    for side in [FRONT, BACK] {
        if entry.counts[side] > 0 {
            let random = [params.seed(), index * 2 + side as u32];
            merge_side(&mut cell, params, side, entry.sums[side], entry.counts[side], random);
        }
    }
    cells.set(index, &cell);
}

/// Moves one side's mean by a frame's `count` samples that sum to `sums`.
///
/// mean + (frame's mean − mean)·w with w = `count` / (all samples), the sum rounded by chance: with rounding to nearest,
/// a mean stops moving once its steps are below half a unit in its last place.
#[inline]
fn merge_side<C: CellRecord>(
    cell: &mut C,
    params: &OctreeParams,
    side: usize,
    sums: [u64; 3],
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
}
