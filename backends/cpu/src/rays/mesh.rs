//! Triangles in one space, and the hierarchy over them.

use glam::{Vec3, Vec3A};
use hashcache_core::geometry::Ray;
use obvhs::aabb::Aabb;

use super::build::hierarchy;
use super::holes::{Holes, MASKED};
use super::lanes::Lanes;
use super::layout::{Block, LEAF, Rows, WIDTH};
use super::traverse::{any, nearest_first};
use super::triangle::{self, Nearest, Shear};

/// A triangle and its number.
#[derive(Clone, Copy)]
pub(super) struct Numbered {
    pub(super) corners: [Vec3; 3],
    pub(super) id: u32,
    /// Whether it has holes.
    pub(super) masked: bool,
}

/// Triangles under a hierarchy.
pub(super) struct Mesh {
    pub(super) rows: Rows,
}

impl Mesh {
    /// Sorts triangles whose corners are finite; at least one.
    pub(super) fn new(triangles: &[Numbered]) -> Self {
        let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::from_points(&t.corners.map(Vec3A::from))).collect();
        let block = |leaf: &[u32]| {
            let mut sorted: Vec<&Numbered> = leaf.iter().map(|&i| &triangles[i as usize]).collect();
            sorted.sort_unstable_by_key(|triangle| triangle.id);
            let mut block = Block::EMPTY;
            for (slot, triangle) in sorted.into_iter().enumerate() {
                block.ids[slot] = triangle.id | if triangle.masked { MASKED } else { 0 };
                for (corner, point) in triangle.corners.iter().enumerate() {
                    for axis in 0..3 {
                        block.corners[corner][axis][slot] = point[axis];
                    }
                }
            }
            block
        };
        Self { rows: Rows::new(&hierarchy(&boxes, LEAF as u32), Some(&block)) }
    }

    /// Moves `nearest` to the nearest triangle before it.
    #[inline(always)]
    pub(super) fn closest<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(
        &self,
        l: L,
        ray: &Ray,
        holes: H,
        nearest: &mut Nearest,
    ) {
        let shear = Shear::new(l, ray);
        nearest_first(
            l,
            &self.rows,
            ray,
            nearest.t,
            #[inline(always)]
            |leaf| {
                triangle::closest(l, self.rows.block(leaf), &shear, ray.t_max, holes, nearest);
                nearest.t
            },
        );
    }

    /// Whether a triangle lies on the segment.
    #[inline(always)]
    pub(super) fn occluded<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(&self, l: L, ray: &Ray, holes: H) -> bool {
        let shear = Shear::new(l, ray);
        any(
            l,
            &self.rows,
            ray,
            #[inline(always)]
            |leaf| triangle::occluded(l, self.rows.block(leaf), &shear, ray.t_max, holes),
        )
    }
}
