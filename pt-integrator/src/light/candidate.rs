//! Triangles that may become lights.

use alloc::vec::Vec;

use glam::{Vec2, Vec3};
use hashcache_core::float;

use super::footprint::LuminanceSums;
use super::{TriangleLight, luminance};
use crate::packed::{SceneInstance, SceneTriangle};
use crate::sampling::sample_triangle;
use crate::scene::{Material, NONE, SceneData, Texture};
use crate::surface::{place, triangle_offset};
use crate::texture::sample_texture;

/// A triangle as an emitter, and how much of the light it gives.
pub(super) struct Candidate {
    /// Without its density.
    pub light: TriangleLight,
    /// In square metres.
    pub area: f64,
    /// Its radiance, or a grey of its mean luminance under a texture.
    pub radiance: Vec3,
    /// 2 when both sides emit.
    pub sides: f64,
    /// Index in the scene.
    pub triangle: u32,
}

impl Candidate {
    /// Power over π, by luminance.
    pub(super) fn weight(&self) -> f64 {
        self.area * f64::from(luminance(self.radiance)) * self.sides
    }
}

/// A placed triangle that emits. `mean` is its mean emission in a scene with emission textures: then a triangle without
/// an area is a candidate too, of weight 0; else `None`.
pub(super) fn candidate(
    index: u32,
    triangle: &SceneTriangle,
    instance: &SceneInstance,
    material: &Material,
    mean: Option<f32>,
) -> Option<Candidate> {
    let corners = place(triangle, instance);
    let [a, b, c] = corners;
    let (edge1, edge2) = (b - a, c - a);
    // Scaled to about 1 first: the square of a small or large triangle's area leaves the range of f32.
    let scale = edge1.abs().max(edge2.abs()).max_element();
    let normal = (edge1 / scale).cross(edge2 / scale);
    let mut length = float::sqrt(normal.length_squared());
    let mut normal = normal * (if instance.is_mirrored() { -1.0 } else { 1.0 } / length);
    if !(length > 0.0 && length.is_finite()) {
        mean?;
        (length, normal) = (0.0, Vec3::Y);
    }
    let double_sided = material.flags & Material::DOUBLE_SIDED != 0;
    let [r, g, b, _] = material.emission;
    let radiance = match mean {
        Some(mean) if material.textures[Material::EMISSION] != NONE => Vec3::splat(mean),
        _ => Vec3::new(r, g, b),
    };
    let extend = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
    let area = if length > 0.0 { f64::from(length) * f64::from(scale) * f64::from(scale) / 2.0 } else { 0.0 };
    Some(Candidate {
        light: TriangleLight {
            vertex: extend(a, triangle_offset(&corners)),
            edge1: extend(edge1, 0.0),
            edge2: extend(edge2, 0.0),
            normal: extend(normal, if double_sided { 1.0 } else { 0.0 }),
            radiance: [r, g, b, 0.0],
        },
        area,
        radiance,
        sides: if double_sided { 2.0 } else { 1.0 },
        triangle: index,
    })
}

/// For each triangle of the scene the mean luminance of its emission, estimated, where its material has an emission
/// texture; 0 elsewhere, and exactly where the triangle's part of the texture is black.
pub(super) fn mean_emissions(scene: &SceneData, triangles: &[SceneTriangle], materials: &[Material]) -> Vec<f32> {
    let mut means = alloc::vec![0.0; triangles.len()];
    let mut of_material: Vec<Vec<u32>> = alloc::vec![Vec::new(); materials.len()];
    for (triangle, index) in triangles.iter().zip(0..) {
        let material = &materials[triangle.material as usize];
        if material.emits() && material.textures[Material::EMISSION] != NONE {
            of_material[triangle.material as usize].push(index);
        }
    }
    // Materials that share an image stand together, and one image's sums are kept at a time: they are twice as large as
    // its texels.
    let texture_of = |material: usize| &scene.textures[materials[material].textures[Material::EMISSION] as usize];
    let mut used: Vec<usize> = (0..materials.len()).filter(|&m| !of_material[m].is_empty()).collect();
    used.sort_by_key(|&m| image(texture_of(m)));
    let mut kept: Option<LuminanceSums> = None;
    let mut last = None;
    for material in used {
        let texture = texture_of(material);
        let sums = match kept.take() {
            Some(sums) if last == Some(image(texture)) => sums,
            _ => LuminanceSums::new(texture, &scene.texels),
        };
        last = Some(image(texture));
        let [r, g, b, _] = materials[material].emission;
        let emission = TextureEmission { texture, texels: &scene.texels, radiance: Vec3::new(r, g, b), sums: &sums };
        for &index in &of_material[material] {
            let index = index as usize;
            means[index] = emission.mean(texture.reads(&triangles[index].uv, scene.uv2.get(index)));
        }
        kept = Some(sums);
    }
    means
}

/// What a texture's sums depend on.
fn image(texture: &Texture) -> [u32; 4] {
    [texture.first_texel, texture.width, texture.height, texture.flags & Texture::LINEAR]
}

/// A material's emission.
struct TextureEmission<'a> {
    texture: &'a Texture,
    texels: &'a [u32],
    radiance: Vec3,
    sums: &'a LuminanceSums,
}

/// Share of the box about a triangle's texels in its mean. The taps alone would miss small bright spots, which only
/// scattering would then find.
const BOX_SHARE: f64 = 1.0 / 8.0;

/// Taps along each side of the unit square, for a triangle that shows few texels and one that shows many.
const TAPS: [u32; 2] = [4, 8];

/// Texels of a box that count as many: less than a tap for four of them.
const MANY: usize = 64;

impl TextureEmission<'_> {
    /// About the mean luminance on a triangle with these coordinates; 0 only when all of it is black.
    fn mean(&self, uv: [Vec2; 3]) -> f32 {
        let (around, texels) = self.sums.mean_about(self.texture, &uv);
        if around <= 0.0 {
            return 0.0;
        }
        let around = around * f64::from(luminance(self.radiance));
        let side = TAPS[usize::from(texels > MANY)];
        let [a, b, c] = uv;
        let mut taps = 0.0;
        for i in 0..side * side {
            let u = (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) / side as f32;
            let weights = sample_triangle(u);
            let at = a + (b - a) * weights.x + (c - a) * weights.y;
            taps += f64::from(luminance(self.radiance * sample_texture(self.texture, self.texels, at)));
        }
        let mean = taps / f64::from(side * side) * (1.0 - BOX_SHARE) + around * BOX_SHARE;
        // Not 0 by underflow: that would say black.
        (mean as f32).max(f32::MIN_POSITIVE)
    }
}
