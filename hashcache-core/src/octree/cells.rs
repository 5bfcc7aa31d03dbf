//! Cells in borrowed storage: plain records to read, words to merge into.

use core::marker::PhantomData;
use core::slice;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use super::cell::CellRecord;

/// Cells that can be read while nobody merges.
pub trait ReadCells<C: CellRecord> {
    /// The cell with this index; an empty one behind the last.
    fn get(&self, index: u32) -> C;

    /// Its normal alone.
    fn normal(&self, index: u32) -> u32;
}

impl<C: CellRecord> ReadCells<C> for [C] {
    #[inline]
    fn get(&self, index: u32) -> C {
        self.as_ref().get(index as usize).copied().unwrap_or_else(C::zeroed)
    }

    #[inline]
    fn normal(&self, index: u32) -> u32 {
        self.as_ref().get(index as usize).map_or(0, CellRecord::normal)
    }
}

/// Cells whose words threads may share: each cell is written by one thread at a time, and relaxed accesses say so
/// without unsafe code, at the price of plain ones.
#[derive(Clone, Copy, Debug)]
pub struct SharedCells<'a, C> {
    words: &'a [AtomicU32],
    layout: PhantomData<C>,
}

impl<'a, C: CellRecord> SharedCells<'a, C> {
    /// Cells in `words`, [`CellRecord::WORDS`] each; words that are no whole cell are left out.
    pub const fn new(words: &'a [AtomicU32]) -> Self {
        Self { words, layout: PhantomData }
    }

    #[inline]
    fn words_of(&self, index: u32) -> Option<&'a [AtomicU32]> {
        let first = index as usize * C::WORDS;
        self.words.get(first..first + C::WORDS)
    }

    /// Replaces a cell; one behind the last is left out.
    #[inline]
    pub fn set(&self, index: u32, cell: &C) {
        let words: &[u32] = bytemuck::cast_slice(slice::from_ref(cell));
        for (to, from) in self.words_of(index).into_iter().flatten().zip(words) {
            to.store(*from, Relaxed);
        }
    }
}

impl<C: CellRecord> ReadCells<C> for SharedCells<'_, C> {
    #[inline]
    fn get(&self, index: u32) -> C {
        let mut cell = C::zeroed();
        let words: &mut [u32] = bytemuck::cast_slice_mut(slice::from_mut(&mut cell));
        for (to, from) in words.iter_mut().zip(self.words_of(index).into_iter().flatten()) {
            *to = from.load(Relaxed);
        }
        cell
    }

    #[inline]
    fn normal(&self, index: u32) -> u32 {
        self.words_of(index).map_or(0, |words| words[C::NORMAL_WORD].load(Relaxed))
    }
}
