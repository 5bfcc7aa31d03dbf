//! Small scenes in code.

use hashcache_core::geometry::{Instance, Mesh};
use pt_integrator::glam::Vec3;
use pt_integrator::scene::{Material, SceneData, TriangleShading};

/// Adds a mesh of triangles with flat shading, placed once.
pub fn add_triangles(scene: &mut SceneData, triangles: &[[Vec3; 3]], material: Material) {
    let material_index = scene.materials.len() as u32;
    scene.materials.push(material);
    let first_triangle = scene.indices.len() as u32;
    for triangle in triangles {
        let first = scene.positions.len() as u32;
        scene.positions.extend(triangle.map(|p| p.to_array()));
        scene.indices.push([first, first + 1, first + 2]);
        scene.triangle_shading.push(TriangleShading::flat(material_index));
    }
    scene.instances.push(Instance::identity(scene.meshes.len() as u32));
    scene.meshes.push(Mesh { first_triangle, triangle_count: triangles.len() as u32 });
}

/// The two triangles of a parallelogram; its front is where `edge1 × edge2` points.
pub fn quad(corner: Vec3, edge1: Vec3, edge2: Vec3) -> [[Vec3; 3]; 2] {
    let (a, b, c, d) = (corner, corner + edge1, corner + edge1 + edge2, corner + edge2);
    [[a, b, c], [a, c, d]]
}

/// The twelve triangles of a box that looks inwards.
pub fn inward_box(low: Vec3, high: Vec3) -> Vec<[Vec3; 3]> {
    let size = high - low;
    let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    [quad(low, y, z), quad(low, z, x), quad(low, x, y), quad(high, -z, -y), quad(high, -x, -z), quad(high, -y, -x)]
        .concat()
}

/// A tessellated sphere that looks outwards, with smooth normals when asked.
pub fn add_sphere(scene: &mut SceneData, centre: Vec3, radius: f32, rings: u32, smooth: bool, material: Material) {
    let direction = |i: u32, j: u32| {
        let (theta, phi) =
            (std::f32::consts::PI * i as f32 / rings as f32, std::f32::consts::PI * j as f32 / rings as f32);
        Vec3::new(theta.sin() * phi.sin(), theta.cos(), theta.sin() * phi.cos())
    };
    let mut triangles = Vec::new();
    let mut normals = Vec::new();
    for i in 0..rings {
        for j in 0..2 * rings {
            let [a, b, c, d] = [direction(i, j), direction(i + 1, j), direction(i + 1, j + 1), direction(i, j + 1)];
            for corners in [[a, b, c], [a, c, d]] {
                normals.push(corners.map(hashcache_core::pack::octahedral_encode));
                triangles.push(corners.map(|n| centre + n * radius));
            }
        }
    }
    let first = scene.triangle_shading.len();
    add_triangles(scene, &triangles, material);
    if smooth {
        for (shading, normals) in scene.triangle_shading[first..].iter_mut().zip(normals) {
            shading.normals = normals;
        }
    }
}
