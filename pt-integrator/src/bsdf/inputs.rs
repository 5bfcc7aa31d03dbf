//! What a material is at a point.

use glam::Vec3;

/// A material at a point, with its textures applied. Numbers outside of their range are taken as the nearest end of
/// it, NaN as its lower end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfInputs {
    /// Colour of the diffuse lobe, of metal at normal incidence, and of light that passes; `[0, 1]` by channel.
    pub base_color: Vec3,
    /// Share of metal, `[0, 1]`.
    pub metallic: f32,
    /// Perceptual roughness, `[0, 1]`; the microfacets' α is its square.
    pub roughness: f32,
    /// Refractive index over that of the outside, `[0.01, 100]`. 0 stands for infinity: all light is reflected, in the
    /// specular colour.
    pub ior: f32,
    /// Strength of the dielectric's reflection, `[0, 1]`.
    pub specular: f32,
    /// Colour of the dielectric's reflection at normal incidence, at least 0; the reflectance there ends at 1.
    pub specular_color: Vec3,
    /// Share of the dielectric's remaining light that passes rather than being scattered diffusely, `[0, 1]`.
    pub transmission: f32,
    /// Whether light passes a thin wall without being bent; otherwise it enters or leaves a solid.
    pub thin: bool,
    /// Strength of the clear coat, `[0, 1]`.
    pub clearcoat: f32,
    /// Perceptual roughness of the clear coat, `[0, 1]`.
    pub clearcoat_roughness: f32,
    /// Unit normal of the clear coat, on the side of the outgoing direction.
    pub coat_normal: Vec3,
}

impl BsdfInputs {
    /// Exactly Lambertian.
    pub const fn lambert(base_color: Vec3) -> Self {
        Self {
            base_color,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 0.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            thin: true,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            coat_normal: Vec3::ZERO,
        }
    }
}

/// `x` within `[0, 1]`; NaN becomes 0.
#[inline]
pub(super) fn unit_interval(x: f32) -> f32 {
    // `max` takes the number where the other is NaN.
    #[expect(clippy::manual_clamp, reason = "clamp keeps NaN")]
    x.max(0.0).min(1.0)
}

/// By channel.
#[inline]
pub(super) fn unit_color(color: Vec3) -> Vec3 {
    Vec3::from_array(color.to_array().map(unit_interval))
}
