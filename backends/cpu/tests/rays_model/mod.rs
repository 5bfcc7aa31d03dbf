//! Random triangles, random rays, and an intersector that tries every triangle in f64.

// Each test uses a part.
#![allow(dead_code)]

use backend_cpu::rays::CpuScene;
use glam::{DVec3, Vec3};
use hashcache_core::float::powf;
use hashcache_core::geometry::{Geometry, Hit, Instance, Mesh, Ray};
use hashcache_core::traits::RayCaster;

/// Triangles with corners of their own, placed by instances that all show the whole.
pub struct Soup {
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
    pub meshes: Vec<Mesh>,
    pub instances: Vec<Instance>,
}

impl Soup {
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let positions = triangles.iter().flatten().map(Vec3::to_array).collect();
        let count = triangles.len() as u32;
        Self {
            positions,
            indices: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            meshes: vec![Mesh { first_triangle: 0, triangle_count: count }],
            instances: vec![Instance::identity(0)],
        }
    }

    pub fn geometry(&self) -> Geometry<'_> {
        Geometry {
            positions: &self.positions,
            indices: &self.indices,
            meshes: &self.meshes,
            instances: &self.instances,
            ..Geometry::default()
        }
    }

    pub fn scene(&self) -> CpuScene {
        CpuScene::build(&self.geometry()).unwrap()
    }

    /// Distance, instance and triangle of every hit, near ones first, by Cramer's rule in f64; and whether the ray
    /// keeps clear of every edge and of every tie, so that rounding cannot change the answer.
    pub fn every_hit(&self, ray: &Ray) -> (Vec<(f64, u32, u32)>, bool) {
        const CLEAR: f64 = 1e-3;
        let (mut hits, mut clear) = (Vec::new(), true);
        for (number, instance) in (0..).zip(&self.instances) {
            for (index, corners) in (0..).zip(&self.indices) {
                let [a, b, c] = corners.map(|i| place(instance, Vec3::from(self.positions[i as usize]).as_dvec3()));
                let (e1, e2) = (b - a, c - a);
                let (d, s) = (ray.direction.as_dvec3(), ray.origin.as_dvec3() - a);
                let p = d.cross(e2);
                let det = e1.dot(p);
                let tilt = det.abs() / (e1.cross(e2).length() * d.length());
                let (u, v) = (s.dot(p) / det, d.dot(s.cross(e1)) / det);
                let t = e2.dot(s.cross(e1)) / det;
                let inner = u.min(v).min(1.0 - u - v);
                if tilt.is_nan() || tilt < CLEAR {
                    // Seen from the side, or without area: clear when the ray passes well away from it.
                    let away = [a, b, c].iter().all(|x| {
                        let x = *x - ray.origin.as_dvec3();
                        x.cross(d).length() > CLEAR * 1000.0 * (e1.length() + e2.length()) * d.length()
                    });
                    clear &= away;
                } else {
                    let near_end = [ray.t_min, ray.t_max].iter().any(|&e| (t - f64::from(e)).abs() <= CLEAR * t.abs());
                    let near_start = t.abs() * d.length() < CLEAR * ray.origin.as_dvec3().length();
                    clear &= inner.abs() > CLEAR && !(inner > 0.0 && (near_end || near_start));
                    if inner >= 0.0 && t > f64::from(ray.t_min) && t < f64::from(ray.t_max) {
                        hits.push((t, number, index));
                    }
                }
            }
        }
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let [first, second, ..] = hits[..] {
            clear &= second.0 - first.0 > CLEAR * second.0;
        }
        (hits, clear)
    }
}

pub fn place(instance: &Instance, p: DVec3) -> DVec3 {
    let row = |r: [f32; 4]| DVec3::new(r[0].into(), r[1].into(), r[2].into()).dot(p) + f64::from(r[3]);
    DVec3::from(instance.to_scene.map(row))
}

/// `pcg`-like numbers for tests that need many.
pub struct Numbers(pub u32);

impl Numbers {
    /// In [−1, 1).
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(1);
        hashcache_core::hash::pcg(self.0) as f32 / 2_147_483_648.0 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

pub fn rays(seed: u32, scale: f32, count: usize) -> Vec<Ray> {
    let mut numbers = Numbers(seed);
    let ray = |_| Ray {
        origin: numbers.vector() * scale,
        t_min: 0.0,
        // Lengths from 1e-6 to 1e6.
        direction: numbers.vector() * powf(10.0, 6.0 * numbers.next()),
        t_max: f32::INFINITY,
    };
    (0..count).map(ray).collect()
}

/// Compares with the model; returns how many rays were clear of edges and ties.
pub fn compare(soup: &Soup, scene: &CpuScene, rays: &[Ray]) -> usize {
    let mut clear_rays = 0;
    for ray in rays {
        let hit = scene.closest(ray);
        assert_eq!(scene.occluded(ray), hit.is_some(), "{ray:?}");
        let (hits, clear) = soup.every_hit(ray);
        if clear {
            clear_rays += 1;
            let Some(&(t, instance, triangle)) = hits.first() else {
                assert_eq!(hit, None, "{ray:?}");
                continue;
            };
            let hit = hit.unwrap_or_else(|| panic!("{ray:?} should meet {triangle} at {t}"));
            assert_eq!((hit.instance, hit.triangle), (instance, triangle), "{ray:?} {hit:?} at {t}");
            let point = soup.point(&hit);
            let on_ray = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
            // Rounding to f32, made worse a thousandfold where a triangle is seen almost from the side.
            let size = ray.origin.as_dvec3().length() + point.length();
            let error = (f64::from(hit.t) - t).abs() * ray.direction.as_dvec3().length();
            assert!(error <= 1e-4 * size, "{ray:?} {hit:?} at {t}");
            assert!((point - on_ray).length() <= 1e-4 * size, "{ray:?} {hit:?}: {point} is not {on_ray}");
        }
    }
    clear_rays
}

impl Soup {
    /// The point that a hit's barycentric weights name.
    pub fn point(&self, hit: &Hit) -> DVec3 {
        let instance = &self.instances[hit.instance as usize];
        let [a, b, c] = self.indices[hit.triangle as usize]
            .map(|i| place(instance, Vec3::from(self.positions[i as usize]).as_dvec3()));
        a + (b - a) * f64::from(hit.u) + (c - a) * f64::from(hit.v)
    }
}

pub fn soup(seed: u32, count: usize, scale: f32, size: f32) -> Soup {
    let mut numbers = Numbers(seed);
    let triangle = |_| {
        let middle = numbers.vector();
        [0; 3].map(|_| (middle + numbers.vector() * size) * scale)
    };
    Soup::new(&(0..count).map(triangle).collect::<Vec<_>>())
}

/// Whatever lies at an end of a ray's interval is not met: neither by the ray that ends where the first meeting is, nor
/// by the one that starts there.
pub fn interval_is_open(scene: &CpuScene, rays: &[Ray]) {
    for ray in rays {
        let Some(hit) = scene.closest(ray) else { continue };
        assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.000_001, "{ray:?} {hit:?}");
        let before = Ray { t_max: hit.t, ..*ray };
        assert_eq!(scene.closest(&before), None, "{before:?}");
        assert!(!scene.occluded(&before), "{before:?}");
        let beyond = Ray { t_min: hit.t, ..*ray };
        let next = scene.closest(&beyond);
        assert_eq!(scene.occluded(&beyond), next.is_some(), "{beyond:?}");
        assert!(next.is_none_or(|next| next.t > hit.t), "{beyond:?} {next:?}");
        let just = Ray { t_max: hit.t.next_up(), ..*ray };
        assert_eq!(scene.closest(&just), Some(hit), "{just:?}");
    }
}
