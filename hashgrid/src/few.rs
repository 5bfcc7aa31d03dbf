//! Cells with few vertices: what is around them, or coarser cells that were filled along with them, help out.
//!
//! A [`Search`] tells what answers a lookup whose cell has [few](Neighbours::least) deposits:
//!
//! | search | looks at | needs |
//! |---|---|---|
//! | [`Neighbours`] | the eight cells around, in the plane that the normal faces | nothing |
//! | [`Levels`] | coarser cells, one after the other | light deposited on several levels: [`deposit_levels`] |
//! | [`ByError`] | the same, and goes on as long as the coarser mean agrees with the finer one | the same, and [moments](Layout::MOMENTS) |
//!
//! Light on `n` levels is claimed and deposited `n` times, and each time counts as a deposit; a coarser cell holds
//! exactly what the finer ones in it hold, and what vertices of its own level brought.
//!
//! ```
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::few::{Levels, claim_levels, deposit_levels, estimate_by};
//! use hashgrid::{CELL_WORDS, Params, Settings, Table, Word};
//!
//! let params = Params::new(&Settings { jitter: 0.0, ..Settings::default() })?;
//! let storage = [const { Word::new(0) }; 64 * CELL_WORDS];
//! let table = Table::new(&storage, &params)?;
//! table.clear();
//! let at = |x, light| VertexRecord {
//!     position_footprint: [x, 0.0, 0.0, 0.002],
//!     direct: [light; 4],
//!     flags: VertexRecord::VALID,
//!     ..bytemuck::Zeroable::zeroed()
//! };
//! let vertices = [at(0.001, 1.0), at(0.016, 3.0)]; // neighbours, in one cell of the level above
//! let mut counters = Counters::default();
//! claim_levels(&table, &params, &vertices, 3);
//! deposit_levels(&table, &params, &vertices, 3, &mut counters);
//! let search = Levels { least: 2, levels: 3 };
//! estimate_by(&table, &params, &vertices[..1], &search, &mut counters, |_, estimate| {
//!     assert_eq!((estimate.direct.x, estimate.samples), (2.0, 2));
//! });
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Source
//! Binder et al. 2021, sections 3.3.1, 3.3.2 and 3.1.3; Lepski 1991 for [`ByError`].
//!
//! # Limits today
//! On the host.

use core::iter;

use hashcache_core::counters::Counters;
use hashcache_core::exact::{MAX_DEPOSITS, Quantum};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::jitter::turn_back;
use crate::key::{Key, coarser, key};
use crate::layout::{Keep, Layout};
use crate::names::Naming;
use crate::params::Params;
use crate::sums::Sums;
use crate::table::{Claim, Table};
use crate::vertex::{answer_vertices, deposit_under, find_named, key_of_deposit};

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gathered {
    /// Sums whose means answer; a count of 0 where there is nothing.
    pub sums: Sums,
    /// Whether they are those of a coarser level.
    pub is_coarser: bool,
}

/// How a lookup goes on from its own cell.
pub trait Search {
    /// What answers for `key`, whose cell holds `own`. Slots looked at are added to `probes`.
    fn gather<L: Layout>(
        &self,
        table: &Table<'_, L>,
        params: &Params,
        key: &Key,
        own: Sums,
        probes: &mut u64,
    ) -> Gathered;
}

/// Where the cell has fewer than `least` deposits, all eight cells around it in the plane across the normal's largest
/// component count, too, for the same bin of normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbours {
    /// Deposits that are enough.
    pub least: u32,
}

/// Where the cell has fewer than `least` deposits, the first coarser one with enough answers; without any, the one with
/// the most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Deposits that are enough.
    pub least: u32,
    /// Levels that are looked at, its own included: as many as were deposited.
    pub levels: u32,
}

/// The coarsest cell whose mean agrees with that of every finer one on the way: within `tolerance` standard errors of
/// the finer mean's luminance. Where light is even, many vertices answer; where it changes, few of them, nearby.
///
/// Cells with fewer than `least` deposits are passed by: their standard error is not known well enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByError {
    /// Deposits from which on a standard error is believed, at least 2.
    pub least: u32,
    /// Levels that are looked at, its own included.
    pub levels: u32,
    /// Standard errors that means may differ by. 3 keep 997 of 1000 cells of even light together; those that
    /// part are the ones farthest off, so fewer cost more than they gain.
    pub tolerance: f32,
}

fn sums_of<L: Layout>(table: &Table<'_, L>, key: &Key, probes: &mut u64) -> Sums {
    let found = find_named(table, key);
    *probes += u64::from(found.probes);
    found.slot.map_or(Sums::default(), |slot| table.sums(slot))
}

impl Search for Neighbours {
    fn gather<L: Layout>(
        &self,
        table: &Table<'_, L>,
        params: &Params,
        key: &Key,
        own: Sums,
        probes: &mut u64,
    ) -> Gathered {
        let mut sums = own;
        if own.count < self.least {
            let bins = params.normal_bins();
            let axis = key.normal_bin() / (2 * bins * bins);
            for step in (0..9).filter(|step| *step != 4) {
                let [x, y, z] = turn_back([0, step % 3 - 1, step / 3 - 1], axis);
                let [a, b, c] = key.cell;
                let more = sums_of(table, &Key { cell: [a + x, b + y, c + z], ..*key }, probes);
                if sums.count.saturating_add(more.count) <= MAX_DEPOSITS {
                    sums = sums.plus(&more);
                }
            }
        }
        Gathered { sums, is_coarser: false }
    }
}

impl Search for Levels {
    fn gather<L: Layout>(&self, table: &Table<'_, L>, _: &Params, key: &Key, own: Sums, probes: &mut u64) -> Gathered {
        let mut best = Gathered { sums: own, is_coarser: false };
        for above in levels(key, self.levels).skip(1) {
            if best.sums.count >= self.least {
                break;
            }
            let sums = sums_of(table, &above, probes);
            if sums.count > best.sums.count {
                best = Gathered { sums, is_coarser: true };
            }
        }
        best
    }
}

impl Search for ByError {
    fn gather<L: Layout>(
        &self,
        table: &Table<'_, L>,
        params: &Params,
        key: &Key,
        own: Sums,
        probes: &mut u64,
    ) -> Gathered {
        const { assert!(L::MOMENTS, "the standard error needs second moments") }
        let mut best = Gathered { sums: own, is_coarser: false };
        // What a coarser mean must stay between: the meeting of all finer means' intervals.
        let mut within = self.interval(&own, params.quantum());
        for above in levels(key, self.levels).skip(1) {
            let sums = sums_of(table, &above, probes);
            if sums.count == 0 {
                continue;
            }
            let mean = sums.mean_luminance(params.quantum());
            if mean < within[0] || mean > within[1] {
                break;
            }
            best = Gathered { sums, is_coarser: true };
            let [low, high] = self.interval(&sums, params.quantum());
            within = [within[0].max(low), within[1].min(high)];
        }
        best
    }
}

impl ByError {
    /// What agrees with a cell's mean luminance; everything agrees with a cell that has few deposits.
    fn interval(&self, sums: &Sums, quantum: Quantum) -> [f32; 2] {
        match sums.standard_error(quantum) {
            Some(error) if sums.count >= self.least => {
                let (mean, off) = (sums.mean_luminance(quantum), self.tolerance * error);
                // Equal deposits have no error, but their mean and a coarser one round differently.
                let rounding = 1e-5 * mean;
                [mean - off - rounding, mean + off + rounding]
            }
            _ => [f32::NEG_INFINITY, f32::INFINITY],
        }
    }
}

/// A key and those above it, `count` in all as far as levels go.
fn levels(key: &Key, count: u32) -> impl Iterator<Item = Key> + use<> {
    iter::successors(Some(*key), coarser).take(count as usize)
}

/// Claims the cell of every vertex and those above it, on `count` levels in all. True when some key was refused. Any
/// number of threads may claim parts of the same vertices.
pub fn claim_levels<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], count: u32) -> bool {
    let mut refused = false;
    for key in vertices.iter().filter_map(|vertex| key_of_deposit(params, vertex)) {
        for key in levels(&key, count) {
            refused |= table.claim(&key) == Claim::Refused;
        }
    }
    refused
}

/// Names what was claimed; does nothing in layouts without keys. See [`crate::names`].
pub fn name_levels<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    count: u32,
    step: Naming,
) {
    if L::Kept::WORDS == 0 {
        return;
    }
    for key in vertices.iter().filter_map(|vertex| key_of_deposit(params, vertex)) {
        for key in levels(&key, count) {
            table.name(&key, step);
        }
    }
}

/// Deposits every vertex on `count` levels. What finds no cell, and what is cut off, is counted, on each level. Any number
/// of threads may deposit parts of the same vertices.
pub fn deposit_levels<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    count: u32,
    counters: &mut Counters,
) {
    for vertex in vertices.iter().filter(|vertex| vertex.is_recordable()) {
        let Some(key) = key_of_deposit(params, vertex) else {
            deposit_under(table, params, None, vertex, counters);
            continue;
        };
        for key in levels(&key, count) {
            deposit_under(table, params, Some(&key), vertex, counters);
        }
    }
}

/// Illumination at every vertex, in order: `answer(i, estimate)`: as [`crate::vertex::estimate_vertices`], with a search
/// where the cell has few deposits or none.
pub fn estimate_by<L: Layout, S: Search>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    search: &S,
    counters: &mut Counters,
    answer: impl FnMut(usize, Estimate),
) {
    let sums_for = |vertex: &VertexRecord, salt, counters: &mut Counters| {
        let key = key(params, vertex, salt)?;
        let own = sums_of(table, &key, &mut counters.probes);
        let Gathered { sums, is_coarser } = search.gather(table, params, &key, own, &mut counters.probes);
        counters.coarser += u64::from(is_coarser && sums.count > 0);
        Some(sums)
    };
    answer_vertices(params, vertices, counters, sums_for, answer);
}
