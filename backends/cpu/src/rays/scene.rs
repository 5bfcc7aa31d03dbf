//! The ray caster's face.

use std::time::Duration;

use backend_api::{Error, HitRecord, RayRecord, TraceRays};
use glam::{Vec3, Vec3A};
use hashcache_core::geometry::{Geometry, Hit, Ray};
use hashcache_core::traits::RayCaster;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as BvhRay, RayHit};
use obvhs::triangle::Triangle;

/// A scene's triangles, ready to be met by rays.
pub struct CpuScene {
    tree: Option<CwBvh>,
    triangles: Vec<Triangle>,
    ids: Vec<[u32; 2]>,
}

impl CpuScene {
    /// Sorts the triangles of `geometry` into a hierarchy. Triangles with a corner that is not finite are left out.
    ///
    /// # Errors
    /// [`Error::BadRange`] when an index, mesh or instance names something that is not there.
    pub fn build(geometry: &Geometry<'_>) -> Result<Self, Error> {
        let bad =
            |offset: usize, size: usize| Error::BadRange { at: "geometry", offset: offset as u64, size: size as u64 };
        let (mut triangles, mut ids) = (Vec::new(), Vec::new());
        for (number, instance) in geometry.instances.iter().enumerate() {
            let mesh = geometry.meshes.get(instance.mesh as usize).ok_or_else(|| bad(instance.mesh as usize, 1))?;
            let (first, count) = (mesh.first_triangle as usize, mesh.triangle_count as usize);
            let run = geometry.indices.get(first..first + count).ok_or_else(|| bad(first, count))?;
            for (place, corners) in run.iter().enumerate() {
                let mut points = [Vec3A::ZERO; 3];
                for (point, &corner) in points.iter_mut().zip(corners) {
                    let position = geometry.positions.get(corner as usize).ok_or_else(|| bad(corner as usize, 1))?;
                    *point = instance.point(Vec3::from(*position)).into();
                }
                if points.iter().all(|p| p.is_finite()) {
                    triangles.push(Triangle { v0: points[0], v1: points[1], v2: points[2] });
                    ids.push([number as u32, (first + place) as u32]);
                }
            }
        }
        let mut scene = Self { tree: None, triangles, ids };
        if !scene.triangles.is_empty() {
            let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
            let mut elapsed = Duration::ZERO;
            let tree = build_cwbvh_from_tris(&scene.triangles, params, &mut elapsed);
            scene.triangles = tree.primitive_indices.iter().map(|&i| scene.triangles[i as usize]).collect();
            scene.ids = tree.primitive_indices.iter().map(|&i| scene.ids[i as usize]).collect();
            scene.tree = Some(tree);
        }
        Ok(scene)
    }
}

fn usable(ray: &Ray) -> Option<BvhRay> {
    let finite = ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != Vec3::ZERO;
    (finite && ray.t_min < ray.t_max)
        .then(|| BvhRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max))
}

fn meet(triangle: &Triangle, ray: &BvhRay, last: f32) -> f32 {
    let t = triangle.intersect(ray);
    if t > ray.tmin && t < last { t } else { f32::INFINITY }
}

impl RayCaster for CpuScene {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let (tree, segment) = (self.tree.as_ref()?, usable(ray)?);
        let mut hit = RayHit::none();
        tree.ray_traverse(segment, &mut hit, |r, id| meet(&self.triangles[id], r, ray.t_max));
        let triangle = self.triangles.get(hit.primitive_id as usize)?;
        let (e1, e2) = (triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
        let p = segment.direction.cross(e2);
        let (det, s) = (e1.dot(p), segment.origin - triangle.v0);
        let (u, v) = (s.dot(p) / det, segment.direction.dot(s.cross(e1)) / det);
        let [instance, triangle] = self.ids[hit.primitive_id as usize];
        Some(Hit { t: hit.t, u, v, triangle, instance })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let (Some(tree), Some(segment)) = (self.tree.as_ref(), usable(ray)) else { return false };
        !tree.ray_traverse_miss(segment, |r, id| meet(&self.triangles[id], r, ray.t_max))
    }
}

fn plain(ray: &RayRecord) -> Ray {
    Ray { origin: ray.origin.into(), t_min: ray.t_min, direction: ray.direction.into(), t_max: ray.t_max }
}

impl TraceRays for CpuScene {
    fn trace_closest(&self, ray: &RayRecord) -> HitRecord {
        match self.closest(&plain(ray)) {
            Some(Hit { t, u, v, triangle, instance }) => HitRecord { t, u, v, triangle, instance },
            None => {
                HitRecord { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: HitRecord::MISS, instance: HitRecord::MISS }
            }
        }
    }

    fn trace_occluded(&self, ray: &RayRecord) -> bool {
        self.occluded(&plain(ray))
    }
}

#[cfg(test)]
mod tests {
    use hashcache_core::geometry::{Instance, Mesh};

    use super::*;

    #[test]
    fn a_ray_meets_the_nearer_of_two_triangles() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        let geometry = Geometry {
            positions: &positions,
            indices: &[[0, 1, 2], [3, 4, 5]],
            meshes: &[Mesh { first_triangle: 0, triangle_count: 2 }],
            instances: &[Instance::identity(0)],
        };
        let scene = CpuScene::build(&geometry).unwrap();
        let ray = Ray { origin: Vec3::new(0.25, 0.5, 3.0), t_min: 0.0, direction: Vec3::NEG_Z, t_max: f32::INFINITY };
        let hit = scene.closest(&ray).unwrap();
        assert_eq!((hit.triangle, hit.instance, hit.t), (1, 0, 2.0));
        assert!((hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6, "{hit:?}");
        assert!(scene.occluded(&ray));
        assert!(!scene.occluded(&Ray { t_max: 2.0, ..ray }));
    }
}
