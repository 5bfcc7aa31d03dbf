//! Triangles where they stand in the scene.

use glam::Vec3;
use hashcache_core::float;
use hashcache_core::pack::octahedral_decode;

use crate::packed::{SceneInstance, SceneTriangle};
use crate::ray::RELATIVE_OFFSET;
use crate::scene::NONE;

/// Corners of a triangle in the scene.
#[inline]
pub(crate) fn place(triangle: &SceneTriangle, instance: &SceneInstance) -> [Vec3; 3] {
    let corners = triangle.vertices.map(|v| Vec3::from_array(v.position));
    if instance.flags & SceneInstance::IDENTITY != 0 {
        return corners;
    }
    let [x, y, z] = &instance.to_scene;
    let row = |r: &[f32; 4], p: Vec3| r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
    corners.map(|p| Vec3::new(row(x, p), row(y, p), row(z, p)))
}

/// By how much rays start off a triangle with these corners.
#[inline]
pub(crate) fn triangle_offset(corners: &[Vec3; 3]) -> f32 {
    let [a, b, c] = corners;
    a.abs().max(b.abs()).max(c.abs()).max_element() * RELATIVE_OFFSET
}

/// The interpolated normal in the scene, of unit length; the face's where there is none.
#[inline]
pub(super) fn shading_normal(
    triangle: &SceneTriangle,
    instance: &SceneInstance,
    weights: [f32; 3],
    face: Vec3,
) -> Vec3 {
    let codes = triangle.vertices.map(|v| v.normal);
    if codes == [NONE; 3] {
        return face;
    }
    // Normals are interpolated in the scene at unit length, since a map that stretches changes their lengths.
    let normal = |k: usize| {
        let n = octahedral_decode(codes[k]);
        if instance.flags & SceneInstance::IDENTITY != 0 {
            return n;
        }
        let [x, y, z] = &instance.normal_to_scene;
        let row = |r: &[f32; 4]| r[0] * n.x + r[1] * n.y + r[2] * n.z;
        unit(Vec3::new(row(x), row(y), row(z)), face)
    };
    unit(normal(0) * weights[0] + normal(1) * weights[1] + normal(2) * weights[2], face)
}

/// The direction of `v`, or `otherwise` for a vector without one.
#[inline]
pub(super) fn unit(v: Vec3, otherwise: Vec3) -> Vec3 {
    let squared = v.length_squared();
    // Outside of this range squares have lost bits or overflowed.
    if squared > 1e-30 && squared < 1e30 {
        return v / float::sqrt(squared);
    }
    scaled_unit(v, otherwise)
}

#[cold]
fn scaled_unit(v: Vec3, otherwise: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return otherwise;
    }
    let v = v / largest;
    v / float::sqrt(v.length_squared())
}
