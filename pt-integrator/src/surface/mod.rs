//! The surface at a hit.

mod inputs;
mod normal_map;
mod placed;

pub(crate) use placed::{place, triangle_offset};

use glam::{Vec2, Vec3};
use hashcache_core::geometry::Hit;

use crate::light::triangle_density;
use crate::packed::{SceneInstance, SceneTriangle};
use crate::scene::{Material, NONE, Needs, Texture};
use crate::texture::sample_texture;
use crate::view::SceneView;
use placed::{shading_normal, unit};

/// A point on a triangle with everything that light transport asks of it.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Position in the scene.
    pub position: Vec3,
    /// Unit normal of the triangle's front.
    pub face: Vec3,
    /// Unit shading normal, on the side from which the ray came; under a normal map, the map's.
    pub normal: Vec3,
    /// Unit shading normal without a normal map, on the side from which the ray came: what a clear coat has. Where a
    /// solid's interpolated normal points away from the viewer, as on rims, it is the face's.
    pub smooth_normal: Vec3,
    /// By how much rays start off the face.
    pub offset: f32,
    /// Texture coordinate.
    pub uv: Vec2,
    /// The triangle's material.
    pub material: &'a Material,
    /// Whether the ray came from the triangle's front.
    pub from_front: bool,
    /// The hit that this is.
    pub hit: Hit,
    /// Unit direction of the ray that hit.
    pub direction: Vec3,
}

impl<'a> Surface<'a> {
    /// The surface that a ray with this unit direction hit. `NEEDS` as in [`crate::light::sample_light`].
    ///
    /// # Panics
    /// When the hit names a triangle or instance that the scene does not have.
    // Two call sites in the hottest loop; passing the result through memory costs more than the copy of the code.
    #[inline(always)]
    pub fn at<const NEEDS: u32>(scene: &SceneView<'a>, hit: &Hit, direction: Vec3) -> Self {
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
        let mut smooth_normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let material = &scene.materials[triangle.material as usize];
        let from_front = face.dot(direction) < 0.0;
        if NEEDS & Needs::TRANSMISSION != 0 && material.is_solid() && (smooth_normal.dot(face) > 0.0) != from_front {
            smooth_normal = if from_front { face } else { -face };
        }
        let mut surface = Self {
            position: a * w + b * u + c * v,
            face,
            normal: smooth_normal,
            smooth_normal,
            offset: triangle_offset(&corners),
            uv: ta * w + tb * u + tc * v,
            material,
            from_front,
            hit: *hit,
            direction,
        };
        if NEEDS & Needs::NORMAL_MAPS != 0 && surface.material.textures[Material::NORMAL] != NONE {
            let [_, _, _, scale] = surface.material.surface;
            surface.normal = surface.mapped_normal(scene, Material::NORMAL, scale);
        }
        surface
    }

    /// Whether light from a direction comes to the viewer, from the other side if `transmitted`. Under a normal map it
    /// has to be on the same side of the smooth normal, or bumps would show what is behind a sheet. `NEEDS` as in
    /// [`crate::light::sample_light`].
    #[inline]
    pub fn shows<const NEEDS: u32>(&self, incoming: Vec3, transmitted: bool) -> bool {
        NEEDS & Needs::NORMAL_MAPS == 0
            || !self.material.has_normal_map()
            || (self.smooth_normal.dot(incoming) > 0.0) != transmitted
    }

    /// Whether light from a direction comes through the triangle, whatever the shading normal says.
    #[inline]
    pub fn is_crossed_from(&self, incoming: Vec3) -> bool {
        (self.face.dot(incoming) < 0.0) == self.from_front
    }

    /// Radiance towards where the ray came from. `NEEDS` as in [`crate::light::sample_light`].
    #[inline]
    pub fn emission<const NEEDS: u32>(&self, scene: &SceneView<'_>) -> Vec3 {
        let [r, g, b, _] = self.material.emission;
        let radiance = Vec3::new(r, g, b);
        if !(self.from_front || self.is_double_sided()) {
            return Vec3::ZERO;
        }
        if NEEDS & Needs::EMISSIVE_TEXTURES == 0 || self.material.textures[Material::EMISSION] == NONE {
            return radiance;
        }
        if self.triangle(scene).emitter == NONE {
            // Its part of the texture is black.
            return Vec3::ZERO;
        }
        radiance * self.texture(scene, Material::EMISSION).unwrap_or(Vec3::ONE)
    }

    /// Density by area with which next-event estimation would choose this point, the choice of the triangle included.
    /// `emitted` is the [`Surface::emission`]. `NEEDS` as in [`crate::light::sample_light`].
    #[inline]
    pub fn light_density<const NEEDS: u32>(&self, scene: &SceneView<'_>, emitted: Vec3) -> f32 {
        if NEEDS & Needs::EMISSIVE_TEXTURES == 0 || self.material.textures[Material::EMISSION] == NONE {
            return triangle_density(emitted, self.is_double_sided(), scene.header.density_per_luminance);
        }
        let emitter = self.triangle(scene).emitter;
        let first = scene.instances[self.hit.instance as usize].first_light;
        // Beyond the list: an emitter that next event never chooses.
        scene.lights.get(first.saturating_add(emitter) as usize).map_or(0.0, |light| light.edge1[3])
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
        if NEEDS & Needs::TEXTURES == 0 {
            return color;
        }
        match self.texture(scene, Material::BASE_COLOR) {
            Some(texture) => color * texture,
            None => color,
        }
    }

    /// What the texture in one of the material's places shows here, if there is one.
    #[inline]
    fn texture(&self, scene: &SceneView<'_>, place: usize) -> Option<Vec3> {
        let texture = self.texture_at(scene, place)?;
        Some(sample_texture(texture, scene.texels, self.coordinates(scene, texture)))
    }

    #[inline]
    fn texture_at<'b>(&self, scene: &SceneView<'b>, place: usize) -> Option<&'b Texture> {
        match self.material.textures[place] {
            NONE => None,
            index => Some(&scene.textures[index as usize]),
        }
    }

    /// The coordinates that this texture reads.
    #[inline]
    fn coordinates(&self, scene: &SceneView<'_>, texture: &Texture) -> Vec2 {
        if texture.flags & Texture::SECOND_UV == 0 {
            return self.uv;
        }
        let [a, b, c] = scene.coordinates(texture, self.hit.triangle);
        a * (1.0 - self.hit.u - self.hit.v) + b * self.hit.u + c * self.hit.v
    }

    #[inline]
    fn triangle<'b>(&self, scene: &SceneView<'b>) -> &'b SceneTriangle {
        &scene.triangles[self.hit.triangle as usize]
    }

    #[inline]
    fn instance<'b>(&self, scene: &SceneView<'b>) -> &'b SceneInstance {
        &scene.instances[self.hit.instance as usize]
    }
}
