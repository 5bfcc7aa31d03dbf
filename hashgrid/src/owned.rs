//! A grid that owns its storage, for programs with an allocator.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::slice;

use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::{Estimate, RadianceCache};

use crate::layout::Standard;
use crate::params::Params;
use crate::table::{CELL_WORDS, Table};
use crate::vertex::{add_counters, claim_vertices, deposit_vertices, estimate_vertices, read_counters};
use crate::word::Word;

/// Parameters, table and counters in one, as a [`RadianceCache`].
///
/// `record` only remembers the vertex (96 bytes); `end_frame` claims cells for all remembered vertices, then deposits
/// them. So the order of `record` has no influence, and estimates change at `end_frame` only.
///
/// ```
/// use hashcache_core::record::VertexRecord;
/// use hashcache_core::traits::RadianceCache;
/// use hashgrid::{OwnedGrid, Params, Settings};
///
/// let mut grid = OwnedGrid::new(Params::new(&Settings::default())?, 1 << 10)?;
/// let vertex = VertexRecord { direct: [0.5; 4], flags: VertexRecord::VALID, ..bytemuck::Zeroable::zeroed() };
/// grid.record(&vertex);
/// grid.record(&VertexRecord { direct: [1.5; 4], ..vertex });
/// grid.end_frame();
/// let estimate = grid.estimate(&vertex);
/// assert_eq!((estimate.direct.x, estimate.samples), (1.0, 2));
/// # Ok::<(), hashcache_core::error::ParamError>(())
/// ```
#[derive(Debug)]
pub struct OwnedGrid {
    params: Params,
    /// The table, from `first` on: there a line of the memory's caches begins, so that a cell is one line and not part of two.
    words: Box<[Word]>,
    first: usize,
    counters: [Word; Counters::WORDS],
    pending: Vec<VertexRecord>,
}

impl OwnedGrid {
    /// An empty grid of `cells` cells, a power of two from [`crate::table::MIN_CELLS`] on: 64 bytes each.
    ///
    /// # Errors
    /// Those of [`Table::new`].
    pub fn new(params: Params, cells: usize) -> Result<Self, ParamError> {
        let wanted = cells.saturating_mul(CELL_WORDS);
        // Judged before memory is asked for.
        Table::<Standard>::check_words(wanted)?;
        let words: Box<[Word]> = (0..wanted + CELL_WORDS).map(|_| Word::new(0)).collect();
        // Where the way to a line's begin is not known, any will do.
        let first = words.as_ptr().align_offset(size_of::<Word>() * CELL_WORDS).min(CELL_WORDS);
        let grid =
            Self { params, words, first, counters: [const { Word::new(0) }; Counters::WORDS], pending: Vec::new() };
        grid.table().clear();
        Ok(grid)
    }

    /// The parameters.
    pub const fn params(&self) -> &Params {
        &self.params
    }

    /// The table, to look into or to fill by threads of the caller's.
    ///
    /// # Panics
    /// Never: [`OwnedGrid::new`] checked the storage.
    pub fn table(&self) -> Table<'_> {
        let words = &self.words[self.first..][..self.words.len() - CELL_WORDS];
        Table::new(words, &self.params).expect("checked when the grid was made")
    }

    /// Counters since the grid was made.
    pub fn counters(&self) -> Counters {
        read_counters(&self.counters)
    }
}

impl RadianceCache for OwnedGrid {
    fn record(&mut self, vertex: &VertexRecord) {
        self.pending.push(*vertex);
    }

    fn estimate(&self, vertex: &VertexRecord) -> Estimate {
        let mut counters = Counters::default();
        let mut estimate = Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0, variance: 0.0 };
        let vertex = slice::from_ref(vertex);
        estimate_vertices(&self.table(), &self.params, vertex, &mut counters, |_, found| estimate = found);
        add_counters(&self.counters, &counters);
        estimate
    }

    fn end_frame(&mut self) {
        let mut counters = Counters::default();
        claim_vertices(&self.table(), &self.params, &self.pending);
        deposit_vertices(&self.table(), &self.params, &self.pending, &mut counters);
        add_counters(&self.counters, &counters);
        self.pending.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_lines() {
        for cells in [64, 128, 1 << 12] {
            let grid = OwnedGrid::new(Params::new(&crate::Settings::default()).unwrap(), cells).unwrap();
            assert_eq!(grid.table().capacity(), cells);
            assert_eq!(grid.words[grid.first..].as_ptr().align_offset(64), 0, "{cells} cells");
        }
    }
}
