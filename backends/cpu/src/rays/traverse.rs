//! The way of a ray through a hierarchy.

use hashcache_core::geometry::Ray;

use super::lanes::Lanes;
use super::layout::{Child, Node, Rows, WIDTH};
use super::stack::Stack;

/// Entries of the stack: each level leaves at most seven.
pub(super) const STACK: usize = 256;

/// Deepest hierarchy that the stack suffices for.
pub(super) const MAX_DEPTH: usize = (STACK - 8) / 7;

/// The first row of near planes: that of the upper planes when the ray runs towards lower values.
#[inline(always)]
fn row(direction: f32) -> usize {
    if direction.is_sign_negative() { 3 } else { 0 }
}

/// A ray's constants for boxes, eight times over.
struct Slabs<L: Lanes<WIDTH>> {
    near: [usize; 3],
    origin: [L::Vector; 3],
    inverse_near: [L::Vector; 3],
    inverse_far: [L::Vector; 3],
    t_min: L::Vector,
}

/// How much a box is widened, as a part of its distance along each axis: 2⁻²¹, 8 half-units in the last place.
///
/// Source of the need: three roundings for a plane's distance, four for a corner in the triangle test. Less, and a ray
/// may miss the box of a triangle that it meets; more only costs visits.
const MARGIN: f32 = 1.0 / 2_097_152.0;

impl<L: Lanes<WIDTH>> Slabs<L> {
    /// Constants of a ray.
    ///
    /// From the ray's own memory straight into registers: a struct of scalars in between is stored and loaded in
    /// pieces of other sizes, which stalls (12 % of a short ray's time).
    #[inline(always)]
    fn new(l: L, ray: &Ray) -> Self {
        let (origin, d) = (ray.origin, ray.direction);
        // Behind the origin the margin would narrow boxes.
        let margin = if ray.t_min < 0.0 { 0.0 } else { MARGIN };
        let (nearer, farther) = (l.splat(1.0 - margin), l.splat(1.0 + margin));
        let inverse = [l.splat(1.0 / d.x), l.splat(1.0 / d.y), l.splat(1.0 / d.z)];
        Self {
            near: [row(d.x), row(d.y), row(d.z)],
            origin: [l.splat(origin.x), l.splat(origin.y), l.splat(origin.z)],
            inverse_near: [l.mul(inverse[0], nearer), l.mul(inverse[1], nearer), l.mul(inverse[2], nearer)],
            inverse_far: [l.mul(inverse[0], farther), l.mul(inverse[1], farther), l.mul(inverse[2], farther)],
            t_min: l.splat(ray.t_min),
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

/// Visits the leaves that a ray passes before `t_end`, near ones first. `leaf` returns the
/// end from there on: the same or nearer.
#[inline(always)]
pub(super) fn nearest_first<L: Lanes<WIDTH>>(
    l: L,
    rows: &Rows,
    ray: &Ray,
    t_end: f32,
    mut leaf: impl FnMut(usize) -> f32,
) {
    let slabs = Slabs::new(l, ray);
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
pub(super) fn any<L: Lanes<WIDTH>>(l: L, rows: &Rows, ray: &Ray, mut leaf: impl FnMut(usize) -> bool) -> bool {
    let slabs = Slabs::new(l, ray);
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
        let (mut mask, _) = slabs.enter(l, node, ray.t_max);
        while mask != 0 {
            let i = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            stack.push(node.children[i]);
        }
    }
    false
}
