//! Normals from textures.

use glam::{Vec2, Vec3};

use super::Surface;
use super::placed::{place, unit};
use crate::view::SceneView;

/// Least cosine between a mapped normal and the direction to the viewer. Normals that would face away are turned
/// towards the viewer until they have it, so no part of a surface that is seen turns black. Smaller: reflections
/// there are all but grazing. Larger: steep bumps look flat from the side.
const SMALLEST_COSINE: f32 = 1.0 / 64.0;

impl Surface<'_> {
    /// The unit normal of the normal map in one of the material's places; its tangential part is multiplied by
    /// `scale`. Seen from behind, bumps are dents. Without a texture, or where its coordinates do not span the
    /// triangle's plane, the smooth normal.
    ///
    /// # Source
    /// glTF 2.0, 3.9.3: red points along u, green against v, blue along the normal.
    ///
    /// # Deviation
    /// Tangents are the triangle's own, not those of the vertices.
    pub(super) fn mapped_normal(&self, scene: &SceneView<'_>, map: usize, scale: f32) -> Vec3 {
        let Some(texture) = self.texture_at(scene, map) else { return self.smooth_normal };
        let corners = place(self.triangle(scene), self.instance(scene));
        let coordinates = scene.coordinates(texture, self.hit.triangle).map(|uv| texture.map(uv));
        // The side that the map describes is the front.
        let behind = self.smooth_normal.dot(self.face) < 0.0;
        let normal = if behind { -self.smooth_normal } else { self.smooth_normal };
        let Some(frame) = Frame::new(&corners, &coordinates, normal) else { return self.smooth_normal };
        let Some(color) = self.texture(scene, map) else { return self.smooth_normal };
        let local = color * 2.0 - 1.0;
        let mapped = frame.to_scene(local * Vec3::new(scale, scale, 1.0));
        let mapped = if behind { -mapped } else { mapped };
        let outgoing = -self.direction;
        let short = SMALLEST_COSINE - mapped.dot(outgoing);
        if short > 0.0 { unit(mapped + outgoing * short, self.smooth_normal) } else { mapped }
    }
}

/// The directions of a normal map's channels in the scene.
struct Frame {
    tangent: Vec3,
    bitangent: Vec3,
    normal: Vec3,
}

impl Frame {
    /// The frame about `normal` of a triangle with these texture coordinates; `None` when they lie on a line.
    fn new([a, b, c]: &[Vec3; 3], [s, t, r]: &[Vec2; 3], normal: Vec3) -> Option<Self> {
        let (edge1, edge2) = (*b - *a, *c - *a);
        let (along1, along2) = (*t - *s, *r - *s);
        let determinant = along1.perp_dot(along2);
        if !(determinant != 0.0 && determinant.is_finite()) {
            return None;
        }
        let sign = 1.0_f32.copysign(determinant);
        let u = unit((edge1 * along2.y - edge2 * along1.y) * sign, Vec3::ZERO);
        let v = (edge2 * along1.x - edge1 * along2.x) * sign;
        let tangent = unit(u - normal * normal.dot(u), Vec3::ZERO);
        let bitangent = normal.cross(tangent);
        // Against v: a map's second channel points up in the image, coordinates grow downwards.
        let bitangent = if bitangent.dot(v) > 0.0 { -bitangent } else { bitangent };
        (tangent != Vec3::ZERO).then_some(Self { tangent, bitangent, normal })
    }

    fn to_scene(&self, local: Vec3) -> Vec3 {
        unit(self.tangent * local.x + self.bitangent * local.y + self.normal * local.z, self.normal)
    }
}
