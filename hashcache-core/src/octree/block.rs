//! Blocks of 4×4×2 cells: their keys and bits.

use super::grid::{BLOCK, MAP_BITS};
use super::header::LevelRecord;

/// The key of an empty table entry; keys have 31 bits.
pub const NO_KEY: u32 = u32::MAX;

/// Bits of a key for the block's x, and for its y; z has one more.
pub const KEY_BITS: u32 = 10;

/// The bit of a cell within its block's occupancy word: x in bits 0..2 of its number, y in 2..4, z in 4.
///
/// ```
/// # use hashcache_core::octree::block::cell_bit;
/// assert_eq!(cell_bit([5, 6, 7]), 1 << (1 | 2 << 2 | 1 << 4));
/// ```
#[inline]
pub const fn cell_bit(coordinates: [u32; 3]) -> u32 {
    1 << ((coordinates[0] & 3) | ((coordinates[1] & 3) << 2) | ((coordinates[2] & 1) << 4))
}

/// The key of a block within its map, from the block's position in blocks: x in bits 0..10, y in 10..20, z in 20..31.
/// Higher bits of the position tell maps apart and are left out.
///
/// ```
/// # use hashcache_core::octree::block::block_key;
/// assert_eq!(block_key([1, 2, 3]), 1 | 2 << 10 | 3 << 20);
/// ```
#[inline]
pub const fn block_key(block: [u32; 3]) -> u32 {
    (block[0] & 1023) | ((block[1] & 1023) << 10) | ((block[2] & 2047) << 20)
}

/// The block's position within its map: the inverse of [`block_key`].
#[inline]
#[must_use]
pub const fn key_block(key: u32) -> [u32; 3] {
    [key & 1023, (key >> 10) & 1023, (key >> 20) & 2047]
}

/// A key with its bits interleaved (x lowest), so that blocks that are near in space are near in order.
#[inline]
pub const fn morton(key: u32) -> u32 {
    let [x, y, z] = key_block(key);
    spread(x) | (spread(y) << 1) | (spread(z & 1023) << 2) | ((z >> 10) << 30)
}

/// The inverse of [`morton`].
///
/// ```
/// # use hashcache_core::octree::block::{from_morton, morton};
/// assert_eq!(from_morton(morton(0x5432_1abc)), 0x5432_1abc);
/// ```
#[inline]
pub const fn from_morton(code: u32) -> u32 {
    block_key([gather(code), gather(code >> 1), gather((code & 0x3fff_ffff) >> 2) | ((code >> 30) << 10)])
}

/// Ten bits, two zeros between each.
const fn spread(v: u32) -> u32 {
    let v = (v | (v << 16)) & 0x0300_00ff;
    let v = (v | (v << 8)) & 0x0300_f00f;
    let v = (v | (v << 4)) & 0x030c_30c3;
    (v | (v << 2)) & 0x0924_9249
}

/// Every third bit of thirty.
const fn gather(v: u32) -> u32 {
    let v = v & 0x0924_9249;
    let v = (v | (v >> 2)) & 0x030c_30c3;
    let v = (v | (v >> 4)) & 0x0300_f00f;
    let v = (v | (v >> 8)) & 0x0300_00ff;
    (v | (v >> 16)) & 1023
}

/// The bits that a block's cells occupy in the block of the next coarser level: 2×2×1 of its cells.
#[inline]
pub const fn parent_occupancy(block: [u32; 3], occupancy: u32) -> u32 {
    let mut bits = 0;
    let mut quarter = 0;
    while quarter < 4 {
        // Cells of a quarter: two in x, two in y, both in z.
        let shift = (quarter & 1) * 2 + (quarter >> 1) * 8;
        if (occupancy >> shift) & 0x0033_0033 != 0 {
            bits |= 1 << ((quarter & 1) | ((quarter >> 1) << 2));
        }
        quarter += 1;
    }
    bits << (((block[0] & 1) << 1) | ((block[1] & 1) << 3) | ((block[2] & 1) << 4))
}

/// A block of an octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockRef {
    /// Its lowest cell, in cells of its level.
    pub corner: [u32; 3],
    /// One bit a cell.
    pub occupancy: u32,
    /// Index of its first cell; the others follow in the order of their bits.
    pub base: u32,
}

impl BlockRef {
    pub(crate) fn new(level: &LevelRecord, map: u32, bucket: &[u32], at: usize) -> Option<Self> {
        let key = bucket[at];
        if key == NO_KEY {
            return None;
        }
        let mask = (1 << level.maps_log2) - 1;
        let map = [map & mask, (map >> level.maps_log2) & mask, map >> (2 * level.maps_log2)];
        let block = key_block(key);
        let corner =
            core::array::from_fn(|axis| level.corner[axis] + (map[axis] << MAP_BITS) + block[axis] * BLOCK[axis]);
        Some(Self { corner, occupancy: bucket[4 + at], base: bucket[8 + at] })
    }

    /// Its cells: coordinates and index, in the order of indices.
    pub fn cells(self) -> impl Iterator<Item = ([u32; 3], u32)> {
        let [x, y, z] = self.corner;
        let bits = (0..32_u32).filter(move |bit| self.occupancy >> bit & 1 != 0);
        bits.zip(self.base..).map(move |(bit, index)| ([x + (bit & 3), y + (bit >> 2 & 3), z + (bit >> 4)], index))
    }
}
