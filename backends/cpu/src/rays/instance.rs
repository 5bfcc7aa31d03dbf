//! Meshes placed more than once: a hierarchy over their boxes, and rays brought into their space.

use glam::{Mat3, Vec3, Vec3A};
use hashcache_core::geometry::{Instance, Ray};
use obvhs::aabb::Aabb;

use super::build::hierarchy;
use super::holes::Holes;
use super::lanes::Lanes;
use super::layout::{LEAF, Rows, WIDTH};
use super::mesh::Mesh;
use super::ray::is_within_range;
use super::traverse::{any, nearest_first};
use super::triangle::Nearest;

/// One placed mesh.
pub(super) struct Placed {
    /// Where the mesh's own origin lies in the scene.
    translation: Vec3,
    /// From the scene's directions to the mesh's.
    inverse: Mat3,
    /// Index of the mesh's hierarchy.
    mesh: usize,
    /// Index of the instance in the scene.
    instance: u32,
    bounds: Aabb,
}

impl Placed {
    /// A mesh in its place; `None` when the map cannot be turned round in `f32`: flat, or of an extreme size.
    pub(super) fn new(place: &Instance, instance: u32, mesh: usize, mesh_bounds: &Aabb) -> Option<Self> {
        let linear = Mat3::from_cols_array_2d(&place.to_scene.map(|row| [row[0], row[1], row[2]])).transpose();
        let inverse = linear.as_dmat3().inverse().as_mat3();
        let largest = |m: &Mat3| m.to_cols_array().into_iter().fold(0.0, |m: f32, x| m.max(x.abs()));
        let bounds = scene_bounds(place, mesh_bounds);
        let usable = inverse.is_finite()
            && is_within_range(largest(&inverse))
            && is_within_range(largest(&linear))
            && bounds.min.is_finite()
            && bounds.max.is_finite();
        let translation = Vec3::from(place.to_scene.map(|row| row[3]));
        usable.then_some(Self { translation, inverse, mesh, instance, bounds })
    }

    /// The ray in the mesh's space. Its direction keeps the length that the map gives it, so distances stay equal.
    #[inline(always)]
    fn inward(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.inverse * (ray.origin - self.translation),
            t_min: ray.t_min,
            direction: self.inverse * ray.direction,
            t_max: ray.t_max,
        }
    }
}

/// A box around a placed box.
///
/// The ray is rounded on its way into the mesh's space; the box is wider by 16 units in the last place of its largest
/// coordinate to make up for it.
fn scene_bounds(place: &Instance, mesh_bounds: &Aabb) -> Aabb {
    let mut bounds = Aabb::empty();
    for corner in 0..8 {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { mesh_bounds.min[axis] } else { mesh_bounds.max[axis] };
        bounds.extend(Vec3A::from(place.point(Vec3::new(pick(0), pick(1), pick(2)))));
    }
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element() * (16.0 * f32::EPSILON);
    Aabb::new(bounds.min - reach, bounds.max + reach)
}

/// All meshes placed by reference.
pub(super) struct Placements {
    pub(super) rows: Rows,
    pub(super) placed: Vec<Placed>,
    pub(super) meshes: Vec<Mesh>,
}

impl Placements {
    /// Sorts placed meshes; at least one.
    pub(super) fn new(placed: Vec<Placed>, meshes: Vec<Mesh>) -> Self {
        let boxes: Vec<Aabb> = placed.iter().map(|p| p.bounds).collect();
        let wide = hierarchy(&boxes, 1);
        let rows = Rows::new(&wide, None);
        let mut slots: Vec<Option<Placed>> = placed.into_iter().map(Some).collect();
        let placed = wide.leaves.iter().flatten().filter_map(|&i| slots[i as usize].take()).collect();
        Self { rows, placed, meshes }
    }

    /// Moves `nearest` to the nearest triangle before it. Returns the instance if it did.
    #[inline(always)]
    pub(super) fn closest<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(
        &self,
        l: L,
        ray: &Ray,
        holes: H,
        nearest: &mut Nearest,
    ) -> Option<u32> {
        let mut found = None;
        nearest_first(
            l,
            &self.rows,
            ray,
            nearest.t,
            #[inline(always)]
            |leaf| {
                let placed = &self.placed[leaf];
                let inner = placed.inward(ray);
                let mut candidate = Nearest { id: u32::MAX, ..*nearest };
                self.meshes[placed.mesh].closest(l, &inner, holes, &mut candidate);
                // A candidate is never farther than what was found before.
                let lower = found.is_some_and(|other| placed.instance < other);
                if candidate.id != u32::MAX && (candidate.t < nearest.t || lower) {
                    *nearest = candidate;
                    found = Some(placed.instance);
                }
                nearest.t
            },
        );
        found
    }

    /// Whether a triangle lies on the segment.
    #[inline(always)]
    pub(super) fn occluded<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(&self, l: L, ray: &Ray, holes: H) -> bool {
        any(
            l,
            &self.rows,
            ray,
            #[inline(always)]
            |leaf| {
                let placed = &self.placed[leaf];
                self.meshes[placed.mesh].occluded(l, &placed.inward(ray), holes)
            },
        )
    }
}
