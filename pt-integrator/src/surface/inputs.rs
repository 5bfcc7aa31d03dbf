//! A material with its textures applied.

use glam::Vec3;

use super::Surface;
use crate::bsdf::BsdfInputs;
use crate::scene::{Material, NONE, Needs};
use crate::texture::sample_alpha;
use crate::view::SceneView;

impl Surface<'_> {
    /// What the material is here, with all its textures.
    #[inline]
    pub fn bsdf_inputs(&self, scene: &SceneView<'_>) -> BsdfInputs {
        let material = self.material;
        let base_color = self.albedo::<{ Needs::ALL }>(scene);
        let [mut metallic, mut roughness, mut transmission, _] = material.surface;
        let [r, g, b, mut specular] = material.specular;
        let mut specular_color = Vec3::new(r, g, b);
        let [mut clearcoat, mut clearcoat_roughness, coat_scale, _] = material.coat;
        if let Some(texture) = self.texture(scene, Material::METALLIC_ROUGHNESS) {
            (roughness, metallic) = (roughness * texture.y, metallic * texture.z);
        }
        if let Some(texture) = self.texture_at(scene, Material::SPECULAR) {
            specular *= sample_alpha(texture, scene.texels, self.coordinates(scene, texture));
        }
        if let Some(texture) = self.texture(scene, Material::SPECULAR_COLOR) {
            specular_color *= texture;
        }
        if let Some(texture) = self.texture(scene, Material::TRANSMISSION) {
            transmission *= texture.x;
        }
        if let Some(texture) = self.texture(scene, Material::CLEARCOAT) {
            clearcoat *= texture.x;
        }
        if let Some(texture) = self.texture(scene, Material::CLEARCOAT_ROUGHNESS) {
            clearcoat_roughness *= texture.y;
        }
        let mut coat_normal = self.smooth_normal;
        if material.textures[Material::CLEARCOAT_NORMAL] != NONE {
            coat_normal = self.mapped_normal(scene, Material::CLEARCOAT_NORMAL, coat_scale);
        }
        BsdfInputs {
            base_color,
            metallic,
            roughness,
            ior: material.interior[3],
            specular,
            specular_color,
            transmission,
            thin: material.flags & Material::VOLUME == 0,
            clearcoat,
            clearcoat_roughness,
            coat_normal,
        }
    }
}
