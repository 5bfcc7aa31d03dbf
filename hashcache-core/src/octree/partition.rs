//! The cells of all levels, counted but not yet in tables.

use alloc::vec::Vec;
use core::ops::Range;
use core::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use super::block::{from_morton, key_block, morton, parent_occupancy};
use super::block_list::BlockList;
use super::cuckoo::buckets_for;
use super::error::BuildError;
use super::grid::{Grid, MAP_BITS};
use super::header::records_words;
use super::mark::{Full, Marks};
use super::overlap::{Rows, Window, cross};
use super::size::NORMAL_BYTES;
use super::table::BUCKET_WORDS;
use super::triangles::Triangles;
use super::view::{BATCH, map_of};

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
        let slots = first_slots(grid, triangles);
        let mut finest = Vec::with_capacity(maps as usize);
        let mut cells = 0;
        for map in 0..maps {
            let (blocks, found) = voxelise(grid, map, triangles, slots, max_cells - cells, workers)?;
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

    /// Bytes of tables, normals and `cell_bytes` of data a cell; a table that is hard to fill may take a little more.
    pub fn bytes(&self, cell_bytes: u32) -> u64 {
        self.bytes_from(0, cell_bytes)
    }

    /// [`Partition::bytes`] without the levels below `level`.
    pub(crate) fn bytes_from(&self, level: u32, cell_bytes: u32) -> u64 {
        let cells: u64 = (level..self.grid.levels).map(|level| self.cells(level)).sum();
        4 * self.words_from(level) + u64::from(NORMAL_BYTES + cell_bytes) * cells
    }

    /// Words of header and tables without the levels below `level`.
    pub(crate) fn words_from(&self, level: u32) -> u64 {
        let levels = &self.levels[level as usize..];
        let maps = levels.iter().map(Vec::len).sum::<usize>();
        let tables = levels
            .iter()
            .flatten()
            .map(|map| (u64::from(buckets_for(map.len() as u32)) * u64::from(BUCKET_WORDS)).next_multiple_of(16));
        records_words(self.grid.levels - level, maps as u32) as u64 + tables.sum::<u64>()
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

/// Words that a table has at most to begin with, 64 MiB: where triangles share blocks, far fewer are needed.
const MOST_FIRST_SLOTS: u64 = 1 << 23;

/// Triangles voxelised between two looks at the table's load.
const ROUND: u32 = 1 << 16;

/// A table is made larger when more than three of four words are taken: longer probes cost more than moving.
const FULL: u64 = 3;

/// The blocks of one map, and the number of their cells.
fn voxelise(
    grid: &Grid,
    map: u32,
    triangles: &Triangles<'_>,
    slots: u64,
    max_cells: u64,
    workers: &dyn Workers,
) -> Result<(Vec<Block>, u64), BuildError> {
    let window = map_window(grid, map);
    let mut words = zeroed(slots);
    let (mut cells, mut blocks, mut first) = (0, 0, 0);
    while first < triangles.count() {
        let batch = first..triangles.count().min(first.saturating_add(ROUND));
        let added = mark_batch(grid, &window, triangles, batch.clone(), &words, max_cells - cells, workers);
        cells += added.cells;
        blocks += added.blocks;
        if cells > max_cells {
            return Err(BuildError::TooLarge { needed: cells, limit: max_cells });
        }
        if added.full {
            words = larger(&words);
        } else {
            first = batch.end;
            if blocks * 4 > words.len() as u64 * FULL && first < triangles.count() {
                words = larger(&words);
            }
        }
    }
    let mut blocks: Vec<Block> = Marks::new(&words)
        .blocks()
        .map(|(key, occupancy)| (u64::from(morton(key)) << 32) | u64::from(occupancy))
        .collect();
    drop(words);
    blocks.sort_unstable();
    Ok((blocks, cells))
}

fn zeroed(words: u64) -> Vec<AtomicU64> {
    (0..words).map(|_| AtomicU64::new(0)).collect()
}

/// Words to begin with: twice the blocks that triangles of such an area have when they share few, within bounds.
fn first_slots(grid: &Grid, triangles: &Triangles<'_>) -> u64 {
    let area: f64 = triangles
        .range(0..triangles.count())
        .map(|(_, corners)| {
            // The sum of the three projections' areas: a block shows as many cells to each axis as it has in it.
            let n = cross(&corners.map(|corner| grid.exact(corner)));
            0.5 * (n[0].abs() + n[1].abs() + n[2].abs())
        })
        .filter(|area| area.is_finite())
        .sum();
    (area as u64 / 4).saturating_add(u64::from(triangles.count() / 4)).clamp(1 << 12, MOST_FIRST_SLOTS)
}

/// A table of twice as many words with the same marks.
fn larger(words: &[AtomicU64]) -> Vec<AtomicU64> {
    let more = zeroed(words.len() as u64 * 2);
    let marks = Marks::new(&more);
    for (key, occupancy) in Marks::new(words).blocks() {
        // There is room for twice as many.
        let _ = marks.mark(key_block(key), occupancy);
    }
    more
}

/// What a batch added, and whether it has to be done again with more room.
struct Batch {
    cells: u64,
    blocks: u64,
    full: bool,
}

fn mark_batch(
    grid: &Grid,
    window: &Window,
    triangles: &Triangles<'_>,
    batch: Range<u32>,
    words: &[AtomicU64],
    max_cells: u64,
    workers: &dyn Workers,
) -> Batch {
    let marks = Marks::new(words);
    let (full, cells, blocks) = (AtomicBool::new(false), AtomicU64::new(0), AtomicU64::new(0));
    let corner = [grid.corner[0] >> 2, grid.corner[1] >> 2, grid.corner[2] >> 1];
    workers.run(batch.end - batch.start, &|range| {
        let (mut added, mut reported) = (Batch { cells: 0, blocks: 0, full: false }, 0);
        let mut pending = BlockList::new();
        let flush = |pending: &mut BlockList, added: &mut Batch| {
            // All home slots are read first, so that their cache misses overlap.
            let mut heads = [(0, 0); BATCH];
            for (head, (block, _)) in heads.iter_mut().zip(pending.blocks()) {
                let home = marks.home(*block);
                *head = (home, marks.head(home));
            }
            for ((home, head), (block, occupancy)) in heads.into_iter().zip(pending.blocks()) {
                match marks.mark_from(home, head, *block, *occupancy) {
                    Ok(new) => {
                        added.cells += u64::from(new.cells);
                        added.blocks += u64::from(new.blocks);
                    }
                    Err(Full) => added.full = true,
                }
            }
            pending.clear();
        };
        for (_, triangle) in triangles.range(batch.start + range.start..batch.start + range.end) {
            let Some(rows) = Rows::new(grid, window, &triangle) else { continue };
            rows.blocks(|block, occupancy| {
                if added.full {
                    return;
                }
                pending.push([block[0] - corner[0], block[1] - corner[1], block[2] - corner[2]], occupancy);
                if pending.is_full() {
                    flush(&mut pending, &mut added);
                }
            });
            if added.cells - reported > 1 << 12 {
                cells.fetch_add(added.cells - reported, Relaxed);
                reported = added.cells;
                if added.full || full.load(Relaxed) || cells.load(Relaxed) > max_cells {
                    break;
                }
            }
        }
        flush(&mut pending, &mut added);
        cells.fetch_add(added.cells - reported, Relaxed);
        blocks.fetch_add(added.blocks, Relaxed);
        full.fetch_or(added.full, Relaxed);
    });
    Batch { cells: cells.into_inner(), blocks: blocks.into_inner(), full: full.into_inner() }
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
        blocks.sort_unstable();
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
