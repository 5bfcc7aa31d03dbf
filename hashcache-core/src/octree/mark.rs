//! Marks the cells that triangles overlap, on many threads at once.

use core::sync::atomic::AtomicU64;
use core::sync::atomic::Ordering::Relaxed;

use super::block::block_key;
use super::table::multiply_high;
use crate::hash::finish;

/// Set in the word of a block, so that it is not 0, which is an empty slot.
const TAKEN: u64 = 1 << 63;

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
    /// [`Full`] when every word belongs to another block.
    #[inline]
    pub fn mark(&self, block: [u32; 3], occupancy: u32) -> Result<Added, Full> {
        let key = block_key(block);
        let head = TAKEN | (u64::from(key) << 32);
        let new = head | u64::from(occupancy);
        let count = self.words.len();
        let mut slot = multiply_high(finish(key.wrapping_mul(0x9e37_79b1)), count as u32) as usize;
        for _ in 0..count {
            let word = &self.words[slot];
            let mut found = word.load(Relaxed);
            if found == 0 {
                match word.compare_exchange(0, new, Relaxed, Relaxed) {
                    Ok(_) => return Ok(Added { blocks: 1, cells: occupancy.count_ones() }),
                    Err(now) => found = now,
                }
            }
            if found >> 32 == head >> 32 {
                if occupancy & !(found as u32) != 0 {
                    found = word.fetch_or(u64::from(occupancy), Relaxed);
                }
                return Ok(Added { blocks: 0, cells: (occupancy & !(found as u32)).count_ones() });
            }
            slot = if slot + 1 == count { 0 } else { slot + 1 };
        }
        Err(Full)
    }

    /// Key and occupancy of every marked block, in no particular order.
    pub fn blocks(&self) -> impl Iterator<Item = (u32, u32)> + use<'a> {
        let words = self.words.iter().map(|word| word.load(Relaxed));
        words.filter(|word| *word != 0).map(|word| ((word >> 32) as u32 & !(1 << 31), word as u32))
    }
}
