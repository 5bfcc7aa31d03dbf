//! Light that was recorded and not merged yet: exact sums of the cells that a frame touches.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use crate::counters::Counters;
use crate::error::ParamError;
use crate::exact::{carry, hi, lo, pair};
use crate::level::MAX_LEVEL;

/// Words before the cells' marks: entries of each level's list, then the counters.
pub const HEAD_WORDS: usize = 128;

/// Words of an entry of a list, sums and place together.
pub const ENTRY_WORDS: usize = SUM_WORDS + PLACE_WORDS;

/// Most records of a frame: the sums of two clamped values each, 2³⁴ quanta, stay below 2⁶⁴.
pub const MAX_RECORDS: u32 = 1 << 28;

/// Levels that have a list: one more than cells have levels.
const LISTS: usize = MAX_LEVEL as usize + 2;

/// First word of the counters.
const COUNTERS: usize = 64;

/// Words of an entry's sums: a cache line.
const SUM_WORDS: usize = 16;

/// Words of an entry's place: 21 bits for each coordinate of the finest level.
const PLACE_WORDS: usize = 2;

/// In an entry: counts of front and back.
const COUNT: usize = 12;

/// In an entry: whose it is.
const OWNER: usize = 14;

/// In an entry without a cell: the normal of the sample.
const NORMAL: usize = 15;

/// Owner of an entry that was reserved and not used.
const NOBODY: u32 = 0;

/// Owner of an entry whose light waits for a level that has a cell there.
const HOMELESS: u32 = u32::MAX;

const _: () = assert!(LISTS <= COUNTERS && COUNTERS + 2 * Counters::WORDS <= HEAD_WORDS);

/// Whose light an entry holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A cell's.
    Cell(u32),
    /// One sample's, with this normal, that has no cell on this level; its light stands in front.
    Sample(u32),
}

/// What an entry holds: for front and back the sums of red, green, blue in quanta, and the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) owner: Owner,
    pub(crate) place: [u32; 3],
    pub(crate) sums: [[u64; 3]; 2],
    pub(crate) counts: [u32; 2],
}

/// The light of an open frame on borrowed storage, which threads share.
///
/// `marks` are [`HEAD_WORDS`] words and one for each cell: 0, or 1 + the number of the cell's entry. `lists` are two
/// lists of entries, [`ENTRY_WORDS`] words each: the cells of one level that were touched, and those of the next coarser
/// one while the first is merged. All words are 0 before the first frame, and, but for the counters, after each.
///
/// | words of an entry's line | meaning |
/// |---|---|
/// | 0..6 | front: sums of red, green, blue, low word first |
/// | 6..12 | back, likewise |
/// | 12, 13 | number of samples: front, back |
/// | 14 | 1 + index of the cell; 0: not used; 2³² − 1: one sample without a cell |
/// | 15 | normal of the sample without a cell |
///
/// The lines of the first list stand first, then those of the second, then the places: two words an entry, 21 bits for
/// each coordinate of the cell, or of the finest one below it.
///
/// Which entry a cell gets depends on threads; what is summed there does not.
#[derive(Clone, Copy, Debug)]
pub struct Pending<'a> {
    marks: &'a [AtomicU32],
    lists: &'a [AtomicU32],
    capacity: u32,
}

impl<'a> Pending<'a> {
    /// The light of a frame in `marks` and `lists`, for an octree of `cells` cells. [`Pending::words`] gives the lengths.
    ///
    /// # Errors
    /// [`ParamError::TooShort`] when the marks do not suffice or there is no room for an entry.
    pub fn new(marks: &'a [AtomicU32], lists: &'a [AtomicU32], cells: u32) -> Result<Self, ParamError> {
        let [needed, room] = Self::words(cells, 1);
        if (marks.len() as u64) < needed {
            return Err(ParamError::TooShort { name: "marks", needed, found: marks.len() as u64 });
        }
        if (lists.len() as u64) < room {
            return Err(ParamError::TooShort { name: "lists", needed: room, found: lists.len() as u64 });
        }
        let capacity = (lists.len() / (2 * ENTRY_WORDS)).min(MAX_RECORDS as usize) as u32;
        Ok(Self { marks, lists, capacity })
    }

    /// Lengths of `marks` and `lists` for an octree of `cells` cells and frames of up to `records` records.
    #[must_use]
    pub const fn words(cells: u32, records: u32) -> [u64; 2] {
        [HEAD_WORDS as u64 + cells as u64, 2 * ENTRY_WORDS as u64 * records as u64]
    }

    /// Records of a frame for which there is room.
    pub const fn capacity(&self) -> u32 {
        self.capacity
    }

    /// Adds to the counters.
    pub fn add_counters(&self, counters: &Counters) {
        add_counters(self.marks, counters);
    }

    /// The counters since they were last reset.
    pub fn counters(&self) -> Counters {
        counters_in(self.marks)
    }

    /// Where the counters stand in `marks`: first word and number of words.
    #[must_use]
    pub const fn counter_words() -> [usize; 2] {
        [COUNTERS, 2 * Counters::WORDS]
    }

    /// Entries of a level's list.
    pub(crate) fn len(&self, level: u32) -> u32 {
        self.marks[level as usize].load(Relaxed).min(self.capacity)
    }

    pub(crate) fn forget(&self, level: u32) {
        self.marks[level as usize].store(0, Relaxed);
    }

    /// Reserves `count` entries of a level; the number of the first.
    #[inline]
    pub(crate) fn reserve(&self, level: u32, count: u32) -> Reserved {
        let next = if count == 0 { 0 } else { self.marks[level as usize].fetch_add(count, Relaxed) };
        Reserved { next, end: next.saturating_add(count).min(self.capacity) }
    }

    /// The cell's mark: 0 while it has no entry.
    #[inline]
    pub(crate) fn mark(&self, cell: u32) -> u32 {
        self.marks[HEAD_WORDS + cell as usize].load(Relaxed)
    }

    pub(crate) fn unmark(&self, cell: u32) {
        self.marks[HEAD_WORDS + cell as usize].store(0, Relaxed);
    }

    /// The entry that collects light for `owner`: the one there is, or the next reserved one. `None` when none is left.
    #[inline]
    pub(crate) fn claim(&self, level: u32, owner: Owner, place: [u32; 3], reserved: &mut Reserved) -> Option<u32> {
        let Owner::Cell(cell) = owner else {
            let own = reserved.take()?;
            self.write(level, own, owner, place);
            return Some(own);
        };
        let mark = &self.marks[HEAD_WORDS + cell as usize];
        let found = mark.load(Relaxed);
        if found != 0 {
            return Some(found - 1);
        }
        let own = reserved.peek()?;
        match mark.compare_exchange(0, own + 1, Relaxed, Relaxed) {
            Ok(_) => {
                reserved.take();
                self.write(level, own, owner, place);
                Some(own)
            }
            Err(found) => Some(found - 1),
        }
    }

    fn write(&self, level: u32, entry: u32, owner: Owner, place: [u32; 3]) {
        let line = self.line(level, entry);
        match owner {
            Owner::Cell(cell) => line[OWNER].store(cell + 1, Relaxed),
            Owner::Sample(normal) => {
                line[OWNER].store(HOMELESS, Relaxed);
                line[NORMAL].store(normal, Relaxed);
            }
        }
        let [x, y, z] = place.map(u64::from);
        let packed = x | (y << 21) | (z << 42);
        let words = self.place(level, entry);
        words[0].store(lo(packed), Relaxed);
        words[1].store(hi(packed), Relaxed);
    }

    /// Adds sums and a count to one side of an entry.
    #[inline]
    pub(crate) fn add(&self, level: u32, entry: u32, side: usize, sums: [u64; 3], count: u32) {
        let line = self.line(level, entry);
        for (to, sum) in line[6 * side..6 * side + 6].chunks_exact(2).zip(sums) {
            add64(to, sum);
        }
        line[COUNT + side].fetch_add(count, Relaxed);
    }

    /// What an entry holds, if it is used; it is empty afterwards.
    #[inline]
    pub(crate) fn take(&self, level: u32, entry: u32) -> Option<Entry> {
        let line = self.line(level, entry);
        let owner = match line[OWNER].load(Relaxed) {
            NOBODY => return None,
            HOMELESS => Owner::Sample(line[NORMAL].load(Relaxed)),
            cell => Owner::Cell(cell - 1),
        };
        let sum = |k: usize| pair(line[k].load(Relaxed), line[k + 1].load(Relaxed));
        let sums = [[sum(0), sum(2), sum(4)], [sum(6), sum(8), sum(10)]];
        let counts = [line[COUNT].load(Relaxed), line[COUNT + 1].load(Relaxed)];
        let words = self.place(level, entry);
        let packed = pair(words[0].load(Relaxed), words[1].load(Relaxed));
        let place = [packed, packed >> 21, packed >> 42].map(|v| v as u32 & 0x001f_ffff);
        for word in line {
            word.store(0, Relaxed);
        }
        Some(Entry { owner, place, sums, counts })
    }

    #[inline]
    fn line(&self, level: u32, entry: u32) -> &'a [AtomicU32] {
        let first = (self.first(level) + entry as usize) * SUM_WORDS;
        &self.lists[first..first + SUM_WORDS]
    }

    #[inline]
    fn place(&self, level: u32, entry: u32) -> &'a [AtomicU32] {
        let lines = 2 * self.capacity as usize * SUM_WORDS;
        let first = lines + (self.first(level) + entry as usize) * PLACE_WORDS;
        &self.lists[first..first + PLACE_WORDS]
    }

    /// Entries before those of the level's list.
    #[inline]
    const fn first(&self, level: u32) -> usize {
        (level & 1) as usize * self.capacity as usize
    }
}

/// Entries that were reserved and not used yet.
#[derive(Debug)]
pub(crate) struct Reserved {
    next: u32,
    end: u32,
}

impl Reserved {
    #[inline]
    fn peek(&self) -> Option<u32> {
        (self.next < self.end).then_some(self.next)
    }

    #[inline]
    fn take(&mut self) -> Option<u32> {
        let next = self.peek();
        self.next += 1;
        next
    }
}

/// Adds to the counters that stand in the first [`HEAD_WORDS`] words of `marks`; fewer words are left alone.
pub(crate) fn add_counters(marks: &[AtomicU32], counters: &Counters) {
    for (to, from) in marks.get(COUNTERS..).unwrap_or_default().chunks_exact(2).zip(counters.words()) {
        add64(to, *from);
    }
}

/// The counters in `marks`.
pub(crate) fn counters_in(marks: &[AtomicU32]) -> Counters {
    let mut words = [0; Counters::WORDS];
    for (to, from) in words.iter_mut().zip(marks.get(COUNTERS..).unwrap_or_default().chunks_exact(2)) {
        *to = pair(from[0].load(Relaxed), from[1].load(Relaxed));
    }
    Counters::from_words(&words)
}

/// Adds to a pair of words, low word first.
#[inline]
fn add64(to: &[AtomicU32], value: u64) {
    // Most light has no share in most sums, and an atomic addition costs more than the question.
    if value == 0 {
        return;
    }
    let high = carry(to[0].fetch_add(lo(value), Relaxed), value);
    if high != 0 {
        to[1].fetch_add(high, Relaxed);
    }
}
