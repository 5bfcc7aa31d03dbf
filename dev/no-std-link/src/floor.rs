//! A scene of one triangle in the plane y = 0 that a caster hits by arithmetic.

use backend_api::{HitRecord, RayRecord, TraceRays};
use hashcache_core::geometry::{Hit, Instance, Ray};
use hashcache_core::glam::Vec3;
use hashcache_core::traits::RayCaster;
use pt_integrator::packed::{PackedVertex, SceneInstance, SceneTriangle};
use pt_integrator::scene::NONE;

/// Corners, counter-clockwise seen from above: the square of ±100 m about the origin lies inside.
pub const CORNERS: [[f32; 3]; 3] = [[-100.0, 0.0, -100.0], [-100.0, 0.0, 300.0], [300.0, 0.0, -100.0]];

/// The triangle as the integrator reads it.
pub fn triangle() -> SceneTriangle {
    SceneTriangle {
        vertices: CORNERS.map(|position| PackedVertex { position, normal: NONE }),
        uv: [[0.0; 2]; 3],
        material: 0,
        emitter: NONE,
    }
}

/// The instance that holds it.
pub fn instance() -> SceneInstance {
    SceneInstance::new(&Instance::identity(0))
}

/// Casts rays against the triangle.
pub struct Floor;

impl RayCaster for Floor {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let t = -ray.origin.y / ray.direction.y;
        let at = ray.origin + ray.direction * t;
        let (u, v) = ((at.z + 100.0) / 400.0, (at.x + 100.0) / 400.0);
        let met = t > ray.t_min && t < ray.t_max && u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        met.then_some(Hit { t, u, v, triangle: 0, instance: 0 })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.closest(ray).is_some()
    }
}

impl TraceRays for Floor {
    fn trace_closest(&self, ray: &RayRecord) -> HitRecord {
        let miss = Hit { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: HitRecord::MISS, instance: HitRecord::MISS };
        let Hit { t, u, v, triangle, instance } = self.closest(&plain(ray)).unwrap_or(miss);
        HitRecord { t, u, v, triangle, instance }
    }

    fn trace_occluded(&self, ray: &RayRecord) -> bool {
        self.occluded(&plain(ray))
    }
}

fn plain(ray: &RayRecord) -> Ray {
    Ray {
        origin: Vec3::from_array(ray.origin),
        t_min: ray.t_min,
        direction: Vec3::from_array(ray.direction),
        t_max: ray.t_max,
    }
}
