//! One material: glTF's fields as the integrator's.

use gltf::json;
use hashcache_core::float;
use json::material::AlphaMode;
use json::validation::Checked;
use pt_integrator::scene::{Material, NONE, Texture};

use super::clearcoat::Clearcoat;
use super::document::Document;
use super::opacity::Cutout;
use super::reference::Reference;
use super::textures::Textures;
use crate::error::SceneError;
use crate::warning::Warnings;

/// How a texture's colours are stored.
#[derive(Clone, Copy)]
enum Encoding {
    Srgb,
    Linear,
}

/// The material, what it reads, and its holes.
pub(super) struct Converted {
    pub material: Material,
    /// Sets of texture coordinates: first and second.
    pub sets: [Option<u32>; 2],
    /// Its material index is the caller's to fill in.
    pub cutout: Option<Cutout>,
}

/// Opacity at which a blended surface is taken to end.
const BLEND_CUTOFF: f32 = 0.5;

/// What is said of blended surfaces that [`sheet`] replaces.
const SHEETS: &str = "blended surfaces of one opacity are shown as thin sheets that let the rest of the light through; \
                      their highlights are sharp";

/// Smallest attenuation colour: black would absorb infinitely. One part in a million is left after the distance.
const DARKEST: f32 = 1e-6;

/// The index of refraction that stands for an infinite one, which reflects everything. 0.04 % pass.
const INFINITE_IOR: f32 = 1e4;

/// Converts one material. What has no effect is left out, so that no scene asks for more than it shows: a surface that
/// only scatters diffusely becomes [`Material::lambert`], whatever its roughness says.
pub(super) struct Converter<'c> {
    document: &'c Document,
    textures: &'c mut Textures,
    place: &'c str,
    warnings: &'c mut Warnings,
    sets: [Option<u32>; 2],
}

impl<'c> Converter<'c> {
    pub fn new(document: &'c Document, textures: &'c mut Textures, place: &'c str, warnings: &'c mut Warnings) -> Self {
        Self { document, textures, place, warnings, sets: [None; 2] }
    }

    pub fn convert(mut self, source: &json::Material) -> Result<Converted, SceneError> {
        let pbr = &source.pbr_metallic_roughness;
        let factor = pbr.base_color_factor.0;
        let mut albedo = [0.0; 3];
        for (to, from) in albedo.iter_mut().zip(factor) {
            *to = self.unit(from, "/pbrMetallicRoughness/baseColorFactor")?;
        }
        let mut material = Material::lambert(albedo);
        material.flags = if source.double_sided { Material::DOUBLE_SIDED } else { 0 };
        let info = pbr.base_color_texture.as_ref();
        let base = self.texture(info, Encoding::Srgb, "/pbrMetallicRoughness/baseColorTexture")?;
        material.textures[Material::BASE_COLOR] = base;
        let cutout = self.cutout(source, base)?;
        if source.extensions.as_ref().is_some_and(|e| e.unlit.is_some()) {
            material.flags |= Material::UNLIT;
        } else {
            self.scattering(source, &mut material)?;
            self.emission(source, &mut material)?;
        }
        let blended = cutout.as_ref().filter(|cutout| cutout.blended.is_some());
        if let Some(sheet) = blended.and_then(|cutout| sheet(&material, cutout.factor)) {
            self.warnings.add(SHEETS, || format!("{}/alphaMode", self.place));
            return Ok(Converted { material: sheet, sets: self.sets, cutout: None });
        }
        Ok(Converted { material, sets: self.sets, cutout })
    }

    fn scattering(&mut self, source: &json::Material, material: &mut Material) -> Result<(), SceneError> {
        let pbr = &source.pbr_metallic_roughness;
        let extensions = source.extensions.as_ref();
        let metallic = self.unit(pbr.metallic_factor.0, "/pbrMetallicRoughness/metallicFactor")?;
        let roughness = self.unit(pbr.roughness_factor.0, "/pbrMetallicRoughness/roughnessFactor")?;
        let rough_map = pbr.metallic_roughness_texture.as_ref();
        let (mut transmission, mut specular) = (0.0, 1.0);
        if let Some(from) = extensions.and_then(|e| e.transmission.as_ref()) {
            let rest = "/extensions/KHR_materials_transmission/transmissionFactor";
            transmission = self.unit(from.transmission_factor.0, rest)?;
        }
        if let Some(from) = extensions.and_then(|e| e.specular.as_ref()) {
            specular = self.unit(from.specular_factor.0, "/extensions/KHR_materials_specular/specularFactor")?;
        }
        // Below a metal's surface there is nothing.
        let metal = metallic >= 1.0 && rough_map.is_none();
        if metal {
            (transmission, specular) = (0.0, 0.0);
        }
        if metallic > 0.0 || specular > 0.0 || transmission > 0.0 {
            material.surface = [metallic, roughness, transmission, 1.0];
            let place = "/pbrMetallicRoughness/metallicRoughnessTexture";
            material.textures[Material::METALLIC_ROUGHNESS] = self.texture(rough_map, Encoding::Linear, place)?;
        }
        if let Some(info) = &source.normal_texture {
            let place = format!("{}/normalTexture", self.place);
            let (reference, scale) = Reference::normal(self.document.at(), info, &place, self.warnings)?;
            material.textures[Material::NORMAL] = self.ask(&reference, Encoding::Linear, &place)?;
            material.surface[3] = scale;
        }
        if !metal {
            self.dielectric(source, specular, transmission, material)?;
        }
        self.coat(source, material)
    }

    /// What stands under `specular`, `interior` and transmission.
    fn dielectric(
        &mut self,
        source: &json::Material,
        specular: f32,
        transmission: f32,
        material: &mut Material,
    ) -> Result<(), SceneError> {
        material.specular[3] = specular;
        let Some(extensions) = &source.extensions else { return Ok(()) };
        if let Some(from) = extensions.specular.as_ref().filter(|_| specular > 0.0) {
            const PLACE: &str = "/extensions/KHR_materials_specular";
            for (to, color) in material.specular.iter_mut().zip(from.specular_color_factor.0) {
                *to = self.positive(color, &format!("{PLACE}/specularColorFactor"))?;
            }
            let place = format!("{PLACE}/specularTexture");
            let texture = self.texture(from.specular_texture.as_ref(), Encoding::Linear, &place)?;
            material.textures[Material::SPECULAR] = texture;
            let place = format!("{PLACE}/specularColorTexture");
            let texture = self.texture(from.specular_color_texture.as_ref(), Encoding::Srgb, &place)?;
            material.textures[Material::SPECULAR_COLOR] = texture;
        }
        if let Some(from) = extensions.ior.as_ref().filter(|_| specular > 0.0 || transmission > 0.0) {
            material.interior[3] = self.ior(from.ior.0)?;
        }
        if transmission > 0.0 {
            let map = extensions.transmission.as_ref().and_then(|t| t.transmission_texture.as_ref());
            let place = "/extensions/KHR_materials_transmission/transmissionTexture";
            material.textures[Material::TRANSMISSION] = self.texture(map, Encoding::Linear, place)?;
            if let Some(volume) = &extensions.volume {
                self.volume(volume, material)?;
            }
        }
        Ok(())
    }

    fn volume(
        &mut self,
        volume: &json::extensions::material::Volume,
        material: &mut Material,
    ) -> Result<(), SceneError> {
        const PLACE: &str = "/extensions/KHR_materials_volume";
        if self.positive(volume.thickness_factor.0, &format!("{PLACE}/thicknessFactor"))? == 0.0 {
            return Ok(());
        }
        material.flags |= Material::VOLUME;
        if volume.thickness_texture.is_some() {
            let what = "thickness textures are ignored: a solid is as thick as its mesh";
            self.warnings.add(what, || format!("{}{PLACE}/thicknessTexture", self.place));
        }
        let distance = volume.attenuation_distance.0;
        // No distance: infinitely far.
        if distance.is_nan() || distance <= 0.0 {
            let place = format!("{}{PLACE}/attenuationDistance", self.place);
            return Err(self.document.at().malformed(place, format!("{distance} is not above 0")));
        }
        for (to, color) in material.interior.iter_mut().zip(volume.attenuation_color.0) {
            let color = self.unit(color, &format!("{PLACE}/attenuationColor"))?.max(DARKEST);
            *to = (-float::ln(color) / distance).clamp(0.0, f32::MAX);
        }
        Ok(())
    }

    fn ior(&mut self, ior: f32) -> Result<f32, SceneError> {
        const REST: &str = "/extensions/KHR_materials_ior/ior";
        self.finite(ior, REST)?;
        // Exactly 0 has a meaning of its own; what lies below has none.
        if ior == 0.0 {
            return Ok(INFINITE_IOR);
        }
        if !(1.0..=INFINITE_IOR).contains(&ior) {
            let what = "indices of refraction outside of 1..10000 (and other than 0) are clamped";
            self.warnings.add(what, || format!("{}{REST}", self.place));
        }
        Ok(ior.clamp(1.0, INFINITE_IOR))
    }

    fn coat(&mut self, source: &json::Material, material: &mut Material) -> Result<(), SceneError> {
        const PLACE: &str = "/extensions/KHR_materials_clearcoat";
        let Some(coat) = Clearcoat::of(self.document.at(), source, self.place)? else { return Ok(()) };
        let factor = self.unit(coat.clearcoat_factor, &format!("{PLACE}/clearcoatFactor"))?;
        let roughness = self.unit(coat.clearcoat_roughness_factor, &format!("{PLACE}/clearcoatRoughnessFactor"))?;
        if factor == 0.0 {
            return Ok(());
        }
        material.coat = [factor, roughness, 1.0, 0.0];
        for (at, info, name) in [
            (Material::CLEARCOAT, &coat.clearcoat_texture, "clearcoatTexture"),
            (Material::CLEARCOAT_ROUGHNESS, &coat.clearcoat_roughness_texture, "clearcoatRoughnessTexture"),
        ] {
            let place = format!("{PLACE}/{name}");
            material.textures[at] = self.texture(info.as_ref(), Encoding::Linear, &place)?;
        }
        if let Some(info) = &coat.clearcoat_normal_texture {
            let place = format!("{}{PLACE}/clearcoatNormalTexture", self.place);
            let (reference, scale) = Reference::normal(self.document.at(), info, &place, self.warnings)?;
            material.textures[Material::CLEARCOAT_NORMAL] = self.ask(&reference, Encoding::Linear, &place)?;
            material.coat[2] = scale;
        }
        Ok(())
    }

    fn emission(&mut self, source: &json::Material, material: &mut Material) -> Result<(), SceneError> {
        let strength = source.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |s| s.emissive_strength.0);
        let radiance = source.emissive_factor.0.map(|c| c * strength);
        if !radiance.iter().all(|&c| c.is_finite() && c >= 0.0) {
            let place = format!("{}/emissiveFactor", self.place);
            return Err(self.document.at().malformed(place, format!("gives the radiance {radiance:?}")));
        }
        if radiance.iter().any(|&c| c > 0.0) {
            material.emission[..3].copy_from_slice(&radiance);
            let texture = self.texture(source.emissive_texture.as_ref(), Encoding::Srgb, "/emissiveTexture")?;
            material.textures[Material::EMISSION] = texture;
        }
        Ok(())
    }

    fn cutout(&mut self, source: &json::Material, texture: u32) -> Result<Option<Cutout>, SceneError> {
        let factor = source.pbr_metallic_roughness.base_color_factor.0[3];
        let (cutoff, blended) = match source.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                (self.positive(source.alpha_cutoff.unwrap_or_default().0, "/alphaCutoff")?, None)
            }
            Checked::Valid(AlphaMode::Blend) => (BLEND_CUTOFF, Some(format!("{}/alphaMode", self.place))),
            _ => return Ok(None),
        };
        let factor = self.unit(factor, "/pbrMetallicRoughness/baseColorFactor")?;
        Ok(Some(Cutout { material: NONE, texture, factor, cutoff, blended }))
    }

    /// A finite factor, clamped to 0..1: a surface cannot give more than it receives.
    fn unit(&mut self, value: f32, rest: &str) -> Result<f32, SceneError> {
        self.finite(value, rest)?;
        if !(0.0..=1.0).contains(&value) {
            self.warnings.add("material factors outside of 0..1 are clamped", || format!("{}{rest}", self.place));
        }
        Ok(value.clamp(0.0, 1.0))
    }

    /// A finite number, at least 0.
    fn positive(&mut self, value: f32, rest: &str) -> Result<f32, SceneError> {
        self.finite(value, rest)?;
        if value < 0.0 {
            self.warnings.add("negative material factors are read as 0", || format!("{}{rest}", self.place));
        }
        Ok(value.max(0.0))
    }

    fn finite(&self, value: f32, rest: &str) -> Result<(), SceneError> {
        let place = || format!("{}{rest}", self.place);
        if value.is_finite() { Ok(()) } else { Err(self.document.at().malformed(place(), "is not finite")) }
    }

    /// The texture in a field, or [`NONE`]; `rest` is the field's pointer within the material.
    fn texture(
        &mut self,
        info: Option<&json::texture::Info>,
        encoding: Encoding,
        rest: &str,
    ) -> Result<u32, SceneError> {
        let Some(info) = info else { return Ok(NONE) };
        let place = format!("{}{rest}", self.place);
        let reference = Reference::new(self.document.at(), info, &place, self.warnings)?;
        self.ask(&reference, encoding, &place)
    }

    fn ask(&mut self, reference: &Reference, encoding: Encoding, place: &str) -> Result<u32, SceneError> {
        let [first, second] = &mut self.sets;
        let second_set = if *first.get_or_insert(reference.set) == reference.set {
            0
        } else if *second.get_or_insert(reference.set) == reference.set {
            Texture::SECOND_UV
        } else {
            let what = "textures that read a material's third set of texture coordinates are left out";
            self.warnings.add(what, || place.to_owned());
            return Ok(NONE);
        };
        let linear = match encoding {
            Encoding::Srgb => 0,
            Encoding::Linear => Texture::LINEAR,
        };
        self.textures.ask(self.document, reference, second_set | linear, self.warnings)
    }
}

/// A Lambertian or dielectric surface of this opacity as a thin sheet: it emits opacity × radiance, reflects opacity ×
/// base colour and its share of the highlight, and lets the rest through in straight lines. Exact for grey; colours keep
/// their mean. The highlight is sharp whatever the roughness, which would scatter what passes as well. `None` for other
/// surfaces, for those whose opacity a texture may change, and for opaque ones.
fn sheet(material: &Material, opacity: f32) -> Option<Material> {
    let [metallic, _, transmission, _] = material.surface;
    let plain = metallic == 0.0 && transmission == 0.0 && material.coat[0] == 0.0;
    let textured = material.textures.iter().any(|&texture| texture != NONE);
    if !plain || textured || material.flags & Material::UNLIT != 0 || opacity >= 1.0 {
        return None;
    }
    let passes = 1.0 - opacity;
    // The sheet's colour tints both parts, so it is that of their sum.
    let [r, g, b, _] = material.base_color.map(|c| passes + opacity * c);
    let share = passes * 3.0 / (r + g + b);
    let mut sheet = *material;
    sheet.base_color = [r, g, b, 1.0];
    sheet.surface = [0.0, 0.0, share.min(1.0), 1.0];
    sheet.specular[3] *= opacity;
    sheet.emission[..3].iter_mut().for_each(|c| *c *= opacity);
    Some(sheet)
}
