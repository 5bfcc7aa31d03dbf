//! Deposits of samples into the sums of an open frame.

use super::cell::{BACK, CellRecord, FRONT};
use super::cells::ReadCells;
use super::pending::{Owner, Pending};
use super::sample::Sample;
use super::view::{NO_CELL, Octree};
use crate::counters::Counters;
use crate::pack::octahedral_decode_int;

/// Samples and entries that are worked on together, so that their cache misses overlap: each step is a loop of its own,
/// since only so close together do they. More than the misses that a core keeps in flight gains nothing.
pub(crate) const BATCH: usize = 16;

/// Which side of a surface with normal `normal` (octahedral) a direction `n` points to.
#[inline]
pub(crate) fn side_of(normal: u32, n: u32) -> usize {
    let ([a, b, c], [x, y, z]) = (octahedral_decode_int(normal), octahedral_decode_int(n));
    // At most 32767² in magnitude, whatever the order of additions.
    if a * x + b * y + c * z >= 0 { FRONT } else { BACK }
}

/// Adds every sample to the sums of the finest cell that holds it.
///
/// A sample whose finest cell is missing (rounding may move a vertex off its surface) adds to the next coarser one that
/// exists, counted in [`Counters::coarser`]; one that finds no room is refused and counted. Any number of threads may
/// deposit parts of the same samples, each with its own counters. True when there was no room for some sample.
pub fn deposit_samples<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &(impl ReadCells<C> + ?Sized),
    pending: &Pending<'_>,
    samples: &[Sample],
    counters: &mut Counters,
) -> bool {
    let mut full = false;
    for batch in samples.chunks(BATCH) {
        let mut places = [[u32::MAX; 3]; BATCH];
        for (place, sample) in places.iter_mut().zip(batch).filter(|(_, sample)| sample.is_kept()) {
            *place = sample.place();
        }
        let mut indices = [NO_CELL; BATCH];
        octree.find_cells(0, &places[..batch.len()], &mut indices[..batch.len()]);
        let mut normals = [0; BATCH];
        let mut wanted = 0;
        for ((normal, cell), sample) in normals.iter_mut().zip(indices).zip(batch) {
            if cell != NO_CELL {
                *normal = cells.normal(cell);
                wanted += u32::from(pending.mark(cell) == 0);
            } else if sample.is_kept() {
                *normal = sample.normal();
                wanted += 1;
            }
        }
        let mut reserved = pending.reserve(0, wanted);
        for (((sample, cell), normal), place) in batch.iter().zip(indices).zip(normals).zip(places) {
            if !sample.is_kept() {
                continue;
            }
            let owner = if cell == NO_CELL { Owner::Sample(normal) } else { Owner::Cell(cell) };
            let sums = sample.sums();
            if let Some(entry) = pending.claim(0, owner, place, &mut reserved) {
                pending.add(0, entry, side_of(normal, sample.normal()), sums, 1);
                counters.coarser += u64::from(cell == NO_CELL);
            } else {
                // Counted as stored when the sample was made.
                full = true;
                let energy = sums.iter().sum();
                counters.refusals += 1;
                counters.energy_stored = counters.energy_stored.wrapping_sub(energy);
                counters.energy_refused = counters.energy_refused.wrapping_add(energy);
            }
        }
    }
    full
}
