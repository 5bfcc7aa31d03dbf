//! The scene's list of textures.

use std::collections::HashMap;

use gltf::json;
use json::texture::{MagFilter, WrappingMode};
use json::validation::Checked;
use pt_integrator::scene::{Texture, Wrap};

use super::document::{Document, escape};
use super::features;
use super::images::{Decoded, Images};
use super::reference::Reference;
use crate::error::SceneError;
use crate::warning::Warnings;

/// The textures that have been asked for. Those that read an image alike are one; those that don't share its texels.
#[derive(Default)]
pub(crate) struct Textures {
    /// Their images.
    pub images: Images,
    /// `first_texel` is the image's slot and the size 0 until [`Textures::finish`].
    list: Vec<Texture>,
    by_content: HashMap<(u32, u32, [u32; 8]), u32>,
}

impl Textures {
    /// The texture that `reference` and these flags ask for.
    pub fn ask(
        &mut self,
        document: &Document,
        reference: &Reference,
        flags: u32,
        warnings: &mut Warnings,
    ) -> Result<u32, SceneError> {
        let at = document.at();
        let place = format!("/textures/{}", reference.texture);
        let root = &document.root;
        let source = root.textures.get(reference.texture).ok_or_else(|| at.malformed(&place, "does not exist"))?;
        let others = || source.extensions.iter().flat_map(|e| e.others.keys());
        if source.source.value() >= root.images.len() {
            let names: Vec<_> = others().map(String::as_str).collect();
            let what = match names.as_slice() {
                [] => "has no image".to_owned(),
                names => format!("has no PNG or JPEG image, only {}", names.join(", ")),
            };
            return Err(at.unsupported(place, what, "export it with PNG or JPEG textures"));
        }
        for name in others() {
            features::foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
        }
        let wraps = match source.sampler {
            None => [Wrap::Repeat; 2],
            Some(index) => wraps(&root.samplers[index.value()], index.value(), warnings),
        };
        let slot = self.images.slot(source.source.value()) as u32;
        let texture = Texture {
            flags: Texture::wrap_word(wraps[0], wraps[1]) | flags,
            uv_rows: reference.rows,
            ..Texture::new(slot, [0; 2], wraps)
        };
        let bits: [u32; 8] = std::array::from_fn(|i| reference.rows[i / 4][i % 4].to_bits());
        Ok(*self.by_content.entry((slot, texture.flags, bits)).or_insert_with(|| {
            self.list.push(texture);
            self.list.len() as u32 - 1
        }))
    }

    /// The slot of a texture's image.
    pub fn slot(&self, texture: u32) -> usize {
        self.list[texture as usize].first_texel as usize
    }

    /// The texture without its place among the texels.
    pub fn get(&self, texture: u32) -> &Texture {
        &self.list[texture as usize]
    }

    /// The list, with texels in their places.
    pub fn finish(mut self, images: &Decoded) -> Vec<Texture> {
        for texture in &mut self.list {
            let place = images.places[texture.first_texel as usize];
            texture.first_texel = place.first;
            [texture.width, texture.height] = place.size;
        }
        self.list
    }
}

/// What is outside of the image, along s and t.
fn wraps(sampler: &json::texture::Sampler, index: usize, warnings: &mut Warnings) -> [Wrap; 2] {
    if matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))) {
        let what = "textures are filtered bilinearly, also where the sampler asks for the nearest texel";
        warnings.add(what, || format!("/samplers/{index}/magFilter"));
    }
    [sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    })
}
