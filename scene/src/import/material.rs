//! Materials and their textures.

use std::collections::HashMap;

use gltf::json;
use json::texture::{MagFilter, WrappingMode};
use json::validation::Checked;
use pt_integrator::scene::{Material, NONE, Texture, Wrap};

use super::document::Document;
use super::{features, resource};
use crate::LoadOptions;
use crate::error::SceneError;
use crate::texture::{Refusal, Texels, append};
use crate::warning::Warnings;

/// A material in the scene's list, and what its primitives need to know of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Index in the scene's list.
    pub index: u32,
    /// It emits, so its primitives take their own normals and count emitters.
    pub emits: bool,
    /// The set of texture coordinates that its texture reads.
    pub tex_coord: Option<u32>,
}

/// The materials and textures that have been asked for so far, each converted once.
pub(crate) struct Materials<'a> {
    document: &'a Document,
    options: &'a LoadOptions,
    surfaces: HashMap<Option<usize>, Surface>,
    images: HashMap<usize, Texels>,
    by_texture: HashMap<usize, u32>,
    /// The scene's materials.
    pub list: Vec<Material>,
    /// The scene's textures.
    pub textures: Vec<Texture>,
    /// The texels of all textures.
    pub texels: Vec<u32>,
}

impl<'a> Materials<'a> {
    /// None so far.
    pub fn new(document: &'a Document, options: &'a LoadOptions) -> Self {
        Self {
            document,
            options,
            surfaces: HashMap::new(),
            images: HashMap::new(),
            by_texture: HashMap::new(),
            list: Vec::new(),
            textures: Vec::new(),
            texels: Vec::new(),
        }
    }

    /// Number of images that have been decoded.
    pub fn images(&self) -> usize {
        self.images.len()
    }

    /// The surface of a glTF material; `None` is glTF's default material.
    pub fn surface(&mut self, index: Option<usize>, warnings: &mut Warnings) -> Result<Surface, SceneError> {
        if let Some(&surface) = self.surfaces.get(&index) {
            return Ok(surface);
        }
        let standard = json::Material::default();
        let source = match index {
            None => {
                let what = "primitives without a material are shown as a white Lambertian surface";
                warnings.add(what, || "/meshes".into());
                &standard
            }
            Some(i) => {
                features::material(i, &self.document.root.materials[i], warnings);
                &self.document.root.materials[i]
            }
        };
        let place = index.map_or_else(String::new, |i| format!("/materials/{i}"));
        let (material, tex_coord) = self.convert(source, &place, warnings)?;
        let surface = Surface { index: self.list.len() as u32, emits: material.emits(), tex_coord };
        self.list.push(material);
        self.surfaces.insert(index, surface);
        Ok(surface)
    }

    fn convert(
        &mut self,
        source: &json::Material,
        place: &str,
        warnings: &mut Warnings,
    ) -> Result<(Material, Option<u32>), SceneError> {
        let at = self.document.at();
        let pbr = &source.pbr_metallic_roughness;
        let factor = pbr.base_color_factor.0;
        if !factor[..3].iter().all(|c| c.is_finite()) {
            let place = format!("{place}/pbrMetallicRoughness/baseColorFactor");
            return Err(at.malformed(place, format!("{factor:?} is not finite")));
        }
        // A surface cannot reflect more than it receives.
        let albedo = [factor[0], factor[1], factor[2]].map(|c| c.clamp(0.0, 1.0));
        if albedo[..] != factor[..3] {
            let what = "base colour factors outside of 0..1 are clamped";
            warnings.add(what, || format!("{place}/pbrMetallicRoughness/baseColorFactor"));
        }
        let extensions = source.extensions.as_ref();
        let strength = extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |s| s.emissive_strength.0);
        let radiance = source.emissive_factor.0.map(|c| c * strength);
        if !radiance.iter().all(|&c| c.is_finite() && c >= 0.0) {
            return Err(at.malformed(format!("{place}/emissiveFactor"), format!("gives the radiance {radiance:?}")));
        }
        let mut material = Material::lambert(albedo);
        if source.emissive_texture.is_none() {
            material = Material::emissive(albedo, radiance);
        }
        material.flags = if source.double_sided { Material::DOUBLE_SIDED } else { 0 };
        let Some(info) = &pbr.base_color_texture else { return Ok((material, None)) };
        material.textures[Material::BASE_COLOR] = self.texture(info.index.value(), warnings)?;
        Ok((material, Some(info.tex_coord)))
    }

    fn texture(&mut self, index: usize, warnings: &mut Warnings) -> Result<u32, SceneError> {
        if let Some(&texture) = self.by_texture.get(&index) {
            return Ok(texture);
        }
        let root = &self.document.root;
        let source = &root.textures[index];
        let sampler = source.sampler.map(|s| (s.value(), &root.samplers[s.value()]));
        let wrap = |mode: Checked<WrappingMode>| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let mut wraps = [Wrap::Repeat; 2];
        if let Some((i, sampler)) = sampler {
            wraps = [wrap(sampler.wrap_s), wrap(sampler.wrap_t)];
            if matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))) {
                warnings
                    .add("textures are filtered bilinearly, also where the sampler asks for the nearest texel", || {
                        format!("/samplers/{i}/magFilter")
                    });
            }
        }
        let image = self.image(source.source.value(), warnings)?;
        let texture = self.textures.len() as u32;
        self.textures.push(Texture::new(image.first, [image.width, image.height], wraps));
        self.by_texture.insert(index, texture);
        Ok(texture)
    }

    fn image(&mut self, index: usize, warnings: &mut Warnings) -> Result<Texels, SceneError> {
        if let Some(&image) = self.images.get(&index) {
            return Ok(image);
        }
        let document = self.document;
        let at = document.at();
        let source = &document.root.images[index];
        let place = format!("/images/{index}");
        let read;
        let bytes = match (&source.uri, source.buffer_view) {
            (Some(uri), _) => {
                let place = format!("{place}/uri");
                read = resource::read_uri(at, &document.base, uri, &place, self.options.max_bytes)?;
                read.as_slice()
            }
            (None, Some(view)) => document.view(view.value())?,
            (None, None) => return Err(at.malformed(place, "has neither uri nor bufferView")),
        };
        let image = append(bytes, &mut self.texels, self.options.max_texels).map_err(|refusal| match refusal {
            Refusal::Broken(why) => {
                at.unsupported(&place, format!("is no usable PNG or JPEG image: {why}"), "convert the image")
            }
            Refusal::TooLarge(count) => {
                at.too_large(&place, format!("{count} more texels"), self.options.max_texels.into(), "max_texels")
            }
        })?;
        if image.deep {
            warnings.add("textures of 16 bits a channel are shown with 8", || place);
        }
        self.images.insert(index, image);
        debug_assert!(image.first != NONE);
        Ok(image)
    }
}
