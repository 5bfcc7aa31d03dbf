//! Materials.

use bytemuck::{Pod, Zeroable};

use super::NONE;

/// A Lambertian surface that may emit. 48 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Linear Rec. 709 albedo; it multiplies the texture. w is unused.
    pub base_color: [f32; 4],
    /// Emitted radiance, linear Rec. 709; w is unused.
    pub emission: [f32; 4],
    /// Index of the base colour texture, or [`NONE`].
    pub base_color_texture: u32,
    /// [`Material::DOUBLE_SIDED`].
    pub flags: u32,
    /// Zero.
    pub reserved: [u32; 2],
}

impl Material {
    /// Flag: emits from both sides. Without it a triangle emits from its front (counter-clockwise) side only.
    /// Reflection is two-sided in either case.
    pub const DOUBLE_SIDED: u32 = 1;

    /// A surface that reflects `albedo` and emits nothing.
    pub const fn lambert(albedo: [f32; 3]) -> Self {
        Self {
            base_color: [albedo[0], albedo[1], albedo[2], 1.0],
            emission: [0.0; 4],
            base_color_texture: NONE,
            flags: 0,
            reserved: [0; 2],
        }
    }

    /// A surface that reflects `albedo` and emits `radiance` from its front side.
    pub const fn emissive(albedo: [f32; 3], radiance: [f32; 3]) -> Self {
        let mut material = Self::lambert(albedo);
        material.emission = [radiance[0], radiance[1], radiance[2], 0.0];
        material
    }

    /// Whether the material emits: a component of its emission is above 0 and all are finite.
    pub fn emits(&self) -> bool {
        let [r, g, b, _] = self.emission;
        (r > 0.0 || g > 0.0 || b > 0.0) && r.is_finite() && g.is_finite() && b.is_finite()
    }
}
