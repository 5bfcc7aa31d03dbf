//! Path vertices as a renderer would record them, and as none should.

use hashcache_core::float::exp2;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;

/// Words that look random, the same in every run.
pub struct Noise(
    /// The state.
    pub u32,
);

impl Noise {
    /// The next word.
    pub fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        pcg(self.0)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        to_unit_f32(self.word())
    }

    /// A number in [-1, 1).
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// A direction.
    pub fn direction(&mut self) -> Vec3 {
        let v = Vec3::new(self.signed(), self.signed(), self.signed());
        v.try_normalize().unwrap_or(Vec3::Z)
    }

    /// 2^x for x uniform in `from..to`.
    pub fn power(&mut self, from: f32, to: f32) -> f32 {
        exp2(from + (to - from) * self.unit())
    }
}

/// What every vertex of a test has in common.
pub struct Scene {
    /// Half the edge of the room in metres: more room, more cells.
    pub extent: f32,
    /// Footprints are around 2 to the power of these.
    pub footprints: &'static [f32],
}

/// `count` vertices on the walls of a room and on spheres in it, every 64th hostile: NaN, infinite, huge, tiny,
/// negative or marked as not valid.
pub fn vertices(seed: u32, count: usize, scene: &Scene) -> Vec<VertexRecord> {
    let mut noise = Noise(seed);
    (0..count)
        .map(|i| {
            let mut vertex = surface_vertex(&mut noise, scene);
            if i % 64 == 63 {
                spoil(&mut vertex, i / 64, &mut noise);
            }
            vertex
        })
        .collect()
}

fn surface_vertex(noise: &mut Noise, scene: &Scene) -> VertexRecord {
    let (position, normal) = if noise.word().is_multiple_of(3) {
        let centre = Vec3::new(noise.signed().round(), noise.signed().round(), noise.signed().round());
        let normal = noise.direction();
        (scene.extent * (0.5 * centre + 0.25 * normal), normal)
    } else {
        let axis = noise.word() as usize % 3;
        let side = if noise.word().is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut position = Vec3::new(noise.signed(), noise.signed(), noise.signed());
        position[axis] = side;
        let mut normal = Vec3::ZERO;
        normal[axis] = -side;
        (scene.extent * position, normal)
    };
    let cluster = scene.footprints[noise.word() as usize % scene.footprints.len()];
    let footprint = noise.power(cluster - 0.6, cluster + 0.6);
    let light = |noise: &mut Noise| {
        let level = noise.power(-10.0, 4.0);
        [level * noise.unit(), level * noise.unit(), level * noise.unit(), 0.0]
    };
    VertexRecord {
        position_footprint: position.extend(footprint).to_array(),
        direct: light(noise),
        further: light(noise),
        throughput: [0.5, 0.6, 0.7, 0.0],
        emitted: [0.0; 4],
        normal: octahedral_encode(normal),
        direction: octahedral_encode(noise.direction()),
        seed: noise.word(),
        flags: VertexRecord::VALID,
    }
}

/// Values at which formulas break.
pub const HOSTILE: [f32; 16] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.0,
    -0.0,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-40,
    -1e-40,
    1e-12,
    1e12,
    1e7,
    -1e7,
    1e-4,
    -1.0,
];

fn spoil(vertex: &mut VertexRecord, which: usize, noise: &mut Noise) {
    let value = HOSTILE[which / 5 % HOSTILE.len()];
    let component = noise.word() as usize % 3;
    match which % 5 {
        0 => vertex.position_footprint[component] = value,
        1 => vertex.position_footprint[3] = value,
        2 => vertex.direct[component] = value,
        3 => vertex.further[component] = value,
        _ => {
            vertex.normal = noise.word();
            vertex.direction = noise.word();
            vertex.flags = noise.word() & VertexRecord::VALID;
        }
    }
}
