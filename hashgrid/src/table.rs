//! The hash table of cells on borrowed storage.

use core::marker::PhantomData;

use hashcache_core::error::ParamError;
use hashcache_core::exact::{MAX_DEPOSITS, Quantum, mean};

use crate::key::{Key, fingerprint, home};
use crate::layout::{Keep, Layout, Standard};
use crate::params::{MAX_PROBES, Params};
use crate::sums::{luminance, square};
use crate::tag::{EMPTY, NEW, tag, tag_distance};
use crate::word::{self, Word};

/// 64-bit words of a cell of the standard layout: 64 bytes, a line of the memory's caches.
pub const CELL_WORDS: usize = Standard::WORDS;

/// Least cells of a table: no probe sequence meets a slot twice.
pub const MIN_CELLS: usize = MAX_PROBES as usize;

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// The key had no cell and took one. Another key may have been refused for it; it was new.
    Placed,
    /// The key had a cell.
    Found,
    /// Some key found no slot: this one, or one that this one displaced.
    Refused,
}

/// What a deposit or lookup found: the cell's index and how many slots were looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// The cell's index, `None` when the key has none.
    pub slot: Option<u32>,
    /// Slots looked at, at least 1.
    pub probes: u32,
    /// Word 0 of the cell as it was when found: tag in the high half, count in the low.
    pub head: u64,
}

impl Found {
    /// Whether the cell holds [`MAX_DEPOSITS`] and takes no more. Threads that reach that bound at the same moment may
    /// exceed it by what they are about to add; the sums have room for twice as many.
    #[inline]
    pub const fn is_full(&self) -> bool {
        self.head as u32 >= MAX_DEPOSITS
    }
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Index in the table.
    pub slot: u32,
    /// Whose it is, see [`crate::tag`].
    pub tag: u32,
    /// Deposits.
    pub count: u32,
    /// Exact sums of the direct illumination, in quanta.
    pub direct: [u64; 3],
    /// Exact sums of the further illumination, in quanta.
    pub further: [u64; 3],
}

impl Cell {
    /// Mean direct illumination; 0 without deposits.
    #[must_use]
    pub fn mean_direct(&self, quantum: Quantum) -> [f32; 3] {
        self.direct.map(|sum| mean(quantum, sum, self.count))
    }

    /// Mean further illumination; 0 without deposits.
    #[must_use]
    pub fn mean_further(&self, quantum: Quantum) -> [f32; 3] {
        self.further.map(|sum| mean(quantum, sum, self.count))
    }

    /// The settled key's slot 0 of its probe sequence.
    pub const fn home(&self, cells: usize) -> u32 {
        self.slot.wrapping_sub(tag_distance(self.tag)) & (cells as u32 - 1)
    }
}

/// Illumination of one vertex in quanta: direct red, green, blue, further red, green, blue.
pub type Quanta = [u64; 6];

/// A table of cells on storage that the caller owns.
///
/// Which words a cell has is the [`Layout`]'s choice; in the standard one it is eight 64-bit words:
///
/// | word | meaning |
/// |---|---|
/// | 0 | low half: count of deposits; high half: tag, see [`crate::tag`] |
/// | 1..4 | sums of direct red, green, blue in quanta |
/// | 4..7 | sums of further red, green, blue in quanta |
/// | 7 | zero: fills the line |
///
/// # Phases
/// Any number of threads may [`claim`](Self::claim) at once; then, when all have ended, any number may
/// [`deposit`](Self::deposit); then any number may [`lookup`](Self::lookup). What the table holds after a phase depends
/// on the *set* of claimed keys and the multiset of deposits, never on their order: in a claim, keys and slots find each
/// other by deferred acceptance (each key proposes to the slots of its probe sequence in turn, each slot keeps
/// the smallest tag it was offered and the loser proposes on), and that ends in the same stable matching whatever the
/// order of proposals. The first deposit settles a key: it can no longer be displaced. So sums never move.
///
/// # Source
/// Binder et al. 2021, section 3.2 and 3.4.3 (atomicMin); Gale & Shapley 1962.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a, L = Standard> {
    words: &'a [Word],
    mask: u32,
    max_probes: u32,
    layout: PhantomData<L>,
}

impl<'a> Table<'a> {
    /// A table of the standard layout on `storage`, [`CELL_WORDS`] words a cell. The words are taken as they are:
    /// [`clear`](Self::clear) them before the first use.
    ///
    /// # Errors
    /// [`ParamError::TooShort`] below [`MIN_CELLS`] cells, [`ParamError::NotPowerOfTwo`] for another number of words
    /// than a power of two, [`ParamError::OutOfRange`] above 2³¹ cells.
    pub fn new(storage: &'a [Word], params: &Params) -> Result<Self, ParamError> {
        Self::with_layout(storage, params)
    }
}

impl<'a, L: Layout> Table<'a, L> {
    /// A table on `storage`, [`Layout::WORDS`] words a cell. The words are taken as they are: [`clear`](Self::clear)
    /// them before the first use. Where storage begins at a multiple of 64 bytes, a cell of 64 is one line of the memory's
    /// caches; elsewhere it is part of two, and deposits into a large table take about a third longer.
    ///
    /// # Errors
    /// [`ParamError::TooShort`] below [`MIN_CELLS`] cells, [`ParamError::NotPowerOfTwo`] for words of another number of
    /// cells than a power of two, [`ParamError::OutOfRange`] above 2³¹ cells.
    pub fn with_layout(storage: &'a [Word], params: &Params) -> Result<Self, ParamError> {
        let words = storage.len();
        Self::check_words(words)?;
        let mask = (words / L::WORDS - 1) as u32;
        Ok(Self { words: storage, mask, max_probes: params.max_probes(), layout: PhantomData })
    }

    pub(crate) fn check_words(words: usize) -> Result<(), ParamError> {
        let least = MIN_CELLS * L::WORDS;
        if words < least {
            return Err(ParamError::TooShort { name: "storage", needed: least as u64, found: words as u64 });
        }
        if !words.is_multiple_of(L::WORDS) || !(words / L::WORDS).is_power_of_two() {
            return Err(ParamError::NotPowerOfTwo { name: "storage", value: words as u64 });
        }
        let max = f64::from(1_u32 << 31) * L::WORDS as f64;
        ParamError::check_range("storage", words as f64, least as f64, max)
    }

    /// Number of cells.
    pub const fn capacity(&self) -> usize {
        self.mask as usize + 1
    }

    /// Slots a key may try.
    pub const fn max_probes(&self) -> u32 {
        self.max_probes
    }

    /// Empties the table.
    pub fn clear(&self) {
        for slot in 0..self.capacity() {
            self.clear_cell(slot as u32);
        }
    }

    /// Empties one cell. Keys whose probe sequence passes it can no longer be found: for emptying whole tables in parts.
    pub fn clear_cell(&self, slot: u32) {
        let cell = self.cell_words(slot);
        word::set(&cell[0], u64::from(EMPTY) << 32);
        for sum in &cell[1..L::KEPT_AT] {
            word::set(sum, 0);
        }
        for spare in &cell[L::USED..] {
            word::set(spare, 0);
        }
        self.forget_key(slot);
    }

    #[inline]
    pub(crate) fn cell_words(&self, slot: u32) -> &'a [Word] {
        let first = slot as usize * L::WORDS;
        &self.words[first..first + L::WORDS]
    }

    /// The words that hold the key, none in most layouts.
    #[inline]
    pub(crate) fn key_words(&self, slot: u32) -> &'a [Word] {
        &self.cell_words(slot)[L::KEPT_AT..L::USED]
    }

    #[inline]
    pub(crate) fn forget_key(&self, slot: u32) {
        // Asked here, so that nothing is left of it in layouts without keys, not even a check of bounds.
        if L::Kept::WORDS > 0 {
            for word in self.key_words(slot) {
                word::set(word, u64::MAX);
            }
        }
    }

    /// Where the key's probe sequence begins.
    #[inline]
    pub fn home_slot(&self, key: &Key) -> u32 {
        home(key) & self.mask
    }

    /// Word 0 of a cell: for reading ahead.
    #[inline]
    pub fn head(&self, slot: u32) -> u64 {
        word::get(&self.words[slot as usize * L::WORDS])
    }

    /// Gives the key a cell, unless it has one or finds none within its probes.
    #[inline]
    pub fn claim(&self, key: &Key) -> Claim {
        let slot = self.home_slot(key);
        self.claim_from(slot, fingerprint(key), self.head(slot))
    }

    /// [`claim`](Self::claim) for a key given by home and fingerprint, with word 0 of its home as read before.
    #[inline]
    pub fn claim_from(&self, home_slot: u32, fingerprint: u32, head: u64) -> Claim {
        let mut slot = home_slot;
        let mut mine = NEW | tag(fingerprint, 0);
        // Whoever takes the slot from this key meanwhile finds it another.
        if ((head >> 32) as u32 ^ mine) & !NEW == 0 {
            return Claim::Found;
        }
        let mut placed = false;
        loop {
            let old = word::min_high(&self.words[slot as usize * L::WORDS], mine);
            if old > mine {
                // Whoever takes a slot in this phase forgets whose it was; names are given when the phase has ended.
                self.forget_key(slot);
            }
            if old == EMPTY {
                return Claim::Placed;
            }
            if (old ^ mine) & !NEW == 0 {
                return if placed { Claim::Placed } else { Claim::Found };
            }
            if old > mine {
                // The slot is mine; whom I displaced goes on from here.
                placed = true;
                mine = old;
            }
            if tag_distance(mine) + 1 >= self.max_probes {
                return Claim::Refused;
            }
            mine += 1;
            slot = (slot + 1) & self.mask;
        }
    }

    /// Looks for the key's cell.
    #[inline]
    pub fn find(&self, key: &Key) -> Found {
        self.find_at(self.home_slot(key), fingerprint(key))
    }

    /// [`find`](Self::find) for a key given by its home and fingerprint.
    #[inline]
    pub fn find_at(&self, home_slot: u32, fingerprint: u32) -> Found {
        self.find_from(home_slot, fingerprint, self.head(home_slot))
    }

    /// [`find_at`](Self::find_at) with word 0 of the home as read before (since the last claim).
    #[inline]
    pub fn find_from(&self, home_slot: u32, fingerprint: u32, home_head: u64) -> Found {
        let (mut slot, mut head) = (home_slot, home_head);
        for distance in 0..self.max_probes {
            let found = (head >> 32) as u32;
            if found == EMPTY {
                return Found { slot: None, probes: distance + 1, head };
            }
            if found & !NEW == tag(fingerprint, distance) {
                return Found { slot: Some(slot), probes: distance + 1, head };
            }
            slot = (slot + 1) & self.mask;
            head = self.head(slot);
        }
        Found { slot: None, probes: self.max_probes, head }
    }

    /// Adds `count` deposits of together `values` to a cell that [`find`](Self::find) returned with `head`, and settles
    /// it. The caller refuses what a [full](Found::is_full) cell can no longer take. Second moments take several deposits
    /// as equal; where direct and further light share a sum, `values` holds both as further light.
    #[inline]
    pub fn add(&self, slot: u32, head: u64, values: &Quanta, count: u32) {
        let cell = self.cell_words(slot);
        if (head >> 32) as u32 >= NEW {
            word::clear_high(&cell[0], NEW);
        }
        word::add_low(&cell[0], count);
        let sums = &cell[1..L::MOMENTS_AT];
        for (sum, value) in sums.iter().zip(&values[6 - L::SUMS..]) {
            // Most light has no share in most sums, and an atomic addition costs more than the question.
            if *value != 0 {
                word::add(sum, *value);
            }
        }
        if L::MOMENTS {
            let squares = if count == 1 { square(luminance(values)) } else { shared_square(values, count) };
            add_wide(&cell[L::MOMENTS_AT..], squares);
        }
    }

    /// Adds one vertex's illumination to the key's cell. False when the key has none, or the cell is full.
    pub fn deposit(&self, key: &Key, values: &Quanta) -> bool {
        let found = self.find(key);
        match found.slot {
            Some(slot) if !found.is_full() => {
                self.add(slot, found.head, values, 1);
                true
            }
            _ => false,
        }
    }

    /// The key's cell, if it has one.
    pub fn lookup(&self, key: &Key) -> Option<Cell> {
        self.find(key).slot.map(|slot| self.cell(slot))
    }

    /// What a slot holds.
    #[inline]
    pub fn cell(&self, slot: u32) -> Cell {
        let words = self.cell_words(slot);
        let head = word::get(&words[0]);
        let sum = |k: usize| word::get(&words[k]);
        let first = [sum(1), sum(2), sum(3)];
        let (direct, further) = if L::SPLIT { (first, [sum(4), sum(5), sum(6)]) } else { ([0; 3], first) };
        Cell { slot, tag: (head >> 32) as u32, count: head as u32, direct, further }
    }

    /// All occupied cells in the order of their slots.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<'a, L> {
        let table = *self;
        (0..=table.mask).map(move |slot| table.cell(slot)).filter(|cell| cell.tag != EMPTY)
    }

    /// Share of slots that are occupied, 0 to 1.
    pub fn load(&self) -> f32 {
        self.cells().count() as f32 / self.capacity() as f32
    }

    pub(crate) fn padding(&self, slot: u32) -> u64 {
        self.cell_words(slot)[L::USED..].iter().fold(0, |all, spare| all | word::get(spare))
    }

    pub(crate) const fn mask(&self) -> u32 {
        self.mask
    }
}

/// The sum of `count` equal squares, for deposits of together `values`.
const fn shared_square(values: &Quanta, count: u32) -> u128 {
    if count == 0 { 0 } else { square(luminance(values) / count as u64) * count as u128 }
}

/// Adds to a sum of two words, low word first.
#[inline]
fn add_wide(words: &[Word], value: u128) {
    let carry = word::add_carry(&words[0], value as u64);
    let high = (value >> 64) as u64 + carry;
    if high != 0 {
        word::add(&words[1], high);
    }
}
