//! A few blocks that wait to be worked on together.

use super::view::BATCH;

/// Blocks and cells of theirs, up to [`BATCH`].
pub(crate) struct BlockList {
    blocks: [([u32; 3], u32); BATCH],
    count: usize,
}

impl BlockList {
    pub(crate) const fn new() -> Self {
        Self { blocks: [([0; 3], 0); BATCH], count: 0 }
    }

    #[inline]
    pub(crate) const fn push(&mut self, block: [u32; 3], occupancy: u32) {
        self.blocks[self.count] = (block, occupancy);
        self.count += 1;
    }

    #[inline]
    pub(crate) const fn is_full(&self) -> bool {
        self.count == BATCH
    }

    #[inline]
    pub(crate) fn blocks(&self) -> &[([u32; 3], u32)] {
        &self.blocks[..self.count]
    }

    #[inline]
    pub(crate) const fn clear(&mut self) {
        self.count = 0;
    }
}
