//! A binary hierarchy into one of eight boxes a node, at the least expected cost.

use super::build::Binary;
use super::layout::{Child, Node, WIDTH};

/// Expected cost of a leaf, where a node's is [`NODE_COST`]. Of 0.5, 1, 2 and 4 the first gave the fastest rays in
/// `benches/rays.rs` and in a furnished room of a million triangles; more makes leaves emptier.
const LEAF_COST: f32 = 0.5;
/// Expected cost of a node: the unit.
const NODE_COST: f32 = 1.0;

/// What is known of a binary subtree.
#[derive(Clone, Copy)]
struct Plan {
    /// Least cost of the subtree as at most `i + 1` children of one node.
    cost: [f32; WIDTH],
    /// How many of these children the left side gets; 0: one child fewer is no dearer.
    left: [u8; WIDTH],
    /// As one child, whether it is a leaf.
    leaf: bool,
    /// Primitives.
    count: u32,
}

/// The result.
pub(super) struct Wide {
    /// The root first.
    pub(super) nodes: Vec<Node>,
    /// Primitives of each leaf.
    pub(super) leaves: Vec<Vec<u32>>,
    /// Levels of nodes.
    pub(super) depth: usize,
}

/// Cuts `tree` into wide nodes. A leaf gets at most `leaf_size` primitives.
///
/// # Source
/// Ylitie et al. 2017, section 3.1;
/// a leaf costs the same however full it is, since all its triangles are tested at once.
pub(super) fn collapse(tree: &Binary, leaf_size: u32) -> Wide {
    let plans = plan(tree, leaf_size);
    let mut wide = Wide { nodes: vec![Node::EMPTY], leaves: Vec::new(), depth: 1 };
    let mut open = vec![(0u32, 0usize, 1usize)];
    while let Some((binary, place, depth)) = open.pop() {
        wide.depth = wide.depth.max(depth);
        let mut children = Vec::with_capacity(WIDTH);
        if plans[binary as usize].leaf {
            children.push(binary); // only the root: a tree of one leaf
        } else {
            let first = tree.nodes[binary as usize].first_index;
            let left = plans[binary as usize].left[WIDTH - 1];
            gather(tree, &plans, first, left, &mut children);
            gather(tree, &plans, first + 1, WIDTH as u8 - left, &mut children);
        }
        for (slot, &child) in children.iter().enumerate() {
            let bounds = tree.nodes[child as usize].aabb();
            for axis in 0..3 {
                wide.nodes[place].bounds[axis][slot] = bounds.min[axis];
                wide.nodes[place].bounds[3 + axis][slot] = bounds.max[axis];
            }
            wide.nodes[place].children[slot] = if plans[child as usize].leaf {
                wide.leaves.push(collect(tree, child));
                Child::leaf(wide.leaves.len() as u32 - 1)
            } else {
                let new = wide.nodes.len();
                wide.nodes.push(Node::EMPTY);
                open.push((child, new, depth + 1));
                Child::node(new as u32)
            };
        }
    }
    wide
}

/// The children that stand for a subtree that may use `room` of them.
fn gather(tree: &Binary, plans: &[Plan], node: u32, room: u8, children: &mut Vec<u32>) {
    let plan = &plans[node as usize];
    let mut room = room as usize;
    while room > 1 && plan.left[room - 1] == 0 {
        room -= 1;
    }
    if room == 1 {
        children.push(node);
    } else {
        let (first, left) = (tree.nodes[node as usize].first_index, plan.left[room - 1]);
        gather(tree, plans, first, left, children);
        gather(tree, plans, first + 1, room as u8 - left, children);
    }
}

/// The primitives under a node.
fn collect(tree: &Binary, node: u32) -> Vec<u32> {
    let (mut primitives, mut open) = (Vec::new(), vec![node]);
    while let Some(node) = open.pop() {
        let node = &tree.nodes[node as usize];
        if node.is_leaf() {
            let first = node.first_index as usize;
            primitives.extend(&tree.primitives[first..first + node.prim_count as usize]);
        } else {
            open.extend([node.first_index + 1, node.first_index]);
        }
    }
    primitives
}

/// Costs from the leaves up.
fn plan(tree: &Binary, leaf_size: u32) -> Vec<Plan> {
    let empty = Plan { cost: [0.0; WIDTH], left: [0; WIDTH], leaf: true, count: 0 };
    let mut plans = vec![empty; tree.nodes.len()];
    for &node in order(tree).iter().rev() {
        let binary = &tree.nodes[node as usize];
        let area = binary.aabb().half_area();
        let as_leaf = area * LEAF_COST;
        let plan = if binary.is_leaf() {
            Plan { cost: [as_leaf; WIDTH], count: binary.prim_count, ..empty }
        } else {
            let (l, r) = (&plans[binary.first_index as usize], &plans[binary.first_index as usize + 1]);
            inner(l, r, area, if l.count + r.count <= leaf_size { as_leaf } else { f32::INFINITY })
        };
        plans[node as usize] = plan;
    }
    plans
}

/// Costs of a node from those of its children.
fn inner(l: &Plan, r: &Plan, area: f32, as_leaf: f32) -> Plan {
    let mut plan = Plan { cost: [f32::INFINITY; WIDTH], left: [0; WIDTH], leaf: false, count: l.count + r.count };
    for room in 2..=WIDTH {
        for left in 1..room {
            let cost = l.cost[left - 1] + r.cost[room - left - 1];
            if cost < plan.cost[room - 1] || plan.left[room - 1] == 0 {
                (plan.cost[room - 1], plan.left[room - 1]) = (cost, left as u8);
            }
        }
    }
    let as_node = plan.cost[WIDTH - 1] + area * NODE_COST;
    plan.leaf = as_leaf <= as_node;
    plan.cost[0] = as_leaf.min(as_node);
    // The full width keeps its division: it is also what the node itself opens into.
    for room in 2..WIDTH {
        if plan.cost[room - 2] <= plan.cost[room - 1] {
            (plan.cost[room - 1], plan.left[room - 1]) = (plan.cost[room - 2], 0);
        }
    }
    plan
}

/// Every node after its parent.
fn order(tree: &Binary) -> Vec<u32> {
    let mut order = Vec::with_capacity(tree.nodes.len());
    order.push(0);
    let mut next = 0;
    while next < order.len() {
        let node = &tree.nodes[order[next] as usize];
        if !node.is_leaf() {
            order.extend([node.first_index, node.first_index + 1]);
        }
        next += 1;
    }
    order
}
