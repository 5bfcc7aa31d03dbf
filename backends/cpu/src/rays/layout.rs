//! The hierarchy in memory: nodes of eight boxes and blocks of eight triangles in one array, each node followed by
//! its blocks.

use bytemuck::{Pod, Zeroable};

use super::collapse::Wide;

/// Boxes of a node.
pub(super) const WIDTH: usize = 8;

/// Triangles of a block.
pub(super) const LEAF: usize = 8;

/// What a child number means.
///
/// | bits | meaning |
/// |---|---|
/// | 31 | 1: a leaf, 0: a node |
/// | 0..31 | the row where it starts; for a leaf that is no block, a number of the owner's choice |
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    /// The first node of a hierarchy.
    pub(super) const ROOT: Self = Self(0);

    pub(super) const fn node(index: u32) -> Self {
        Self(index)
    }

    pub(super) const fn leaf(index: u32) -> Self {
        Self(index | Self::LEAF)
    }

    #[inline(always)]
    pub(super) const fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub(super) const fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// Eight boxes; 224 bytes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// Lower x, y, z, then upper x, y, z. Unused boxes are turned inside out: from +∞ to −∞.
    pub(super) bounds: [[f32; WIDTH]; 6],
    /// What is in the boxes.
    pub(super) children: [Child; WIDTH],
}

impl Node {
    /// A node of unused boxes.
    pub(super) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child::ROOT; WIDTH],
    };

    /// Whether the box at `slot` is in use.
    pub(super) fn is_used(&self, slot: usize) -> bool {
        self.bounds[0][slot] <= self.bounds[3][slot]
    }
}

/// Eight triangles side by side; 320 bytes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Block {
    /// Corner, axis, triangle. Unused places are NaN, which no ray meets.
    pub(super) corners: [[[f32; LEAF]; 3]; 3],
    /// Numbers of the triangles, ascending; bit 30 ([`MASKED`](super::holes::MASKED)) says that it has holes.
    pub(super) ids: [u32; LEAF],
}

impl Block {
    /// A block of unused places.
    pub(super) const EMPTY: Self = Self { corners: [[[f32::NAN; LEAF]; 3]; 3], ids: [u32::MAX; LEAF] };
}

/// What nodes and blocks are made of: half a cache line.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Row([u32; 8]);

const NODE_ROWS: usize = size_of::<Node>() / size_of::<Row>();
const BLOCK_ROWS: usize = size_of::<Block>() / size_of::<Row>();

/// Makes the block of a leaf from the numbers of its boxes.
pub(super) type MakeBlock<'a> = &'a dyn Fn(&[u32]) -> Block;

/// Nodes and blocks.
pub(super) struct Rows {
    list: Vec<Row>,
    pub(super) nodes: usize,
    pub(super) blocks: usize,
}

impl Rows {
    /// Lays out a hierarchy. Without `block`, leaves keep their index.
    pub(super) fn new(wide: &Wide, block: Option<MakeBlock<'_>>) -> Self {
        let leaf_rows = if block.is_some() { BLOCK_ROWS } else { 0 };
        let mut starts = Vec::with_capacity(wide.nodes.len());
        let mut end = 0;
        for node in &wide.nodes {
            starts.push(end as u32);
            let leaves = (0..WIDTH).filter(|&slot| node.is_used(slot) && node.children[slot].is_leaf()).count();
            end += NODE_ROWS + leaves * leaf_rows;
        }
        let mut rows = Vec::with_capacity(end);
        for node in &wide.nodes {
            let start = rows.len();
            let mut moved = *node;
            rows.extend([Row([0; 8]); NODE_ROWS]);
            for slot in (0..WIDTH).filter(|&slot| node.is_used(slot)) {
                let child = node.children[slot];
                moved.children[slot] = match block {
                    _ if !child.is_leaf() => Child::node(starts[child.index()]),
                    None => child,
                    Some(block) => {
                        let at = rows.len() as u32;
                        rows.extend(bytemuck::cast::<Block, [Row; BLOCK_ROWS]>(block(&wide.leaves[child.index()])));
                        Child::leaf(at)
                    }
                };
            }
            rows[start..start + NODE_ROWS].copy_from_slice(&bytemuck::cast::<Node, [Row; NODE_ROWS]>(moved));
        }
        Self { list: rows, nodes: wide.nodes.len(), blocks: if block.is_some() { wide.leaves.len() } else { 0 } }
    }

    /// Bytes of all rows.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.list.as_slice())
    }

    /// The node at a row.
    #[inline(always)]
    pub(super) fn node(&self, at: usize) -> &Node {
        match self.list[at..].first_chunk::<NODE_ROWS>() {
            Some(rows) => bytemuck::cast_ref(rows),
            None => unreachable!("a node starts at least its length before the end"),
        }
    }

    /// The block at a row.
    #[inline(always)]
    pub(super) fn block(&self, at: usize) -> &Block {
        match self.list[at..].first_chunk::<BLOCK_ROWS>() {
            Some(rows) => bytemuck::cast_ref(rows),
            None => unreachable!("a block starts at least its length before the end"),
        }
    }
}
