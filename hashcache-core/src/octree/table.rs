//! Tables of blocks: two buckets of four entries a key.
//!
//! A bucket is twelve words: four keys, four occupancies, four bases. An empty entry has the key [`super::block::NO_KEY`].

use crate::hash::pcg2d;

/// Entries of a bucket. With four, and two buckets to choose from, tables can be filled to 0.97 (Dietzfelbinger &
/// Weidling 2007); with one, to 0.5.
pub const BUCKET_ENTRIES: u32 = 4;

/// Words of a bucket.
pub const BUCKET_WORDS: u32 = 3 * BUCKET_ENTRIES;

/// High word of a product.
#[inline]
pub const fn multiply_high(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// The two buckets in which a key may stand; they may be the same.
///
/// ```
/// # use hashcache_core::octree::table::bucket_pair;
/// assert!(bucket_pair(17, 0, 5).iter().all(|bucket| *bucket < 5));
/// ```
#[inline]
#[must_use]
pub const fn bucket_pair(key: u32, seed: u32, buckets: u32) -> [u32; 2] {
    let [a, b] = pcg2d([key, seed]);
    [multiply_high(a, buckets), multiply_high(b, buckets)]
}

/// An entry of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockEntry {
    /// One bit a cell.
    pub occupancy: u32,
    /// Index of the block's first cell; the others follow in the order of their bits.
    pub base: u32,
}

impl BlockEntry {
    /// Index of the cell with this bit, if it is occupied.
    #[inline]
    pub const fn index(self, bit: u32) -> Option<u32> {
        if self.occupancy & bit == 0 {
            return None;
        }
        Some(self.index_of(bit))
    }

    /// Index of the cell with this bit, which is occupied.
    #[inline]
    pub(crate) const fn index_of(self, bit: u32) -> u32 {
        self.base.wrapping_add((self.occupancy & (bit - 1)).count_ones())
    }
}

/// Where a key's entry stands in a table of whole buckets: the word of its key, counted from the table's first.
#[inline]
pub(crate) fn find(table: &[[u32; 12]], seed: u32, key: u32) -> Option<u32> {
    let [a, b] = bucket_pair(key, seed, table.len() as u32);
    // Both are looked at, so that the reads overlap.
    let (a, b) = (find_in(table, key, a), find_in(table, key, b));
    let place = if a == u32::MAX { b } else { a };
    (place != u32::MAX).then_some(place)
}

/// Where a key's entry stands if it is in this bucket; `u32::MAX` if not. The place among the four is found without a
/// branch.
#[inline]
pub(crate) fn find_in(table: &[[u32; 12]], key: u32, bucket: u32) -> u32 {
    let Some(words) = table.get(bucket as usize) else { return u32::MAX };
    // A fifth place stands for none, and all ones make `u32::MAX` of it.
    let place = (matches(words, key) | 1 << BUCKET_ENTRIES).trailing_zeros();
    (bucket * BUCKET_WORDS + place) | (place >> 2).wrapping_neg()
}

/// One bit for each entry of a bucket that has the key.
#[inline]
fn matches(bucket: &[u32; 12], key: u32) -> u32 {
    let bit = |at: usize| u32::from(bucket[at] == key) << at;
    bit(0) | bit(1) | bit(2) | bit(3)
}
