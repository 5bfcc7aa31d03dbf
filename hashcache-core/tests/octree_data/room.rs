//! A room to keep light in, and vertices on its surfaces.

use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg, to_unit_f32};
use hashcache_core::octree::{BuildSettings, OctreeParams, OctreeSettings, OwnedOctree, Serial, build};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::RadianceCache;

/// Numbers that look random, the same in every run.
pub struct Noise(pub u32);

impl Noise {
    pub fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        pcg(self.0)
    }

    pub fn unit(&mut self) -> f32 {
        to_unit_f32(self.word())
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.word() as usize % end
    }

    pub fn direction(&mut self) -> Vec3 {
        let v = Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0;
        v.try_normalize().unwrap_or(Vec3::Z)
    }
}

/// Three walls of a unit cube and a slanted quadrangle in it, as parallelograms: corner and two edges.
pub const QUADS: [[Vec3; 3]; 4] = [
    [Vec3::ZERO, Vec3::X, Vec3::Y],
    [Vec3::ZERO, Vec3::Y, Vec3::Z],
    [Vec3::ZERO, Vec3::Z, Vec3::X],
    [Vec3::new(0.3, 0.2, 0.3), Vec3::new(0.5, 0.1, 0.2), Vec3::new(-0.1, 0.5, 0.3)],
];

/// The octree of some parallelograms.
pub fn octree(quads: &[[Vec3; 3]], resolution: u32) -> OwnedOctree {
    let mut positions = Vec::new();
    for [corner, u, v] in quads {
        let corners = [*corner, corner + u, corner + u + v, *corner, corner + u + v, corner + v];
        positions.extend(corners.map(|p| p.to_array()));
    }
    let count = positions.len() as u32 / 3;
    let indices: Vec<_> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let geometry = Geometry {
        positions: &positions,
        indices: &indices,
        meshes: &[Mesh { first_triangle: 0, triangle_count: count }],
        instances: &[Instance::identity(0)],
        ..Geometry::default()
    };
    build(&geometry, &BuildSettings { resolution, ..BuildSettings::default() }, &Serial).expect("a scene")
}

/// A vertex on one of the parallelograms, seen from a random side, with random light.
pub fn vertex(noise: &mut Noise, quads: &[[Vec3; 3]]) -> VertexRecord {
    let [corner, u, v] = quads[noise.below(quads.len())];
    let position = corner + u * noise.unit() + v * noise.unit();
    let side = if noise.word() & 1 == 0 { 1.0 } else { -1.0 };
    let normal = u.cross(v).normalize() * side + noise.direction() * 0.5;
    let light = |noise: &mut Noise| [noise.unit(), 4.0 * noise.unit(), 0.01 * noise.unit(), 0.0];
    VertexRecord {
        position_footprint: position.extend(0.001 + 0.2 * noise.unit() * noise.unit()).to_array(),
        direct: light(noise),
        further: light(noise),
        throughput: [0.5; 4],
        emitted: [0.0; 4],
        normal: octahedral_encode(normal),
        direction: octahedral_encode(-normal),
        seed: noise.word(),
        flags: VertexRecord::VALID | (noise.word() & VertexRecord::SECONDARY),
    }
}

/// A vertex in the middle of the floor with this light.
pub fn lit(further: f32) -> VertexRecord {
    VertexRecord {
        position_footprint: [0.4, 0.4, 0.0, 0.001],
        further: [further, 0.5 * further, 0.25 * further, 0.0],
        normal: octahedral_encode(Vec3::Z),
        direction: octahedral_encode(Vec3::NEG_Z),
        flags: VertexRecord::VALID,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Settings under which a lookup reads the vertex's own cell of the level nearest its footprint.
pub fn plain() -> OctreeSettings {
    OctreeSettings { cell: 1.0, jitter: 0.0, min_samples: 1, max_climb: 0, ..OctreeSettings::default() }
}

pub fn params(settings: &OctreeSettings) -> OctreeParams {
    OctreeParams::new(settings).expect("valid settings")
}

/// Records vertices, in order.
pub fn record_all<'a>(cache: &mut impl RadianceCache, vertices: impl IntoIterator<Item = &'a VertexRecord>) {
    for vertex in vertices {
        cache.record(vertex);
    }
}
