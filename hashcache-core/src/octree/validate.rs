//! Whether an octree's words keep its laws.

use core::fmt;

use super::block::{BlockRef, cell_bit, parent_occupancy};
use super::view::Octree;

/// The first broken law, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OctreeViolation {
    /// A block in none of the two buckets of its key, or behind another one with the same key.
    Unreachable {
        /// The level.
        level: u32,
        /// The block's lowest cell.
        corner: [u32; 3],
    },
    /// A block without cells.
    Vacant {
        /// The level.
        level: u32,
        /// The block's lowest cell.
        corner: [u32; 3],
    },
    /// The indices of a level's cells are not its range, each once.
    Indices {
        /// The level.
        level: u32,
    },
    /// A cell whose parent is not stored.
    Orphan {
        /// The level.
        level: u32,
        /// The block's lowest cell.
        corner: [u32; 3],
    },
    /// A cell none of whose children is stored.
    Childless {
        /// The level.
        level: u32,
        /// The cell.
        cell: [u32; 3],
    },
}

impl fmt::Display for OctreeViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unreachable { level, corner } => write!(f, "level {level}: the block at {corner:?} cannot be found"),
            Self::Vacant { level, corner } => write!(f, "level {level}: the block at {corner:?} has no cells"),
            Self::Indices { level } => write!(f, "level {level}: the cells' indices are not each used once"),
            Self::Orphan { level, corner } => write!(f, "level {level}: the block at {corner:?} has no parent"),
            Self::Childless { level, cell } => write!(f, "level {level}: the cell {cell:?} has no children"),
        }
    }
}

impl core::error::Error for OctreeViolation {}

impl Octree<'_> {
    /// Checks every block: that lookups find it, that the indices of each level's cells are a bijection with its range,
    /// that every cell has its parent and every parent a child. In time proportional to the number of cells, without
    /// memory; the bijection is judged by 64-bit hashes, which miss one wrong octree of 10¹⁹.
    ///
    /// # Errors
    /// The first violation, levels and tables in order.
    pub fn validate(&self) -> Result<(), OctreeViolation> {
        for level in 0..self.grid().levels {
            self.validate_indices(level)?;
            for block in self.blocks(level) {
                self.validate_block(level, &block)?;
            }
        }
        Ok(())
    }

    /// Runs of indices begin where others end, except for the first and the last: they are one chain.
    fn validate_indices(&self, level: u32) -> Result<(), OctreeViolation> {
        let range = self.level_range(level);
        let (mut count, mut ends) = (0_u64, spread(range.start).wrapping_sub(spread(range.end)));
        for block in self.blocks(level) {
            count += u64::from(block.occupancy.count_ones());
            let end = block.base.wrapping_add(block.occupancy.count_ones());
            if !range.contains(&block.base) || end > range.end {
                return Err(OctreeViolation::Indices { level });
            }
            ends = ends.wrapping_add(spread(end)).wrapping_sub(spread(block.base));
        }
        if count == range.len() as u64 && ends == 0 { Ok(()) } else { Err(OctreeViolation::Indices { level }) }
    }

    fn validate_block(&self, level: u32, block: &BlockRef) -> Result<(), OctreeViolation> {
        let corner = block.corner;
        if block.occupancy == 0 {
            return Err(OctreeViolation::Vacant { level, corner });
        }
        // A second entry with the key would be one that lookups do not find.
        let found = self.block(level, corner);
        if found.map(|entry| (entry.occupancy, entry.base)) != Some((block.occupancy, block.base)) {
            return Err(OctreeViolation::Unreachable { level, corner });
        }
        if level + 1 < self.grid().levels {
            let parent = corner.map(|c| c >> 1);
            let at = [corner[0] >> 2, corner[1] >> 2, corner[2] >> 1];
            let needed = parent_occupancy(at, block.occupancy);
            if self.block(level + 1, parent).is_none_or(|entry| entry.occupancy & needed != needed) {
                return Err(OctreeViolation::Orphan { level, corner });
            }
        }
        if level > 0 {
            for (cell, _) in block.cells() {
                let child = cell.map(|c| c << 1);
                // The eight children lie in one block.
                let eight = cell_bit(child) * 0x0033_0033;
                if self.block(level - 1, child).is_none_or(|entry| entry.occupancy & eight == 0) {
                    return Err(OctreeViolation::Childless { level, cell });
                }
            }
        }
        Ok(())
    }
}

/// A word as 64 bits without structure (Steele et al. 2014, `SplitMix64`).
const fn spread(v: u32) -> u64 {
    let v = (v as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let v = (v ^ (v >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let v = (v ^ (v >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    v ^ (v >> 31)
}
