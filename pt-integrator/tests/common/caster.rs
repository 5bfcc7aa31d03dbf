//! A ray caster without a structure: every triangle, in f32, as a real one would.

use hashcache_core::geometry::{Hit, Ray};
use hashcache_core::traits::RayCaster;
use pt_integrator::glam::Vec3;
use pt_integrator::scene::SceneData;

/// One placed triangle.
struct Placed {
    corners: [Vec3; 3],
    triangle: u32,
    instance: u32,
}

/// Tries every triangle of a scene.
pub struct BruteForce(Vec<Placed>);

impl BruteForce {
    pub fn new(scene: &SceneData) -> Self {
        let mut placed = Vec::new();
        for (i, instance) in scene.instances.iter().enumerate() {
            let mesh = scene.meshes[instance.mesh as usize];
            for triangle in mesh.first_triangle..mesh.first_triangle + mesh.triangle_count {
                let corners = scene.indices[triangle as usize]
                    .map(|v| instance.point(Vec3::from_array(scene.positions[v as usize])));
                placed.push(Placed { corners, triangle, instance: i as u32 });
            }
        }
        Self(placed)
    }

    fn hits<'a>(&'a self, ray: &'a Ray) -> impl Iterator<Item = Hit> + 'a {
        self.0.iter().filter_map(move |p| {
            let (t, u, v) = intersect(&p.corners, ray)?;
            Some(Hit { t, u, v, triangle: p.triangle, instance: p.instance })
        })
    }
}

impl RayCaster for BruteForce {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.hits(ray).min_by(|a, b| a.t.total_cmp(&b.t))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.hits(ray).next().is_some()
    }
}

/// Möller & Trumbore 1997, both sides.
fn intersect([a, b, c]: &[Vec3; 3], ray: &Ray) -> Option<(f32, f32, f32)> {
    let (e1, e2) = (*b - *a, *c - *a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = ray.origin - *a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    let t = e2.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.t_min && t < ray.t_max).then_some((t, u, v))
}
