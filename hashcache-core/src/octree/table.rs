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
pub struct Entry {
    /// One bit a cell.
    pub occupancy: u32,
    /// Index of the block's first cell; the others follow in the order of their bits.
    pub base: u32,
}

impl Entry {
    /// Index of the cell with this bit, if it is occupied.
    #[inline]
    pub const fn index(&self, bit: u32) -> Option<u32> {
        if self.occupancy & bit == 0 {
            return None;
        }
        Some(self.base + (self.occupancy & (bit - 1)).count_ones())
    }
}

/// The word of the entry with this key, counted from the bucket's first word, if the bucket has it.
#[inline]
pub(crate) fn find_in_bucket(keys: &[u32], key: u32) -> Option<usize> {
    keys.iter().position(|found| *found == key)
}

/// A key's entry in the table `buckets`.
#[inline]
pub(crate) fn find(table: &[u32], seed: u32, buckets: u32, key: u32) -> Option<Entry> {
    for bucket in bucket_pair(key, seed, buckets) {
        let first = (bucket * BUCKET_WORDS) as usize;
        let words = table.get(first..first + BUCKET_WORDS as usize)?;
        if let Some(at) = find_in_bucket(&words[..4], key) {
            return Some(Entry { occupancy: words[4 + at], base: words[8 + at] });
        }
    }
    None
}
