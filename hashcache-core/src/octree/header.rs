//! What stands before the tables: the grid, and a record for every level and map.

use bytemuck::{Pod, Zeroable};

use super::grid::Grid;

/// First word of every octree; the low byte counts layouts.
pub const MAGIC: u32 = 0x6f63_7401;

/// Words of [`Header`].
pub const HEADER_WORDS: usize = 16;

/// Words of [`LevelRecord`].
pub const LEVEL_WORDS: usize = 8;

/// Words of [`MapRecord`].
pub const MAP_WORDS: usize = 4;

/// Tables begin at multiples of so many words: a cache line.
pub const TABLE_ALIGNMENT: usize = 16;

/// The first words of an octree. [`LevelRecord`]s of all levels follow, then [`MapRecord`]s, then the tables.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Header {
    /// [`MAGIC`].
    pub magic: u32,
    /// Words of the whole octree.
    pub words: u32,
    /// Number of maps on all levels.
    pub maps: u32,
    /// Number of cells on all levels.
    pub cells: u32,
    /// The grid.
    pub grid: Grid,
}

/// What one level is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LevelRecord {
    /// The lowest corner of a block, in cells of this level; keys are relative to it.
    pub corner: [u32; 3],
    /// Log₂ of the number of maps along an axis.
    pub maps_log2: u32,
    /// Index of the first of its `8^maps_log2` maps; x runs fastest, then y.
    pub first_map: u32,
    /// Index of its first cell.
    pub first_cell: u32,
    /// Number of its cells.
    pub cells: u32,
    /// Zero.
    pub reserved: u32,
}

/// One table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MapRecord {
    /// Where its buckets begin, in words of the octree.
    pub first_word: u32,
    /// Number of buckets of [`super::table::BUCKET_WORDS`] words.
    pub buckets: u32,
    /// Chooses the pair of hash functions.
    pub seed: u32,
    /// Number of blocks.
    pub blocks: u32,
}

const _: () = assert!(
    size_of::<Header>() == 4 * HEADER_WORDS
        && size_of::<LevelRecord>() == 4 * LEVEL_WORDS
        && size_of::<MapRecord>() == 4 * MAP_WORDS
);

/// Words before the first table.
pub(crate) const fn records_words(levels: u32, maps: u32) -> usize {
    (HEADER_WORDS + levels as usize * LEVEL_WORDS + maps as usize * MAP_WORDS).next_multiple_of(TABLE_ALIGNMENT)
}
