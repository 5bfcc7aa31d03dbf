//! Which way a cell's front faces.

use alloc::vec::Vec;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::block_list::BlockList;
use super::grid::Grid;
use super::overlap::{Rows, cross};
use super::partition::{Partition, Workers, absolute, map_window};
use super::table::BlockEntry;
use super::triangles::Triangles;
use super::view::{BATCH, NO_CELL, Octree};
use crate::pack::octahedral_encode;
use glam::Vec3;

/// The normal of the largest triangle of every cell of all levels.
pub(crate) fn normals(
    words: &[u32],
    partition: &Partition,
    triangles: &Triangles<'_>,
    workers: &dyn Workers,
) -> Vec<u32> {
    let Ok(octree) = Octree::new(words) else { return Vec::new() };
    let grid = octree.grid();
    let order = by_area(grid, triangles);
    let mut rank = alloc::vec![0; order.len()];
    for (at, id) in (0..).zip(&order) {
        rank[*id as usize] = at;
    }
    // A cell's smallest rank is that of its largest triangle.
    let best: Vec<AtomicU32> = (0..octree.cells()).map(|_| AtomicU32::new(u32::MAX)).collect();
    for map in 0..1 << (3 * grid.maps_log2) {
        let window = map_window(grid, map);
        workers.run(triangles.count(), &|range| {
            let mut list = BlockList::new();
            let mut ranks = [0; BATCH];
            let mut at = 0;
            let flush = |list: &mut BlockList, ranks: &[u32; BATCH], at: &mut usize| {
                let entries = entries(&octree, 0, list.blocks());
                for ((entry, (_, occupancy)), rank) in entries.iter().zip(list.blocks()).zip(ranks) {
                    let mut rest = occupancy & entry.occupancy;
                    while rest != 0 {
                        let bit = rest & rest.wrapping_neg();
                        rest ^= bit;
                        lower(&best[entry.index_of(bit) as usize], *rank);
                    }
                }
                list.clear();
                *at = 0;
            };
            for (id, triangle) in triangles.range(range) {
                let Some(rows) = Rows::new(grid, &window, &triangle) else { continue };
                let rank = rank[id as usize];
                rows.blocks(|block, occupancy| {
                    list.push(block, occupancy);
                    ranks[at] = rank;
                    at += 1;
                    if list.is_full() {
                        flush(&mut list, &ranks, &mut at);
                    }
                });
            }
            flush(&mut list, &ranks, &mut at);
        });
    }
    for level in 1..grid.levels {
        pass_up(&octree, partition, level, &best);
    }
    let codes: Vec<u32> = codes(triangles, &order);
    best.into_iter().map(|rank| codes.get(rank.into_inner() as usize).copied().unwrap_or(0)).collect()
}

#[inline]
fn lower(to: &AtomicU32, rank: u32) {
    if to.load(Relaxed) > rank {
        to.fetch_min(rank, Relaxed);
    }
}

/// Numbers of the triangles, the largest first, the lower number first among equals.
fn by_area(grid: &Grid, triangles: &Triangles<'_>) -> Vec<u32> {
    let mut keys: Vec<u64> = triangles
        .range(0..triangles.count())
        .map(|(id, corners)| {
            let [x, y, z] = cross(&corners.map(|corner| grid.exact(corner)));
            let area = (x * x + y * y + z * z) as f32;
            // Areas are not negative: their bits have their order. NaN comes last.
            let bits = if area.is_nan() { 0 } else { area.to_bits() };
            (u64::from(!bits) << 32) | u64::from(id)
        })
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Octahedral codes of the triangles' fronts, by rank.
fn codes(triangles: &Triangles<'_>, order: &[u32]) -> Vec<u32> {
    let by_id: Vec<u32> =
        triangles.range(0..triangles.count()).map(|(_, corners)| octahedral_encode(front(&corners))).collect();
    order.iter().map(|id| by_id[*id as usize]).collect()
}

/// The entries of blocks of a level, by their positions in blocks from the cube's corner. All places are found first, so
/// that their cache misses overlap.
fn entries(octree: &Octree<'_>, level: u32, blocks: &[([u32; 3], u32)]) -> [BlockEntry; BATCH] {
    let mut places = [NO_CELL; BATCH];
    for (place, ([x, y, z], _)) in places.iter_mut().zip(blocks) {
        *place = octree.place(level, [x << 2, y << 2, z << 1]).unwrap_or(NO_CELL);
    }
    places.map(|place| if place == NO_CELL { BlockEntry { occupancy: 0, base: 0 } } else { octree.entry(place) })
}

/// Gives the cells of `level` the smallest rank of their children.
fn pass_up(octree: &Octree<'_>, partition: &Partition, level: u32, best: &[AtomicU32]) {
    let mut child = octree.level_range(level - 1).start;
    for (map, blocks) in (0..).zip(&partition.levels()[level as usize - 1]) {
        for blocks in blocks.chunks(BATCH) {
            let mut parents = [([0; 3], 0); BATCH];
            for (parent, block) in parents.iter_mut().zip(blocks) {
                let [x, y, z] = absolute(octree.grid(), level - 1, map, *block);
                let quarter = (x & 1) << 1 | (y & 1) << 3 | (z & 1) << 4;
                *parent = ([x >> 1, y >> 1, z >> 1], quarter);
            }
            let entries = entries(octree, level, &parents[..blocks.len()]);
            for ((block, (_, quarter)), entry) in blocks.iter().zip(parents).zip(entries) {
                let mut rest = *block as u32;
                while rest != 0 {
                    let bit = rest.trailing_zeros();
                    rest &= rest - 1;
                    // Of a child's place in its block: x and y by halves, and z is the block's.
                    let parent = 1 << (quarter | (bit >> 1 & 1) | (bit >> 1 & 4));
                    if entry.occupancy & parent != 0 {
                        lower(&best[entry.index_of(parent) as usize], best[child as usize].load(Relaxed));
                    }
                    child += 1;
                }
            }
        }
    }
}

/// The front of a triangle: its normal, turned so that the first component that is not 0 is positive. Zero for a
/// triangle without area.
fn front(corners: &[Vec3; 3]) -> Vec3 {
    let n = cross(&corners.map(|corner| corner.to_array().map(f64::from)));
    let largest = n[0].abs().max(n[1].abs()).max(n[2].abs());
    if largest == 0.0 || !largest.is_finite() {
        return Vec3::ZERO;
    }
    let [x, y, z] = n.map(|v| (v / largest) as f32);
    let turned = x < 0.0 || (x == 0.0 && (y < 0.0 || (y == 0.0 && z < 0.0)));
    if turned { -Vec3::new(x, y, z) } else { Vec3::new(x, y, z) }
}
