//! Scenes and a model of overlap that shares no code with the crate.

use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::glam::Vec3;
use hashcache_core::octree::{BuildSettings, Grid, OwnedOctree, Serial, build};

/// A scene of triangles.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
}

impl Scene {
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let positions = triangles.iter().flatten().map(Vec3::to_array).collect();
        let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let meshes = vec![Mesh { first_triangle: 0, triangle_count: triangles.len() as u32 }];
        Self { positions, indices, meshes, instances: vec![Instance::identity(0)] }
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

    pub fn build(&self, resolution: u32) -> OwnedOctree {
        let settings = BuildSettings { resolution, ..BuildSettings::default() };
        build(&self.geometry(), &settings, &Serial).expect("a scene with triangles")
    }
}

/// Whether a triangle meets the box of a cell widened by `margin` (all in cells): clipped by the box's six sides, some
/// of it is left.
pub fn overlaps(grid: &Grid, triangle: &[Vec3; 3], cell: [u32; 3], margin: f64) -> bool {
    let place = |corner: &Vec3| -> [f64; 3] {
        let corner = corner.to_array();
        std::array::from_fn(|axis| {
            (f64::from(corner[axis]) - f64::from(grid.origin[axis])) * f64::from(grid.recip_cell)
        })
    };
    let mut polygon: Vec<[f64; 3]> = triangle.iter().map(place).collect();
    for axis in 0..3 {
        let (low, high) = (f64::from(cell[axis]) - margin, f64::from(cell[axis]) + 1.0 + margin);
        polygon = clip(&polygon, |p| p[axis] - low);
        polygon = clip(&polygon, |p| high - p[axis]);
    }
    !polygon.is_empty()
}

fn clip(polygon: &[[f64; 3]], distance: impl Fn(&[f64; 3]) -> f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::new();
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (a, b) = (distance(p), distance(q));
        if a >= 0.0 {
            kept.push(*p);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            kept.push(std::array::from_fn(|axis| p[axis] + t * (q[axis] - p[axis])));
        }
    }
    kept
}

/// A wavy sheet of `n`×`n` squares, two triangles each, with holes.
pub fn sheet(n: u16) -> Scene {
    let at = |i: u16, j: u16| {
        let (x, z) = (f32::from(i) / f32::from(n), f32::from(j) / f32::from(n));
        Vec3::new(x, (x * 7.0 + z * z * 5.0).fract() * 0.3, z)
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| (i * 7 + j * 3) % 5 != 0);
    let triangles: Vec<_> = squares
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)]])
        .collect();
    Scene::new(&triangles)
}
