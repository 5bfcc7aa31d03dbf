//! A room with furniture as large as an octree of a real one, and the vertices of paths through it.

use std::f32::consts::TAU;

use hashcache_core::float;
use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::glam::{EulerRot, Quat, Vec3};
use hashcache_core::hash::{pcg, to_unit_f32};
use hashcache_core::octree::{BuildSettings, OwnedOctree, Serial, build};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;

/// Numbers that look random, the same in every run.
pub struct Noise(pub u32);

impl Noise {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        to_unit_f32(pcg(self.0))
    }
}

/// A parallelogram: corner and edges.
type Quad = [Vec3; 3];

/// The six sides of a box, turned.
fn sides(centre: Vec3, half: Vec3, turn: Quat) -> impl Iterator<Item = Quad> {
    let [x, y, z] = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z].map(|v| turn * v);
    [[x, y, z], [y, z, x], [z, x, y]]
        .into_iter()
        .flat_map(move |[n, u, v]| [n, -n].map(|n| [centre + n - u - v, u * 2.0, v * 2.0]))
}

/// A room of 1 × 0.35 × 0.5 with thirty boxes, standing at all angles.
pub fn room() -> Vec<Quad> {
    let mut quads: Vec<_> = sides(Vec3::new(0.5, 0.175, 0.25), Vec3::new(0.5, 0.175, 0.25), Quat::IDENTITY).collect();
    let mut noise = Noise(1);
    for _ in 0..30 {
        let centre = Vec3::new(0.05 + 0.9 * noise.unit(), 0.15 * noise.unit(), 0.1 + 0.35 * noise.unit());
        let half = Vec3::new(noise.unit(), noise.unit(), noise.unit()) * 0.025 + 0.005;
        let turn = Quat::from_euler(EulerRot::XYZ, noise.unit(), TAU * noise.unit(), noise.unit());
        quads.extend(sides(centre, half, turn));
    }
    quads
}

pub fn octree(quads: &[Quad], resolution: u32) -> OwnedOctree {
    let corners = |[p, u, v]: &Quad| [*p, p + u, p + u + v, *p, p + u + v, p + v].map(|p| p.to_array());
    let positions: Vec<_> = quads.iter().flat_map(corners).collect();
    let count = positions.len() as u32 / 3;
    let indices: Vec<_> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let geometry = Geometry {
        positions: &positions,
        indices: &indices,
        meshes: &[Mesh { first_triangle: 0, triangle_count: count }],
        instances: &[Instance::identity(0)],
        ..Geometry::default()
    };
    build(&geometry, &BuildSettings { resolution, ..BuildSettings::default() }, &Serial).expect("the room of a bench")
}

/// The nearest parallelogram on a ray: point and normal towards the ray's origin.
fn hit(quads: &[Quad], origin: Vec3, direction: Vec3) -> Option<(Vec3, Vec3)> {
    let mut nearest = (f32::INFINITY, Vec3::ZERO);
    for [corner, u, v] in quads {
        let n = u.cross(*v);
        let t = (corner - origin).dot(n) / direction.dot(n);
        if !(t > 1e-4 && t < nearest.0) {
            continue;
        }
        let p = origin + direction * t - corner;
        // The edges are at right angles.
        let (a, b) = (p.dot(*u) / u.length_squared(), p.dot(*v) / v.length_squared());
        if (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b) {
            nearest = (t, n);
        }
    }
    let (t, n) = nearest;
    t.is_finite().then(|| (origin + direction * t, n.normalize() * -n.dot(direction).signum()))
}

/// The first `stored` vertices of paths through a picture of `width` × `height` pixels, path after path.
pub fn vertices(quads: &[Quad], width: u32, height: u32, stored: usize, seed: u32) -> Vec<VertexRecord> {
    let mut noise = Noise(seed);
    let mut records = Vec::new();
    let angle = 1.4 / height as f32;
    for pixel in 0..width * height {
        let (x, y) = ((pixel % width) as f32 + noise.unit(), (pixel / width) as f32 + noise.unit());
        let (x, y) = ((x - width as f32 / 2.0) * angle, (height as f32 / 2.0 - y) * angle);
        let (mut origin, mut direction) = (Vec3::new(0.5, 0.25, 0.01), Vec3::new(x, y, 1.0).normalize());
        let mut length = 0.0;
        for k in 0..stored {
            let Some((p, n)) = hit(quads, origin, direction) else {
                records.extend(std::iter::repeat_n::<VertexRecord>(bytemuck::Zeroable::zeroed(), stored - k));
                break;
            };
            length += p.distance(origin);
            let light = [noise.unit(), noise.unit(), noise.unit(), 0.0];
            records.push(VertexRecord {
                position_footprint: p.extend(length * angle).to_array(),
                direct: light,
                further: light.map(|v| 0.3 * v),
                throughput: [0.5, 0.5, 0.5, 0.0],
                emitted: [0.0; 4],
                normal: octahedral_encode(n),
                direction: octahedral_encode(direction),
                seed: pcg(pixel * 16 + k as u32),
                flags: VertexRecord::VALID | if k > 0 { VertexRecord::SECONDARY } else { 0 },
            });
            let (z, phi) = (2.0 * noise.unit() - 1.0, TAU * noise.unit());
            let r = (1.0 - z * z).max(0.0).sqrt();
            direction = (n + Vec3::new(r * float::cos(phi), r * float::sin(phi), z)).normalize_or(n);
            origin = p;
        }
    }
    records
}
