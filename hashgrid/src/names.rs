//! Cells that know their whole key, so that no vertex is ever taken for another.
//!
//! Tags alone confuse two keys of one home and one fingerprint, with a probability of load·2⁻²⁵ a lookup. A layout with
//! [`Layout::Kept`] = [`Key`] keeps the key in two words more. Since a slot is still given by its tag, two keys of one
//! tag compete for one cell: the smaller key gets it, the other is refused and counted, as where a table is full. Who
//! wins depends on the set of keys only. The tag stays the first question, so a lookup reads the key only where it will
//! most likely use the cell.
//!
//! Naming has two steps, each by any number of threads, between claims and deposits:
//!
//! ```
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::layout::{Lasting, Layout};
//! use hashgrid::names::{Naming, name_vertices};
//! use hashgrid::{Params, Settings, Table, Word, vertex};
//!
//! let params = Params::new(&Settings::default())?;
//! let storage = [const { Word::new(0) }; 64 * Lasting::WORDS];
//! let table = Table::<Lasting>::with_layout(&storage, &params)?;
//! table.clear();
//! let vertices = [VertexRecord { flags: VertexRecord::VALID, ..bytemuck::Zeroable::zeroed() }];
//! vertex::claim_vertices(&table, &params, &vertices); // all threads, then
//! name_vertices(&table, &params, &vertices, Naming::First); // all threads, then
//! name_vertices(&table, &params, &vertices, Naming::Second); // all threads, then
//! vertex::deposit_vertices(&table, &params, &vertices, &mut Counters::default());
//! let cell = table.cells().next().unwrap();
//! assert!(table.key(cell.slot).is_some());
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! Whoever has deposits keeps the name; a cell without is named anew by every frame's claims.

use hashcache_core::record::VertexRecord;

use crate::key::Key;
use crate::layout::{Keep, Layout};
use crate::params::Params;
use crate::table::Table;
use crate::tag::tag_is_new;
use crate::vertex::key_of_deposit;

/// The steps of naming: the key's two words, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// The smallest first word stays.
    First,
    /// Of those with that first word, the smallest second word stays.
    Second,
}

/// Names the cells that [`crate::vertex::claim_vertices`] claimed for the same vertices; does nothing in layouts without
/// keys.
pub fn name_vertices<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], step: Naming) {
    if L::Kept::WORDS == 0 {
        return;
    }
    for key in vertices.iter().filter_map(|vertex| key_of_deposit(params, vertex)) {
        table.name(&key, step);
    }
}

impl<L: Layout> Table<'_, L> {
    /// Offers the key as the name of the cell with its tag, if that is still without deposits.
    /// Does nothing in layouts without keys.
    pub fn name(&self, key: &Key, step: Naming) {
        if L::Kept::WORDS == 0 {
            return;
        }
        let found = self.find(key);
        if let Some(slot) = found.slot.filter(|_| tag_is_new((found.head >> 32) as u32)) {
            L::Kept::of(key).offer(self.key_words(slot), step);
        }
    }

    /// The cell that has this very key; in layouts without keys, the cell that has its tag.
    pub fn find_named(&self, key: &Key) -> Option<u32> {
        self.find(key).slot.filter(|slot| L::Kept::of(key).stands_in(self.key_words(*slot)))
    }
}
