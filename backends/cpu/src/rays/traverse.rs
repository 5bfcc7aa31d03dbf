//! The way of a ray through a hierarchy.

use super::lanes::Lanes;
use super::layout::{Child, Node, Rows, WIDTH};
use super::segment::Segment;
use super::stack::Stack;

/// Entries of the stack: each level leaves at most seven.
pub(super) const STACK: usize = 256;

/// Deepest hierarchy that the stack suffices for.
pub(super) const MAX_DEPTH: usize = (STACK - 8) / 7;

/// A ray's constants for boxes, eight times over.
struct Slabs<L: Lanes<WIDTH>> {
    near: [usize; 3],
    origin: [L::Vector; 3],
    inverse_near: [L::Vector; 3],
    inverse_far: [L::Vector; 3],
    t_min: L::Vector,
}

#[inline(always)]
fn splat3<L: Lanes<WIDTH>>(l: L, x: [f32; 3]) -> [L::Vector; 3] {
    [l.splat(x[0]), l.splat(x[1]), l.splat(x[2])]
}

impl<L: Lanes<WIDTH>> Slabs<L> {
    #[inline(always)]
    fn new(l: L, s: &Segment) -> Self {
        Self {
            near: s.backwards.map(|b| if b { 3 } else { 0 }),
            origin: splat3(l, s.origin),
            inverse_near: splat3(l, s.inverse_near),
            inverse_far: splat3(l, s.inverse_far),
            t_min: l.splat(s.t_min),
        }
    }

    /// Which boxes the ray passes before `t_end`, and where it enters them.
    ///
    /// A ray within a plane gives 0·∞ = NaN for that plane, and `min` and `max` keep the other operand: the plane
    /// does not bound the ray.
    #[inline(always)]
    fn enter(&self, l: L, node: &Node, t_end: f32) -> (u32, L::Vector) {
        let (mut t_in, mut t_out) = (self.t_min, l.splat(t_end));
        for axis in 0..3 {
            let (near, far) = (self.near[axis] + axis, 3 - self.near[axis] + axis);
            let near = l.mul(l.sub(l.load(&node.bounds[near]), self.origin[axis]), self.inverse_near[axis]);
            let far = l.mul(l.sub(l.load(&node.bounds[far]), self.origin[axis]), self.inverse_far[axis]);
            t_in = l.max(near, t_in);
            t_out = l.min(far, t_out);
        }
        (l.le(t_in, t_out), t_in)
    }
}

/// Visits the leaves a ray passes before `*t_end`, near ones first; `leaf` may draw `*t_end` nearer.
#[inline(always)]
pub(super) fn nearest_first<L: Lanes<WIDTH>>(
    l: L,
    rows: &Rows,
    s: &Segment,
    t_end: f32,
    mut leaf: impl FnMut(usize) -> f32,
) {
    let slabs = Slabs::new(l, s);
    let mut t_end = t_end;
    let mut stack = Stack::<(Child, f32), STACK>::new();
    let mut child = Child::ROOT;
    'visit: loop {
        'pop: {
            if child.is_leaf() {
                t_end = leaf(child.index());
                break 'pop;
            }
            let node = rows.node(child.index());
            let (mut mask, t_in) = slabs.enter(l, node, t_end);
            if mask == 0 {
                break 'pop;
            }
            let first = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            child = node.children[first];
            if mask == 0 {
                continue 'visit;
            }
            let t_in = l.store(t_in);
            let mut t = t_in[first];
            let bottom = stack.len();
            while mask != 0 {
                let i = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                // The nearest stays in hand; the others go to the stack, the nearest of them on top.
                let mut entry = (node.children[i], t_in[i]);
                l.prefetch(rows.address(entry.0));
                if entry.1 < t {
                    (entry, (child, t)) = ((child, t), entry);
                }
                stack.insert(
                    bottom,
                    entry,
                    #[inline(always)]
                    |other| other.1 < entry.1,
                );
            }
            continue 'visit;
        }
        loop {
            let Some((next, t)) = stack.pop() else { return };
            if t <= t_end {
                child = next;
                break;
            }
        }
    }
}

/// Whether `leaf` says yes to any leaf the ray passes.
#[inline(always)]
pub(super) fn any<L: Lanes<WIDTH>>(l: L, rows: &Rows, s: &Segment, mut leaf: impl FnMut(usize) -> bool) -> bool {
    let slabs = Slabs::new(l, s);
    let mut stack = Stack::<Child, STACK>::new();
    stack.push(Child::ROOT);
    while let Some(child) = stack.pop() {
        if child.is_leaf() {
            if leaf(child.index()) {
                return true;
            }
            continue;
        }
        let node = rows.node(child.index());
        let (mut mask, _) = slabs.enter(l, node, s.t_max);
        while mask != 0 {
            let i = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            l.prefetch(rows.address(node.children[i]));
            stack.push(node.children[i]);
        }
    }
    false
}
