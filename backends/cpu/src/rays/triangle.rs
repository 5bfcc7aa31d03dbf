//! Ray against eight triangles.

use hashcache_core::geometry::Ray;

use super::holes::Holes;
use super::lanes::Lanes;
use super::layout::{Block, LEAF};

/// The nearest triangle so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Distance; the segment's end while there is no triangle.
    pub(super) t: f32,
    /// Barycentric weights of the second and third corner, times `det`.
    pub(super) edges: [f32; 2],
    /// The sum of all three weights before they are divided.
    pub(super) det: f32,
    /// The triangle's number, or `u32::MAX`.
    pub(super) id: u32,
}

impl Nearest {
    /// Nothing found yet before `t_max`.
    #[inline(always)]
    pub(super) const fn none(t_max: f32) -> Self {
        Self { t: t_max, edges: [0.0; 2], det: 1.0, id: u32::MAX }
    }

    /// Barycentric weights of the second and third corner.
    #[inline(always)]
    pub(super) fn weights(&self) -> [f32; 2] {
        weights(self.edges, self.det)
    }
}

/// Barycentric weights from edge functions and their sum.
#[inline(always)]
fn weights(edges: [f32; 2], det: f32) -> [f32; 2] {
    [edges[0] / det, edges[1] / det]
}

/// What a block needs to know of a ray, eight times over.
#[derive(Clone, Copy)]
pub(super) struct Shear<L: Lanes<LEAF>> {
    axes: [usize; 3],
    origin: [L::Vector; 3],
    slope: [L::Vector; 2],
    depth: L::Vector,
    t_min: L::Vector,
}

impl<L: Lanes<LEAF>> Shear<L> {
    /// Constants of a ray; see [`super::traverse`] for the way they are made.
    #[inline(always)]
    pub(super) fn new(l: L, ray: &Ray) -> Self {
        let (origin, d): (&[f32; 3], &[f32; 3]) = (ray.origin.as_ref(), ray.direction.as_ref());
        let [x, y, z] = d.map(f32::abs);
        let xy = usize::from(y > x);
        let kz = if z > x.max(y) { 2 } else { xy };
        let (kx, ky) = ([1, 2, 0][kz], [2, 0, 1][kz]);
        let depth = l.splat(1.0 / d[kz]);
        Self {
            axes: [kx, ky, kz],
            origin: [l.splat(origin[kx]), l.splat(origin[ky]), l.splat(origin[kz])],
            slope: [l.mul(l.splat(d[kx]), depth), l.mul(l.splat(d[ky]), depth)],
            depth,
            t_min: l.splat(ray.t_min),
        }
    }

    /// Corners in a space where the ray is the third axis.
    #[inline(always)]
    fn corner(&self, l: L, corner: &[[f32; LEAF]; 3]) -> [L::Vector; 3] {
        let [kx, ky, kz] = self.axes;
        let z = l.sub(l.load(&corner[kz]), self.origin[2]);
        let x = l.sub(l.sub(l.load(&corner[kx]), self.origin[0]), l.mul(self.slope[0], z));
        let y = l.sub(l.sub(l.load(&corner[ky]), self.origin[1]), l.mul(self.slope[1], z));
        [x, y, z]
    }
}

/// Distances and edge functions where the ray meets the planes of a block's triangles.
struct Meeting<L: Lanes<LEAF>> {
    t: L::Vector,
    edges: [L::Vector; 2],
    det: L::Vector,
}

impl<L: Lanes<LEAF>> Meeting<L> {
    /// The sum of one triangle's edge functions.
    #[inline(always)]
    fn det_at(&self, l: L, place: usize) -> f32 {
        l.store(self.det)[place]
    }

    /// Two of one triangle's edge functions.
    #[inline(always)]
    fn edges_at(&self, l: L, place: usize) -> [f32; 2] {
        [l.store(self.edges[0])[place], l.store(self.edges[1])[place]]
    }
}

/// Which triangles of the block the ray meets beyond `t_min` and not beyond `t_end`.
///
/// # Source
/// Woop et al. 2013, without its double precision: a ray that meets
/// an edge within rounding counts for the triangles on both sides, so it cannot pass between them.
#[inline(always)]
fn meet<L: Lanes<LEAF>>(l: L, block: &Block, s: &Shear<L>, t_end: f32) -> Option<(u32, Meeting<L>)> {
    let [ax, ay, az] = s.corner(l, &block.corners[0]);
    let [bx, by, bz] = s.corner(l, &block.corners[1]);
    let [cx, cy, cz] = s.corner(l, &block.corners[2]);
    let u = l.sub(l.mul(cx, by), l.mul(cy, bx));
    let v = l.sub(l.mul(ax, cy), l.mul(ay, cx));
    let w = l.sub(l.mul(bx, ay), l.mul(by, ax));
    let zero = l.splat(0.0);
    let inside = l.le(zero, l.min(l.min(u, v), w)) | l.le(l.max(l.max(u, v), w), zero);
    if inside == 0 {
        return None;
    }
    let det = l.add(l.add(u, v), w);
    let z = l.add(l.add(l.mul(u, az), l.mul(v, bz)), l.mul(w, cz));
    // 0/0 in a triangle without area: NaN is in no interval.
    let t = l.mul(l.div(z, det), s.depth);
    let mask = inside & l.lt(s.t_min, t) & l.le(t, l.splat(t_end));
    (mask != 0).then_some((mask, Meeting { t, edges: [v, w], det }))
}

/// Moves `nearest` to a triangle of the block that is nearer, or as near and lower in number.
#[inline(always)]
pub(super) fn closest<L: Lanes<LEAF>, H: Holes>(
    l: L,
    block: &Block,
    s: &Shear<L>,
    t_max: f32,
    holes: H,
    nearest: &mut Nearest,
) {
    let Some((mut mask, meeting)) = meet(l, block, s, nearest.t) else { return };
    let t = l.store(meeting.t);
    let mut place = LEAF;
    while mask != 0 {
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let id = holes.number(block.ids[i]);
        if (t[i] < nearest.t || (t[i] <= nearest.t && t[i] < t_max && id < nearest.id))
            && !passes(l, block, &meeting, holes, i)
        {
            (nearest.t, nearest.id) = (t[i], id);
            place = i;
        }
    }
    if place < LEAF {
        nearest.det = meeting.det_at(l, place);
        nearest.edges = meeting.edges_at(l, place);
    }
}

/// Whether the ray meets a triangle of the block before `t_max`.
#[inline(always)]
pub(super) fn occluded<L: Lanes<LEAF>, H: Holes>(l: L, block: &Block, s: &Shear<L>, t_max: f32, holes: H) -> bool {
    let Some((mask, meeting)) = meet(l, block, s, t_max) else { return false };
    let mut mask = mask & l.lt(meeting.t, l.splat(t_max));
    while mask != 0 {
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        if !passes(l, block, &meeting, holes, i) {
            return true;
        }
    }
    false
}

/// Whether the ray passes a triangle of the block that it meets.
#[inline(always)]
fn passes<L: Lanes<LEAF>, H: Holes>(l: L, block: &Block, meeting: &Meeting<L>, holes: H, place: usize) -> bool {
    holes.passes(
        block.ids[place],
        #[inline(always)]
        || weights(meeting.edges_at(l, place), meeting.det_at(l, place)),
    )
}
