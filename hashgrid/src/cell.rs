//! What stands in a cell beside light: read, noted, and written while nobody else works on the table.

use crate::key::Key;
use crate::layout::{Keep, Layout};
use crate::sums::Sums;
use crate::table::Table;
use crate::tag::NEW;
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
}

fn get_wide(words: &[Word]) -> u128 {
    u128::from(word::get(&words[1])) << 64 | u128::from(word::get(&words[0]))
}

fn set_wide(words: &[Word], value: u128) {
    word::set(&words[0], value as u64);
    word::set(&words[1], (value >> 64) as u64);
}
