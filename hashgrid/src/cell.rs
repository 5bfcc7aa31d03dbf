//! What stands in a cell beside light: read, noted, and written while nobody else works on the table.

use crate::key::Key;
use crate::layout::{Keep, Layout};
use crate::names::Naming;
use crate::sums::Sums;
use crate::table::{Claim, Table};
use crate::tag::{EMPTY, NEW, tag_distance};
use crate::temporal::Change;
use crate::word::{self, Word};

impl<L: Layout> Table<'_, L> {
    /// All that was deposited in a cell. Where direct and further light share sums, they are the further light's.
    pub fn sums(&self, slot: u32) -> Sums {
        let (words, cell) = (self.cell_words(slot), self.cell(slot));
        let ([a, b, c], [d, e, f]) = (cell.direct, cell.further);
        let squares = if L::MOMENTS { get_wide(&words[L::MOMENTS_AT..]) } else { 0 };
        Sums { count: cell.count, light: [a, b, c, d, e, f], squares }
    }

    /// Writes a cell's sums, and settles it if there are deposits among them. While one thread works on this cell and no
    /// claims or deposits are under way.
    pub fn set_sums(&self, slot: u32, sums: &Sums) {
        let words = self.cell_words(slot);
        let tag = (self.head(slot) >> 32) as u32;
        let tag = if sums.count > 0 { tag & !NEW } else { tag };
        word::set(&words[0], (u64::from(tag) << 32) | u64::from(sums.count));
        for (to, sum) in words[1..L::MOMENTS_AT].iter().zip(&sums.light[6 - L::SUMS..]) {
            word::set(to, *sum);
        }
        if L::MOMENTS {
            set_wide(&words[L::MOMENTS_AT..], sums.squares);
        }
    }

    /// The frame of the cell's last use, as [`touch`](Self::touch) noted it; 0 in layouts without
    /// [stamps](Layout::STAMP).
    pub fn stamp(&self, slot: u32) -> u32 {
        if L::STAMP { word::get(&self.cell_words(slot)[L::STAMP_AT]) as u32 } else { 0 }
    }

    /// Notes that the cell was used in this frame, by any number of threads that note the same frame. Does nothing in
    /// layouts without [stamps](Layout::STAMP).
    #[inline]
    pub fn touch(&self, slot: u32, frame: u32) {
        // Asked first: a line that is only read stays in all cores' caches.
        if L::STAMP && self.stamp(slot) != frame {
            word::set(&self.cell_words(slot)[L::STAMP_AT], u64::from(frame));
        }
    }

    /// What re-evaluated paths told of the cell; nothing in layouts without [changes](Layout::CHANGES).
    pub fn change(&self, slot: u32) -> Change {
        if !L::CHANGES {
            return Change::default();
        }
        let words = &self.cell_words(slot)[L::CHANGES_AT..];
        Change { difference: word::get(&words[0]), magnitude: word::get(&words[1]) }
    }

    /// Adds what a re-evaluated path tells, by any number of threads. Does nothing in layouts without
    /// [changes](Layout::CHANGES).
    #[inline]
    pub fn add_change(&self, slot: u32, change: Change) {
        if L::CHANGES {
            let words = &self.cell_words(slot)[L::CHANGES_AT..];
            word::add(&words[0], change.difference);
            word::add(&words[1], change.magnitude);
        }
    }

    /// The cell's key, where the layout [keeps](Layout::Kept) keys and the cell has been [named](crate::names).
    pub fn key(&self, slot: u32) -> Option<Key> {
        L::Kept::read(self.key_words(slot))
    }

    /// Empties a cell and moves up the cells behind it whose probe sequence it was on, so that no gap keeps them from
    /// being found. While nobody else works on the table; between frames, not between claims and deposits, whose order
    /// of new keys it does not keep.
    ///
    /// # Source
    /// Knuth 1998, section 6.4, algorithm R.
    pub fn remove(&self, slot: u32) {
        let (mask, mut hole, mut distance) = (self.mask(), slot, 1);
        while distance < self.max_probes() {
            let from = (hole + distance) & mask;
            let head = self.head(from);
            let tag = (head >> 32) as u32;
            if tag == EMPTY {
                break;
            }
            if tag_distance(tag) < distance {
                distance += 1;
                continue;
            }
            let (to_words, from_words) = (self.cell_words(hole), self.cell_words(from));
            word::set(&to_words[0], head - (u64::from(distance) << 32));
            for (to, from) in to_words.iter().zip(from_words).skip(1) {
                word::set(to, word::get(from));
            }
            (hole, distance) = (from, 1);
        }
        self.clear_cell(hole);
    }

    /// Claims and names a cell for the key, or finds the one it has, while nobody else works on the table and every cell
    /// has deposits. `None` when the table has no room or another key has the tag.
    pub(crate) fn open(&self, key: &Key) -> Option<u32> {
        if self.claim(key) == Claim::Refused {
            return None;
        }
        self.name(key, Naming::First);
        self.name(key, Naming::Second);
        self.find_named(key)
    }

    /// Marks a cell for eviction; the next [`touch`](Self::touch) of another frame wipes the mark.
    pub(crate) fn mark(&self, slot: u32) {
        let word = &self.cell_words(slot)[L::STAMP_AT];
        word::set(word, word::get(word) | MARK);
    }

    pub(crate) fn is_marked(&self, slot: u32) -> bool {
        word::get(&self.cell_words(slot)[L::STAMP_AT]) & MARK != 0
    }
}

/// In the stamp's upper half: to be evicted.
const MARK: u64 = 1 << 32;

fn get_wide(words: &[Word]) -> u128 {
    u128::from(word::get(&words[1])) << 64 | u128::from(word::get(&words[0]))
}

fn set_wide(words: &[Word], value: u128) {
    word::set(&words[0], value as u64);
    word::set(&words[1], (value >> 64) as u64);
}
