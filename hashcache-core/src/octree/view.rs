//! An octree in borrowed words.

use core::ops::Range;

use glam::Vec3;

use super::block::{BlockRef, NO_KEY, block_key, cell_bit};
use super::error::OctreeError;
use super::grid::Grid;
use super::header::{HEADER_WORDS, Header, LEVEL_WORDS, LevelRecord, MAGIC, MAP_WORDS, MapRecord, records_words};
use super::table::{BUCKET_ENTRIES, BUCKET_WORDS, BlockEntry, bucket_pair, find, find_in};

/// Stands for "no cell" where indices are stored; no octree has so many.
pub const NO_CELL: u32 = u32::MAX;

/// Cells that are looked up together: enough to keep the memory busy, few enough to stay in registers' reach.
pub(crate) const BATCH: usize = 64;

/// An octree in borrowed words: which cells exist, and the index of each.
#[derive(Clone, Copy, Debug)]
pub struct Octree<'a> {
    words: &'a [u32],
    grid: Grid,
    cells: u32,
    levels: &'a [LevelRecord],
    maps: &'a [MapRecord],
}

impl<'a> Octree<'a> {
    /// Looks at words that an octree was built in.
    ///
    /// Checks the header and that all records point into the words, so that lookups stay inside whatever the tables
    /// hold; [`Octree::validate`] checks the tables.
    ///
    /// # Errors
    /// [`OctreeError::Header`], [`OctreeError::TooShort`], [`OctreeError::Level`], [`OctreeError::Map`].
    pub fn new(words: &'a [u32]) -> Result<Self, OctreeError> {
        let Some((first, rest)) = words.split_at_checked(HEADER_WORDS) else {
            return Err(OctreeError::TooShort { words: words.len() as u64, needed: HEADER_WORDS as u64 });
        };
        let header: Header = bytemuck::pod_read_unaligned(bytemuck::cast_slice(first));
        let grid = header.grid;
        let sound = header.magic == MAGIC
            && grid.resolution.is_power_of_two()
            && (super::grid::MIN_RESOLUTION..=super::grid::MAX_RESOLUTION).contains(&grid.resolution)
            && grid.levels == grid.resolution.ilog2() + 2
            && grid.maps_log2 == grid.resolution.ilog2().saturating_sub(super::grid::MAP_BITS)
            && grid.recip_cell > 0.0
            && grid.recip_cell.is_finite();
        if !sound {
            return Err(OctreeError::Header);
        }
        let maps_before = |level: u32| (0..level).map(|l| 1_u32 << (3 * grid.level_maps_log2(l))).sum::<u32>();
        if header.maps != maps_before(grid.levels) {
            return Err(OctreeError::Header);
        }
        let needed = records_words(grid.levels, header.maps).max(header.words as usize);
        if words.len() < needed {
            return Err(OctreeError::TooShort { words: words.len() as u64, needed: needed as u64 });
        }
        let (levels, rest) = rest.split_at(grid.levels as usize * LEVEL_WORDS);
        let levels: &[LevelRecord] = bytemuck::cast_slice(levels);
        let maps: &[MapRecord] = bytemuck::cast_slice(&rest[..header.maps as usize * MAP_WORDS]);
        let mut first_cell = 0_u32;
        for (level, record) in (0..).zip(levels) {
            let sound = record.maps_log2 == grid.level_maps_log2(level)
                && record.first_map == maps_before(level)
                && record.corner == grid.level_corner(level)
                && record.first_cell == first_cell;
            first_cell = first_cell.checked_add(record.cells).filter(|_| sound).ok_or(OctreeError::Level { level })?;
        }
        if first_cell != header.cells {
            return Err(OctreeError::Header);
        }
        for (map, record) in (0..).zip(maps) {
            let end = u64::from(record.first_word) + u64::from(record.buckets) * u64::from(BUCKET_WORDS);
            if end > u64::from(header.words) {
                return Err(OctreeError::Map { map });
            }
        }
        Ok(Self { words: &words[..header.words as usize], grid, cells: header.cells, levels, maps })
    }

    /// The words: header, records and tables.
    pub const fn words(&self) -> &'a [u32] {
        self.words
    }

    /// Where the cells lie.
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of cells on all levels; indices are below it.
    pub const fn cells(&self) -> u32 {
        self.cells
    }

    /// The records of all levels, the finest first.
    pub const fn levels(&self) -> &'a [LevelRecord] {
        self.levels
    }

    /// The records of all maps.
    pub const fn maps(&self) -> &'a [MapRecord] {
        self.maps
    }

    /// The records of a level's maps; empty for a level that there is not.
    pub fn level_maps(&self, level: u32) -> &'a [MapRecord] {
        let Some(record) = self.levels.get(level as usize) else { return &[] };
        let first = record.first_map as usize;
        &self.maps[first..first + (1 << (3 * record.maps_log2))]
    }

    /// Indices of the cells of a level; empty for a level that there is not.
    pub fn level_range(&self, level: u32) -> Range<u32> {
        self.levels.get(level as usize).map_or(0..0, |record| record.first_cell..record.first_cell + record.cells)
    }

    /// The cell of the finest level that holds the point, whether it is stored or not; see [`Grid::coordinates`].
    #[inline]
    pub fn coordinates(&self, p: Vec3) -> Option<[u32; 3]> {
        self.grid.coordinates(p)
    }

    /// Index of a cell, from its coordinates on `level`; `None` where no geometry is.
    #[inline]
    pub fn cell(&self, level: u32, coordinates: [u32; 3]) -> Option<u32> {
        self.block(level, coordinates)?.index(cell_bit(coordinates))
    }

    /// The entry of the block that holds a cell of `level`.
    #[inline]
    pub fn block(&self, level: u32, coordinates: [u32; 3]) -> Option<BlockEntry> {
        Some(self.entry(self.place(level, coordinates)?))
    }

    /// Where in the words the entry of a cell's block stands, for [`Octree::entry`]. Finding the places of many cells
    /// first and reading their entries then overlaps cache misses; [`Octree::find_cells`] does.
    #[inline]
    pub fn place(&self, level: u32, coordinates: [u32; 3]) -> Option<u32> {
        let record = self.levels.get(level as usize)?;
        let block = relative_block(coordinates, record.corner);
        let map = self.maps.get((record.first_map + map_of(block, record.maps_log2)?) as usize)?;
        Some(map.first_word + find(self.buckets(map), map.seed, block_key(block))?)
    }

    /// The entry at a place; nothing is occupied elsewhere.
    #[inline]
    pub fn entry(&self, place: u32) -> BlockEntry {
        let word = |offset: u32| self.words.get(place as usize + offset as usize).copied().unwrap_or(0);
        BlockEntry { occupancy: word(BUCKET_ENTRIES), base: word(2 * BUCKET_ENTRIES) }
    }

    /// Indices of many cells of a level, [`NO_CELL`] where no geometry is: what [`Octree::cell`] says, faster where the tables
    /// are larger than the caches. Cells beyond the end of `indices` are left out.
    pub fn find_cells(&self, level: u32, coordinates: &[[u32; 3]], indices: &mut [u32]) {
        let single = match (self.levels.get(level as usize), self.level_maps(level)) {
            (Some(record), [map]) if map.buckets > 0 => Some((record.corner, map, self.buckets(map))),
            _ => None,
        };
        for (cells, indices) in coordinates.chunks(BATCH).zip(indices.chunks_mut(BATCH)) {
            let mut places = [NO_CELL; BATCH];
            match single {
                Some((corner, map, table)) => places_in_map(table, corner, map, cells, &mut places),
                None => {
                    for (place, cell) in places.iter_mut().zip(cells) {
                        *place = self.place(level, *cell).unwrap_or(NO_CELL);
                    }
                }
            }
            for ((index, place), cell) in indices.iter_mut().zip(places).zip(cells) {
                // Nowhere, nothing is occupied.
                let (entry, bit) = (self.entry(place), cell_bit(*cell));
                *index = if entry.occupancy & bit == 0 { NO_CELL } else { entry.index_of(bit) };
            }
        }
    }

    /// The buckets of a map.
    #[inline]
    fn buckets(&self, map: &MapRecord) -> &'a [[u32; 12]] {
        let first = map.first_word as usize;
        let words = self.words.get(first..first + map.buckets as usize * BUCKET_WORDS as usize);
        bytemuck::cast_slice(words.unwrap_or_default())
    }

    /// All blocks of a level, in the order of the tables.
    pub fn blocks(&self, level: u32) -> impl Iterator<Item = BlockRef> + use<'a> {
        let (words, all) = (self.words, self.maps);
        let record = self.levels.get(level as usize).copied();
        let maps = record.map_or(0..0, |record| 0..1_u32 << (3 * record.maps_log2));
        maps.flat_map(move |map| {
            let record = record.unwrap_or(bytemuck::Zeroable::zeroed());
            let table = all[(record.first_map + map) as usize];
            let first = table.first_word as usize;
            let buckets = words[first..first + (table.buckets * BUCKET_WORDS) as usize].chunks_exact(12);
            buckets.flat_map(move |bucket| (0..4).filter_map(move |at| BlockRef::new(&record, map, bucket, at)))
        })
    }
}

/// The places of cells of a level with one map. Hashes come first and memory second: a processor looks some hundred
/// instructions ahead, which are then all reads. Two of three keys stand in their first bucket; the others are gathered
/// without a branch, since which they are cannot be predicted.
fn places_in_map(
    table: &[[u32; 12]],
    corner: [u32; 3],
    map: &MapRecord,
    cells: &[[u32; 3]],
    places: &mut [u32; BATCH],
) {
    let (mut keys, mut pairs) = ([NO_KEY; BATCH], [[0; 2]; BATCH]);
    for ((key, pair), cell) in keys.iter_mut().zip(&mut pairs).zip(cells) {
        let block = relative_block(*cell, corner);
        let of_block = block_key(block);
        // A key that no entry has, nor an empty one, stands for blocks beyond the map.
        *key = if map_of(block, 0).is_some() { of_block } else { NO_KEY - 1 };
        *pair = bucket_pair(of_block, map.seed, table.len() as u32);
    }
    let (mut rest, mut count) = ([0_u8; BATCH], 0);
    for (at, (key, [first, _])) in keys.iter().zip(pairs).take(cells.len()).enumerate() {
        places[at] = find_in(table, *key, first);
        rest[count] = at as u8;
        count += usize::from(places[at] == NO_CELL);
    }
    for at in rest[..count].iter().map(|at| usize::from(*at)) {
        places[at] = find_in(table, keys[at], pairs[at][1]);
    }
    for place in places {
        *place = if *place == NO_CELL { NO_CELL } else { map.first_word + *place };
    }
}

/// The position of a cell's block, in blocks from the level's corner; below the corner it wraps to large numbers.
#[inline]
pub(crate) const fn relative_block(coordinates: [u32; 3], corner: [u32; 3]) -> [u32; 3] {
    [
        coordinates[0].wrapping_sub(corner[0]) >> 2,
        coordinates[1].wrapping_sub(corner[1]) >> 2,
        coordinates[2].wrapping_sub(corner[2]) >> 1,
    ]
}

/// The map of a block within its level; `None` beyond the last.
#[inline]
pub(crate) const fn map_of(block: [u32; 3], maps_log2: u32) -> Option<u32> {
    let (x, y, z) = (block[0] >> 10, block[1] >> 10, block[2] >> 11);
    if (x | y | z) >> maps_log2 != 0 {
        return None;
    }
    Some(x | (y << maps_log2) | (z << (2 * maps_log2)))
}
