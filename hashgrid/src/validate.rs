//! Whether a table's words keep the table's laws.

use core::fmt;

use hashcache_core::exact::CLAMP_BITS;

use crate::layout::Layout;
use crate::table::{Cell, Table};
use crate::tag::{EMPTY, NEW, tag, tag_distance, tag_fingerprint, tag_is_new};

/// What a valid table holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Occupied cells.
    pub occupied: u32,
    /// Cells that were claimed and have no deposits.
    pub new: u32,
    /// Deposits in all cells.
    pub deposits: u64,
    /// Energy in all cells and channels, in quanta, modulo 2⁶⁴: equals the counters' `energy_stored`.
    pub energy: u64,
    /// Largest distance of a key from its home.
    pub longest: u32,
    /// Sum of all distances; divided by `occupied`, their mean.
    pub distances: u64,
}

/// The first broken law, and the cell that breaks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Violation {
    /// An empty slot with a count or sums.
    EmptyWithDeposits {
        /// The cell.
        slot: u32,
    },
    /// A key farther from home than it may probe.
    TooFar {
        /// The cell.
        slot: u32,
    },
    /// An empty slot between a key and its home: the key cannot be found.
    Unreachable {
        /// The cell.
        slot: u32,
        /// The empty slot.
        gap: u32,
    },
    /// A key that stands in two slots.
    Duplicate {
        /// The cell.
        slot: u32,
        /// The other cell, nearer to home.
        other: u32,
    },
    /// A new key behind a slot of its probe sequence whose tag is larger, so that it should be there.
    Order {
        /// The cell.
        slot: u32,
        /// The slot that the key should have.
        better: u32,
    },
    /// A new key with a count or sums.
    NewWithDeposits {
        /// The cell.
        slot: u32,
    },
    /// A sum above what the count of deposits can make.
    SumAboveCount {
        /// The cell.
        slot: u32,
    },
    /// A spare word that is not zero.
    Padding {
        /// The cell.
        slot: u32,
    },
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EmptyWithDeposits { slot } => write!(f, "cell {slot} is empty and has deposits"),
            Self::TooFar { slot } => write!(f, "cell {slot}: the key is farther from home than it may probe"),
            Self::Unreachable { slot, gap } => write!(f, "cell {slot}: slot {gap} on the way from home is empty"),
            Self::Duplicate { slot, other } => write!(f, "cell {slot}: the key is in cell {other}, too"),
            Self::Order { slot, better } => write!(f, "cell {slot}: the key should be in slot {better}"),
            Self::NewWithDeposits { slot } => write!(f, "cell {slot}: the key is new and has deposits"),
            Self::SumAboveCount { slot } => write!(f, "cell {slot}: a sum is above what its deposits can make"),
            Self::Padding { slot } => write!(f, "cell {slot}: the spare word is not zero"),
        }
    }
}

impl core::error::Error for Violation {}

impl<L: Layout> Table<'_, L> {
    /// Checks every cell: that its key can be found from home, once; that new keys keep the order of claims and have no
    /// deposits; that counts and sums fit each other. In time proportional to cells × mean distance.
    ///
    /// # Errors
    /// The first violation in the order of slots.
    pub fn validate(&self) -> Result<Summary, Violation> {
        let mut summary = Summary::default();
        for slot in 0..=self.mask() {
            let cell = self.cell(slot);
            if self.padding(slot) != 0 {
                return Err(Violation::Padding { slot });
            }
            if cell.tag == EMPTY {
                if !is_untouched(&cell) {
                    return Err(Violation::EmptyWithDeposits { slot });
                }
                continue;
            }
            self.validate_path(&cell)?;
            validate_sums(&cell)?;
            summary.occupied += 1;
            summary.new += u32::from(tag_is_new(cell.tag));
            summary.deposits += u64::from(cell.count);
            for sum in cell.direct.iter().chain(&cell.further) {
                summary.energy = summary.energy.wrapping_add(*sum);
            }
            summary.longest = summary.longest.max(tag_distance(cell.tag));
            summary.distances += u64::from(tag_distance(cell.tag));
        }
        Ok(summary)
    }

    fn validate_path(&self, cell: &Cell) -> Result<(), Violation> {
        let (slot, fingerprint) = (cell.slot, tag_fingerprint(cell.tag));
        if tag_distance(cell.tag) >= self.max_probes() {
            return Err(Violation::TooFar { slot });
        }
        for distance in 0..tag_distance(cell.tag) {
            let other = (cell.home(self.capacity()) + distance) & self.mask();
            let found = (self.head(other) >> 32) as u32;
            let own = tag(fingerprint, distance);
            if found == EMPTY {
                return Err(Violation::Unreachable { slot, gap: other });
            }
            if found & !NEW == own {
                return Err(Violation::Duplicate { slot, other });
            }
            if tag_is_new(cell.tag) && found > (NEW | own) {
                return Err(Violation::Order { slot, better: other });
            }
        }
        Ok(())
    }
}

fn is_untouched(cell: &Cell) -> bool {
    cell.count == 0 && cell.direct == [0; 3] && cell.further == [0; 3]
}

fn validate_sums(cell: &Cell) -> Result<(), Violation> {
    if tag_is_new(cell.tag) && !is_untouched(cell) {
        return Err(Violation::NewWithDeposits { slot: cell.slot });
    }
    let most = u64::from(cell.count).saturating_mul(1 << CLAMP_BITS);
    if cell.direct.iter().chain(&cell.further).any(|sum| *sum > most) {
        return Err(Violation::SumAboveCount { slot: cell.slot });
    }
    Ok(())
}
