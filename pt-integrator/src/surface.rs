//! The surface at a hit.

use glam::{Vec2, Vec3};
use hashcache_core::float;
use hashcache_core::geometry::Hit;
use hashcache_core::pack::octahedral_decode;

use crate::packed::{SceneInstance, SceneTriangle};
use crate::ray::RELATIVE_OFFSET;
use crate::scene::{Material, NONE, Needs};
use crate::texture::sample_texture;
use crate::view::SceneView;

/// A point on a triangle with everything that light transport asks of it.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Position in the scene.
    pub position: Vec3,
    /// Unit normal of the triangle's front.
    pub face: Vec3,
    /// Unit shading normal, on the side from which the ray came.
    pub normal: Vec3,
    /// By how much rays start off the face.
    pub offset: f32,
    /// Texture coordinate.
    pub uv: Vec2,
    /// The triangle's material.
    pub material: &'a Material,
    /// Whether the ray came from the triangle's front.
    pub from_front: bool,
}

impl<'a> Surface<'a> {
    /// The surface that a ray with this unit direction hit.
    ///
    /// # Panics
    /// When the hit names a triangle or instance that the scene does not have.
    // Two call sites in the hottest loop; passing the result through memory costs more than the copy of the code.
    #[inline(always)]
    pub fn at(scene: &SceneView<'a>, hit: &Hit, direction: Vec3) -> Self {
        let triangle = &scene.triangles[hit.triangle as usize];
        let instance = &scene.instances[hit.instance as usize];
        let corners = place(triangle, instance);
        let [a, b, c] = corners;
        let (u, v) = (hit.u, hit.v);
        let w = 1.0 - u - v;
        let mut face = unit((b - a).cross(c - a), -direction);
        if instance.is_mirrored() {
            face = -face;
        }
        let [ta, tb, tc] = triangle.uv.map(Vec2::from_array);
        let normal = shading_normal(triangle, instance, [w, u, v], face);
        Self {
            position: a * w + b * u + c * v,
            face,
            normal: if normal.dot(direction) > 0.0 { -normal } else { normal },
            offset: triangle_offset(&corners),
            uv: ta * w + tb * u + tc * v,
            material: &scene.materials[triangle.material as usize],
            from_front: face.dot(direction) < 0.0,
        }
    }

    /// Radiance towards where the ray came from.
    #[inline]
    pub fn emission(&self) -> Vec3 {
        let [r, g, b, _] = self.material.emission;
        if self.from_front || self.is_double_sided() { Vec3::new(r, g, b) } else { Vec3::ZERO }
    }

    /// Whether both sides emit.
    #[inline]
    pub fn is_double_sided(&self) -> bool {
        self.material.flags & Material::DOUBLE_SIDED != 0
    }

    /// Share of light that is reflected, by channel. `NEEDS` as in [`crate::light::sample_light`].
    #[inline]
    pub fn albedo<const NEEDS: u32>(&self, scene: &SceneView<'_>) -> Vec3 {
        let [r, g, b, _] = self.material.base_color;
        let color = Vec3::new(r, g, b);
        if NEEDS & Needs::TEXTURES == 0 || self.material.textures[Material::BASE_COLOR] == NONE {
            return color;
        }
        let texture = &scene.textures[self.material.textures[Material::BASE_COLOR] as usize];
        color * sample_texture(texture, scene.texels, self.uv)
    }
}

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
fn shading_normal(triangle: &SceneTriangle, instance: &SceneInstance, weights: [f32; 3], face: Vec3) -> Vec3 {
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
fn unit(v: Vec3, otherwise: Vec3) -> Vec3 {
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
