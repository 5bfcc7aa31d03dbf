//! Materials that are more than Lambertian.

use pt_integrator::scene::Material;

/// Roughness is the perceptual one. A dielectric of index 1.5 above a Lambertian base.
pub(super) fn polished(base: Material, roughness: f32) -> Material {
    Material { specular: [1.0; 4], surface: [0.0, roughness, 0.0, 1.0], ..base }
}

/// A perfect mirror that reflects this much.
pub(super) fn mirror(color: [f32; 3]) -> Material {
    Material { surface: [1.0, 0.0, 0.0, 1.0], ..Material::lambert(color) }
}

/// Smooth clear glass of index 1.5: a sheet without thickness.
pub(super) fn pane() -> Material {
    Material { specular: [1.0; 4], surface: [0.0, 0.0, 1.0, 1.0], ..Material::lambert([1.0; 3]) }
}

/// The same as a solid that absorbs this much, by channel, 1/m.
pub(super) fn glass([r, g, b]: [f32; 3]) -> Material {
    Material { interior: [r, g, b, 1.5], flags: Material::VOLUME, ..pane() }
}
