//! Boxes into a binary hierarchy.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams};

use super::collapse::{Wide, collapse};
use super::traverse::MAX_DEPTH;

/// A box as obvhs wants it.
struct Boxed(Aabb);

impl Boundable for Boxed {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A binary hierarchy; the first node is the root, siblings are neighbours.
pub(super) struct Binary {
    /// Leaves hold one primitive: `first_index` is an index into `primitives`.
    pub(super) nodes: Vec<Bvh2Node>,
    /// Indices of boxes.
    pub(super) primitives: Vec<u32>,
}

/// Clusters boxes bottom-up, then reinserts the costliest nodes.
///
/// # Source
/// Meister & Bittner 2018 (clustering, reinsertion); both by obvhs.
fn cluster(boxes: &[Aabb]) -> Binary {
    const PARAMS: BvhBuildParams = BvhBuildParams::medium_build();
    let count = boxes.len();
    let boxes: Vec<Boxed> = boxes.iter().copied().map(Boxed).collect();
    let mut tree = PlocBuilder::with_capacity(count).build(
        PARAMS.ploc_search_distance,
        &boxes,
        (0..count as u32).collect(),
        PARAMS.sort_precision,
        PARAMS.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut tree, PARAMS.reinsertion_batch_ratio, None);
    Binary { nodes: tree.nodes, primitives: tree.primitive_indices }
}

/// Halves the boxes by the middle of their longest extent: at most ⌈log₂ n⌉ deep whatever the boxes are.
///
/// For the rare geometry where clustering goes too deep for the stack, e.g. triangles nested in size over many
/// magnitudes.
fn halve(boxes: &[Aabb]) -> Binary {
    let mut tree = Binary { nodes: vec![Bvh2Node::default()], primitives: (0..boxes.len() as u32).collect() };
    let mut open = vec![(0usize, 0usize, boxes.len())];
    while let Some((node, from, to)) = open.pop() {
        let run = &mut tree.primitives[from..to];
        let mut bounds = Aabb::empty();
        let mut middles = Aabb::empty();
        for &i in run.iter() {
            bounds = bounds.union(&boxes[i as usize]);
            middles.extend(middle(&boxes[i as usize]));
        }
        if run.len() == 1 {
            tree.nodes[node] = Bvh2Node::new(bounds, 1, from as u32);
            continue;
        }
        let axis = middles.largest_axis();
        let half = run.len() / 2;
        run.select_nth_unstable_by(half, |&a, &b| {
            let key = |i: u32| middle(&boxes[i as usize])[axis];
            key(a).total_cmp(&key(b)).then(a.cmp(&b))
        });
        let left = tree.nodes.len();
        tree.nodes[node] = Bvh2Node::new(bounds, 0, left as u32);
        tree.nodes.extend([Bvh2Node::default(); 2]);
        open.push((left + 1, from + half, to));
        open.push((left, from, from + half));
    }
    tree
}

fn middle(b: &Aabb) -> Vec3A {
    b.min * 0.5 + b.max * 0.5
}

/// Wide nodes over `boxes` (at least one), at most `leaf_size` of them in a leaf.
pub(super) fn hierarchy(boxes: &[Aabb], leaf_size: u32) -> Wide {
    let wide = collapse(&cluster(boxes), leaf_size);
    if wide.depth <= MAX_DEPTH { wide } else { collapse(&halve(boxes), leaf_size) }
}
