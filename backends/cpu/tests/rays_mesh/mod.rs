//! A closed mesh of about a million triangles by formula, and rays of four kinds through it, for the check figures and
//! the benchmark.

// The test and the benchmark each use a part.
#![allow(dead_code)]

use std::f64::consts::PI;

use glam::Vec3;
use hashcache_core::float::{cos, sin, tan};
use hashcache_core::geometry::{Geometry, Instance, Mesh, Ray};
use hashcache_core::hash::pcg;
use hashcache_core::traits::RayCaster;

/// A mesh that stands for itself.
pub struct Blob {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// Triangles.
    pub indices: Vec<[u32; 3]>,
    meshes: [Mesh; 1],
    instances: [Instance; 1],
}

impl Blob {
    /// A closed, bumpy ball of radius about 1: `2·columns·(rows − 1)` triangles. Computed in f64, rounded once.
    pub fn new(rows: u32, columns: u32) -> Self {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for i in 0..=rows {
            for j in 0..columns {
                let t = PI * f64::from(i) / f64::from(rows);
                let p = 2.0 * PI * f64::from(j) / f64::from(columns);
                let r = 1.0
                    + 0.12 * (5.0 * t + 1.0).sin() * (4.0 * p).sin()
                    + 0.06 * (13.0 * t).sin() * (11.0 * p + 0.5).cos()
                    + 0.02 * (41.0 * t).sin() * (37.0 * p).sin()
                    + 0.006 * (127.0 * t).sin() * (113.0 * p).sin();
                let point = [r * t.sin() * p.cos(), r * t.cos(), r * t.sin() * p.sin()];
                positions.push(point.map(|x| x as f32));
            }
        }
        for i in 0..rows {
            for j in 0..columns {
                let k = (j + 1) % columns;
                let (a, b, c, d) = (i * columns + j, i * columns + k, (i + 1) * columns + j, (i + 1) * columns + k);
                if i < rows - 1 {
                    indices.push([a, d, c]);
                }
                if i > 0 {
                    indices.push([a, b, d]);
                }
            }
        }
        let meshes = [Mesh { first_triangle: 0, triangle_count: indices.len() as u32 }];
        Self { positions, indices, meshes, instances: [Instance::identity(0)] }
    }

    /// What a ray caster builds from.
    pub fn geometry(&self) -> Geometry<'_> {
        Geometry {
            positions: &self.positions,
            indices: &self.indices,
            meshes: &self.meshes,
            instances: &self.instances,
            ..Geometry::default()
        }
    }
}

/// Rays of one view from within the blob.
pub struct Rays {
    /// From the camera through the pixel centres, in tiles of 4×4.
    pub primary: Vec<Ray>,
    /// From where those hit, cosine-distributed.
    pub diffuse: Vec<Ray>,
    /// From there to points on a small sphere.
    pub shadow: Vec<Ray>,
    /// The diffuse rays, ending at 0.25.
    pub ambient: Vec<Ray>,
}

const EYE: Vec3 = Vec3::new(0.2, 0.1, -0.3);
const TARGET: Vec3 = Vec3::new(-0.6, -0.2, 0.7);
const LIGHT: Vec3 = Vec3::new(0.0, 0.4, 0.1);

fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// Random number `d` of ray `n`, in [0, 1).
fn random(n: u32, d: u32) -> f32 {
    (pcg(n * 4 + d) >> 8) as f32 / 16_777_216.0
}

impl Rays {
    /// Rays for `size`×`size` pixels; `caster` finds the points where the secondary rays start.
    pub fn new(blob: &Blob, caster: &impl RayCaster, size: u32) -> Self {
        let mut rays = Self { primary: primary(size), diffuse: Vec::new(), shadow: Vec::new(), ambient: Vec::new() };
        for (n, ray) in (0..).zip(&rays.primary) {
            let Some(hit) = caster.closest(ray) else { continue };
            let [a, b, c] = blob.indices[hit.triangle as usize].map(|i| Vec3::from(blob.positions[i as usize]));
            let mut normal = unit((b - a).cross(c - a));
            if normal.dot(ray.direction) > 0.0 {
                normal = -normal;
            }
            let origin = ray.origin + ray.direction * hit.t + normal * 1e-4;
            let direction = cosine_distributed(normal, n);
            let free = Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY };
            rays.diffuse.push(free);
            rays.ambient.push(Ray { t_max: 0.25, ..free });
            let z = 1.0 - 2.0 * random(n, 2);
            let (radius, angle) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * random(n, 3));
            let light = LIGHT + Vec3::new(radius * cos(angle), radius * sin(angle), z) * 0.1;
            rays.shadow.push(Ray { direction: light - origin, t_max: 0.999, ..free });
        }
        rays
    }
}

fn primary(size: u32) -> Vec<Ray> {
    let forward = unit(TARGET - EYE);
    let right = unit(forward.cross(Vec3::Y));
    let up = right.cross(forward);
    let extent = tan(60.0 * 0.5 * std::f32::consts::PI / 180.0);
    let tiles = (0..size / 4).flat_map(|y| (0..size / 4).map(move |x| (4 * x, 4 * y)));
    let pixels = tiles.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
    let ray = |(x, y): (u32, u32)| {
        let x = (2.0 * (x as f32 + 0.5) / size as f32 - 1.0) * extent;
        let y = (1.0 - 2.0 * (y as f32 + 0.5) / size as f32) * extent;
        Ray { origin: EYE, t_min: 0.0, direction: unit(forward + right * x + up * y), t_max: f32::INFINITY }
    };
    pixels.map(ray).collect()
}

/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
fn cosine_distributed(n: Vec3, index: u32) -> Vec3 {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let (t, s) =
        (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y));
    let (radius, angle) = (random(index, 0).sqrt(), std::f32::consts::TAU * random(index, 1));
    unit(t * (radius * cos(angle)) + s * (radius * sin(angle)) + n * (1.0 - random(index, 0)).max(0.0).sqrt())
}
