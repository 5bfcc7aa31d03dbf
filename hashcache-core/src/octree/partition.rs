//! The cells of all levels, counted but not yet in tables.

use alloc::vec::Vec;
use core::ops::Range;
use core::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use super::block::{from_morton, key_block, morton, parent_occupancy};
use super::cuckoo::buckets_for;
use super::error::BuildError;
use super::grid::{Grid, MAP_BITS};
use super::header::records_words;
use super::mark::Marks;
use super::overlap::{Rows, Window};
use super::table::BUCKET_WORDS;
use super::triangles::Triangles;
use super::view::map_of;

/// Runs a body over ranges of items, on as many threads as it likes.
pub trait Workers {
    /// Calls `body` for ranges that together hold every item of `0..items` once, and returns when all are done.
    fn run(&self, items: u32, body: &(dyn Fn(Range<u32>) + Sync));
}

/// One range, on the thread that calls.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Workers for Serial {
    fn run(&self, items: u32, body: &(dyn Fn(Range<u32>) + Sync)) {
        body(0..items);
    }
}

/// A block of a map: its Morton code above its occupancy, so that sorting brings near blocks together.
pub(crate) type Block = u64;

/// The cells of all levels: a step between voxelisation and tables, at which memory can be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Partition {
    grid: Grid,
    /// Sorted blocks by level and map.
    levels: Vec<Vec<Vec<Block>>>,
}

impl Partition {
    /// Voxelises the triangles.
    ///
    /// # Errors
    /// [`BuildError::TooLarge`] when the finest level has more than `max_cells` cells: then `needed` counts cells, those found
    /// until then.
    pub fn new(
        grid: &Grid,
        triangles: &Triangles<'_>,
        max_cells: u64,
        workers: &dyn Workers,
    ) -> Result<Self, BuildError> {
        let maps = 1 << (3 * grid.maps_log2);
        let mut finest = Vec::with_capacity(maps as usize);
        let mut cells = 0;
        for map in 0..maps {
            let (blocks, found) = voxelise(grid, map, triangles, max_cells - cells, workers)?;
            cells += found;
            finest.push(blocks);
        }
        let mut levels = Vec::with_capacity(grid.levels as usize);
        levels.push(finest);
        for level in 1..grid.levels {
            let finer = &levels[level as usize - 1];
            levels.push(coarser(grid, level, finer));
        }
        Ok(Self { grid: *grid, levels })
    }

    /// Where the cells lie.
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of cells of a level.
    pub fn cells(&self, level: u32) -> u64 {
        let blocks = self.levels[level as usize].iter().flatten();
        blocks.map(|block| u64::from((*block as u32).count_ones())).sum()
    }

    /// Number of cells of all levels.
    pub fn total_cells(&self) -> u64 {
        (0..self.grid.levels).map(|level| self.cells(level)).sum()
    }

    /// Words of header and tables, unless a table has to grow.
    pub fn words(&self) -> u64 {
        let maps = self.levels.iter().map(Vec::len).sum::<usize>();
        let tables = self
            .levels
            .iter()
            .flatten()
            .map(|map| (u64::from(buckets_for(map.len() as u32)) * u64::from(BUCKET_WORDS)).next_multiple_of(16));
        records_words(self.grid.levels, maps as u32) as u64 + tables.sum::<u64>()
    }

    /// Bytes of tables, normals and `cell_bytes` of data a cell.
    pub fn bytes(&self, cell_bytes: u32) -> u64 {
        4 * self.words() + (4 + u64::from(cell_bytes)) * self.total_cells()
    }

    pub(crate) fn levels(&self) -> &[Vec<Vec<Block>>] {
        &self.levels
    }
}

/// The cells that a map of the finest level spans.
pub(crate) fn map_window(grid: &Grid, map: u32) -> Window {
    let mask = (1 << grid.maps_log2) - 1;
    let at = [map & mask, (map >> grid.maps_log2) & mask, map >> (2 * grid.maps_log2)];
    let low = core::array::from_fn(|axis| (grid.corner[axis] + (at[axis] << MAP_BITS)).min(grid.side(0)));
    Window { low, high: low.map(|v| (v + (1 << MAP_BITS)).min(grid.side(0))) }
}

/// The blocks of one map, and the number of their cells.
fn voxelise(
    grid: &Grid,
    map: u32,
    triangles: &Triangles<'_>,
    max_cells: u64,
    workers: &dyn Workers,
) -> Result<(Vec<Block>, u64), BuildError> {
    let window = map_window(grid, map);
    let mut slots = 1 << 16;
    loop {
        let words: Vec<AtomicU64> = (0..slots).map(|_| AtomicU64::new(0)).collect();
        let marks = Marks::new(&words);
        let (full, cells, blocks) = (AtomicBool::new(false), AtomicU64::new(0), AtomicU64::new(0));
        let corner = [grid.corner[0] >> 2, grid.corner[1] >> 2, grid.corner[2] >> 1];
        workers.run(triangles.count(), &|range| {
            for (_, triangle) in triangles.range(range) {
                if full.load(Relaxed) {
                    return;
                }
                let Some(rows) = Rows::new(grid, &window, &triangle) else { continue };
                let (mut more_cells, mut more_blocks) = (0, 0);
                rows.blocks(|block, occupancy| {
                    let block = [block[0] - corner[0], block[1] - corner[1], block[2] - corner[2]];
                    match marks.mark(block, occupancy) {
                        Ok(added) => {
                            more_cells += u64::from(added.cells);
                            more_blocks += u64::from(added.blocks);
                        }
                        Err(_) => full.store(true, Relaxed),
                    }
                });
                let total = blocks.fetch_add(more_blocks, Relaxed) + more_blocks;
                cells.fetch_add(more_cells, Relaxed);
                if total * 4 > slots * 3 {
                    full.store(true, Relaxed);
                }
            }
        });
        let cells = cells.into_inner();
        if cells > max_cells {
            return Err(BuildError::TooLarge { needed: cells, limit: max_cells });
        }
        if !full.into_inner() {
            let mut blocks: Vec<Block> =
                marks.blocks().map(|(key, occupancy)| (u64::from(morton(key)) << 32) | u64::from(occupancy)).collect();
            blocks.sort_unstable();
            return Ok((blocks, cells));
        }
        slots *= 4;
    }
}

/// The blocks of `level` from those of the next finer one.
fn coarser(grid: &Grid, level: u32, finer: &[Vec<Block>]) -> Vec<Vec<Block>> {
    let maps_log2 = grid.level_maps_log2(level);
    let mut maps = alloc::vec![Vec::new(); 1 << (3 * maps_log2)];
    for (map, blocks) in (0..).zip(finer) {
        for block in blocks {
            let child = absolute(grid, level - 1, map, *block);
            let corner = grid.level_corner(level);
            let parent = [
                (child[0] >> 1) - (corner[0] >> 2),
                (child[1] >> 1) - (corner[1] >> 2),
                (child[2] >> 1) - (corner[2] >> 1),
            ];
            let code = morton(super::block::block_key(parent));
            let occupancy = parent_occupancy(child, *block as u32);
            let to: &mut Vec<Block> = &mut maps[map_of(parent, maps_log2).unwrap_or(0) as usize];
            // Children of one parent come one after the other, most of the time.
            match to.last_mut() {
                Some(last) if (*last >> 32) as u32 == code => *last |= u64::from(occupancy),
                _ => to.push((u64::from(code) << 32) | u64::from(occupancy)),
            }
        }
    }
    for blocks in &mut maps {
        blocks.sort();
        blocks.dedup_by(|next, kept| {
            let same = *next >> 32 == *kept >> 32;
            *kept |= if same { *next & 0xffff_ffff } else { 0 };
            same
        });
    }
    maps
}

/// The position of a block, in blocks from the cube's corner.
pub(crate) fn absolute(grid: &Grid, level: u32, map: u32, block: Block) -> [u32; 3] {
    let log2 = grid.level_maps_log2(level);
    let mask = (1 << log2) - 1;
    let map = [map & mask, (map >> log2) & mask, map >> (2 * log2)];
    let corner = grid.level_corner(level);
    let at = key_block(from_morton((block >> 32) as u32));
    [
        (corner[0] >> 2) + (map[0] << 10) + at[0],
        (corner[1] >> 2) + (map[1] << 10) + at[1],
        (corner[2] >> 1) + (map[2] << 11) + at[2],
    ]
}
