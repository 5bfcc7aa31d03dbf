//! A frame's table merged into one that lasts, by a rule over time.
//!
//! Steps, each by any number of threads over parts of the frame's slots, one after the other: [`Merge::claim`] gives the
//! frame's keys cells in the lasting table, [`Merge::name`] twice names them (nothing to do in layouts without keys),
//! [`Merge::add`] blends the sums. The frame's table is then [cleared](Table::clear) for the next frame. What the lasting
//! table holds depends on its content before and on the frame's table only.
//!
//! ```
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::merge::Merge;
//! use hashgrid::temporal::MovingAverage;
//! use hashgrid::{CELL_WORDS, Params, Settings, Table, Word, vertex};
//!
//! let params = Params::new(&Settings::default())?;
//! let storage = [const { Word::new(0) }; 128 * CELL_WORDS];
//! let (lasting, frame) = storage.split_at(64 * CELL_WORDS);
//! let (lasting, frame) = (Table::new(lasting, &params)?, Table::new(frame, &params)?);
//! lasting.clear();
//! let rule = MovingAverage::new(0.75)?;
//! for (index, light) in [0.0, 0.0, 0.0, 1.0].into_iter().enumerate() {
//!     frame.clear();
//!     let vertex = VertexRecord { direct: [light; 4], flags: VertexRecord::VALID, ..bytemuck::Zeroable::zeroed() };
//!     vertex::claim_vertices(&frame, &params, &[vertex]);
//!     vertex::deposit_vertices(&frame, &params, &[vertex], &mut Counters::default());
//!     Merge::new(&lasting, &frame)?.all(&rule, index as u32);
//! }
//! let cell = lasting.cells().next().unwrap();
//! assert_eq!(cell.mean_direct(params.quantum())[0], 0.25);
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```

use core::ops::Range;

use hashcache_core::error::ParamError;

use crate::key::{Key, fingerprint};
use crate::layout::{Keep, Layout};
use crate::names::Naming;
use crate::table::{Claim, Table};
use crate::tag::tag_fingerprint;
use crate::temporal::Rule;

/// What a merge did. *Energy of the lasting table after = before + added − faded*, to the last quantum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// Cells of the frame that were added.
    pub cells: u64,
    /// Cells of the frame that found no cell.
    pub refused: u64,
    /// Energy of the cells added, in quanta.
    pub energy_added: u64,
    /// Energy of the cells refused, in quanta.
    pub energy_refused: u64,
    /// Energy of the history that the rule dropped, in quanta.
    pub energy_faded: u64,
}

impl Merged {
    /// What two parts did.
    #[must_use]
    pub const fn plus(&self, other: &Self) -> Self {
        Self {
            cells: self.cells + other.cells,
            refused: self.refused + other.refused,
            energy_added: self.energy_added.wrapping_add(other.energy_added),
            energy_refused: self.energy_refused.wrapping_add(other.energy_refused),
            energy_faded: self.energy_faded.wrapping_add(other.energy_faded),
        }
    }
}

/// Two tables of one number of cells (of any two, where both keep keys): a frame's, and the one that it goes into.
#[derive(Clone, Copy, Debug)]
pub struct Merge<'a, L, F> {
    lasting: Table<'a, L>,
    frame: Table<'a, F>,
}

/// Where a frame's cell belongs in the lasting table.
struct Place {
    home: u32,
    fingerprint: u32,
    key: Option<Key>,
}

impl<'a, L: Layout, F: Layout> Merge<'a, L, F> {
    /// The merge of `frame` into `lasting`. The layouts must agree in [`Layout::SPLIT`], and `frame`'s must have the
    /// moments and keys that `lasting`'s has; another pair does not compile.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] for another number of cells, unless both keep keys: without them a cell's home is
    /// known only up to the size of its table.
    pub fn new(lasting: &Table<'a, L>, frame: &Table<'a, F>) -> Result<Self, ParamError> {
        const {
            assert!(L::SPLIT == F::SPLIT, "both tables split direct and further light, or none does");
            assert!(F::MOMENTS || !L::MOMENTS, "the frame has no second moments");
            assert!(F::Kept::WORDS >= L::Kept::WORDS, "the frame keeps no keys");
        }
        if L::Kept::WORDS == 0 {
            let cells = lasting.capacity() as f64;
            ParamError::check_range("frame", frame.capacity() as f64, cells, cells)?;
        }
        Ok(Self { lasting: *lasting, frame: *frame })
    }

    /// Number of the frame's cells, to be cut into parts.
    pub const fn slots(&self) -> u32 {
        self.frame.capacity() as u32
    }

    fn place(&self, slot: u32) -> Option<Place> {
        let cell = self.frame.cell(slot);
        if cell.count == 0 {
            return None;
        }
        if L::Kept::WORDS == 0 {
            let home = cell.home(self.frame.capacity());
            return Some(Place { home, fingerprint: tag_fingerprint(cell.tag), key: None });
        }
        let key = self.frame.key(slot)?;
        Some(Place { home: self.lasting.home_slot(&key), fingerprint: fingerprint(&key), key: Some(key) })
    }

    /// Claims a cell for each of the frame's cells with deposits. True when some key was refused.
    pub fn claim(&self, slots: Range<u32>) -> bool {
        let mut refused = false;
        for place in slots.filter_map(|slot| self.place(slot)) {
            let head = self.lasting.head(place.home);
            refused |= self.lasting.claim_from(place.home, place.fingerprint, head) == Claim::Refused;
        }
        refused
    }

    /// Names what was claimed.
    pub fn name(&self, slots: Range<u32>, step: Naming) {
        if L::Kept::WORDS > 0 {
            for key in slots.filter_map(|slot| self.place(slot)?.key) {
                self.lasting.name(&key, step);
            }
        }
    }

    /// Stamps what was claimed with `frame`, ahead of [`crate::levels::inherit`].
    pub fn touch(&self, slots: Range<u32>, frame: u32) {
        for slot in slots.filter_map(|slot| self.find(&self.place(slot)?)) {
            self.lasting.touch(slot, frame);
        }
    }

    /// Blends each of the frame's cells into the one that was claimed for it, and stamps that with `frame`.
    pub fn add<R: Rule>(&self, slots: Range<u32>, rule: &R, frame: u32) -> Merged {
        let mut merged = Merged::default();
        for slot in slots {
            let new = self.frame.sums(slot);
            if new.count == 0 {
                continue;
            }
            let Some(to) = self.place(slot).and_then(|place| self.find(&place)) else {
                merged.refused += 1;
                merged.energy_refused = merged.energy_refused.wrapping_add(new.energy());
                continue;
            };
            let old = self.lasting.sums(to);
            let blend = rule.blend(&old, &new, self.frame.change(slot));
            self.lasting.set_sums(to, &blend);
            self.lasting.touch(to, frame);
            let together = old.energy().wrapping_add(new.energy());
            merged.cells += 1;
            merged.energy_added = merged.energy_added.wrapping_add(new.energy());
            merged.energy_faded = merged.energy_faded.wrapping_add(together.wrapping_sub(blend.energy()));
        }
        merged
    }

    fn find(&self, place: &Place) -> Option<u32> {
        match &place.key {
            Some(key) => self.lasting.find_named(key),
            None => self.lasting.find_at(place.home, place.fingerprint).slot,
        }
    }

    /// All steps on one thread.
    pub fn all<R: Rule>(&self, rule: &R, frame: u32) -> Merged {
        let slots = 0..self.slots();
        self.claim(slots.clone());
        self.name(slots.clone(), Naming::First);
        self.name(slots.clone(), Naming::Second);
        self.add(slots, rule, frame)
    }
}
