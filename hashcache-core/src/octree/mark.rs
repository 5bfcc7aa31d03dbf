//! Marks the cells that triangles overlap, on many threads at once.

use core::sync::atomic::AtomicU64;
use core::sync::atomic::Ordering::Relaxed;

use super::block::block_key;
use super::table::multiply_high;
use crate::hash::finish;

/// Set in the word of a block, so that it is not 0, which is an empty slot.
const TAKEN: u64 = 1 << 63;

/// Words looked at before a table counts as full: at three quarters of its words taken, a key in a thousand million has
/// to go farther.
pub const MAX_PROBES: usize = 256;

/// Blocks of one map, in an open-addressing table in borrowed words that were zero before: occupancy in the low half, the
/// key above it. Bits are only ever set, so that the marked cells do not depend on order.
#[derive(Clone, Copy, Debug)]
pub struct Marks<'a> {
    words: &'a [AtomicU64],
}

/// The table has no place for another block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// What a mark added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Added {
    /// 1 when the block is new.
    pub blocks: u32,
    /// Cells that were not marked before.
    pub cells: u32,
}

impl<'a> Marks<'a> {
    /// A table in `words`: any number of them, all zero or marked before.
    pub const fn new(words: &'a [AtomicU64]) -> Self {
        Self { words }
    }

    /// Marks cells of the block at a position within its map.
    ///
    /// # Errors
    /// [`Full`] when the first [`MAX_PROBES`] words on its way belong to other blocks.
    #[inline]
    pub fn mark(&self, block: [u32; 3], occupancy: u32) -> Result<Added, Full> {
        let home = self.home(block);
        self.mark_from(home, self.head(home), block, occupancy)
    }

    /// The slot at which the search for a block begins.
    #[inline]
    pub(crate) fn home(&self, block: [u32; 3]) -> u32 {
        multiply_high(finish(block_key(block).wrapping_mul(0x9e37_79b1)), self.words.len() as u32)
    }

    /// The word of a slot.
    #[inline]
    pub(crate) fn head(&self, slot: u32) -> u64 {
        self.words.get(slot as usize).map_or(0, |word| word.load(Relaxed))
    }

    /// [`Marks::mark`] with the home slot and a word that stood there.
    #[inline]
    pub(crate) fn mark_from(&self, home: u32, head: u64, block: [u32; 3], occupancy: u32) -> Result<Added, Full> {
        let mine = TAKEN | (u64::from(block_key(block)) << 32);
        let (mut slot, mut found) = (home as usize, head);
        for _ in 0..self.words.len().min(MAX_PROBES) {
            let word = &self.words[slot];
            if found == 0 {
                match word.compare_exchange(0, mine | u64::from(occupancy), Relaxed, Relaxed) {
                    Ok(_) => return Ok(Added { blocks: 1, cells: occupancy.count_ones() }),
                    Err(now) => found = now,
                }
            }
            if found >> 32 == mine >> 32 {
                if occupancy & !(found as u32) != 0 {
                    found = word.fetch_or(u64::from(occupancy), Relaxed);
                }
                return Ok(Added { blocks: 0, cells: (occupancy & !(found as u32)).count_ones() });
            }
            slot = if slot + 1 == self.words.len() { 0 } else { slot + 1 };
            found = self.words[slot].load(Relaxed);
        }
        Err(Full)
    }

    /// Key and occupancy of every marked block, in no particular order.
    pub fn blocks(&self) -> impl Iterator<Item = (u32, u32)> + use<'a> {
        let words = self.words.iter().map(|word| word.load(Relaxed));
        words.filter(|word| *word != 0).map(|word| ((word >> 32) as u32 & !(1 << 31), word as u32))
    }
}
