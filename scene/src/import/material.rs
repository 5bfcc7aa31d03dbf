//! Materials, each converted once.

use std::collections::HashMap;

use gltf::json;
use pt_integrator::scene::{Material, NONE, OpacityData, Texture};

use super::convert::{Converted, Converter};
use super::document::Document;
use super::features;
use super::images::Decoded;
use super::opacity::{self, Cutout};
use super::textures::Textures;
use crate::LoadOptions;
use crate::error::SceneError;
use crate::progress::Listener;
use crate::warning::Warnings;

/// A material in the scene's list, and what its primitives need to know of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Index in the scene's list.
    pub index: u32,
    /// The sets of texture coordinates that its textures read: first and second.
    pub sets: [Option<u32>; 2],
    /// It has a normal map, which stands in the frame of the texture coordinates.
    pub normal_map: bool,
}

/// The materials and textures that have been asked for so far.
pub(crate) struct Materials<'a> {
    document: &'a Document,
    surfaces: HashMap<Option<usize>, Surface>,
    list: Vec<Material>,
    textures: Textures,
    cutouts: Vec<Cutout>,
}

/// What surfaces look like, in the scene's lists.
pub(crate) struct Look {
    /// The scene's materials.
    pub materials: Vec<Material>,
    /// The scene's textures.
    pub textures: Vec<Texture>,
    /// The texels of all textures.
    pub texels: Vec<u32>,
    /// Masks and their alpha; no triangles yet.
    pub opacity: OpacityData,
    /// Index of each material's mask, or [`NONE`].
    pub mask_of_material: Vec<u32>,
    /// Number of images that have been decoded.
    pub images: usize,
}

impl<'a> Materials<'a> {
    /// None so far.
    pub fn new(document: &'a Document) -> Self {
        Self {
            document,
            surfaces: HashMap::new(),
            list: Vec::new(),
            textures: Textures::default(),
            cutouts: Vec::new(),
        }
    }

    /// The surface of a glTF material; `None` is glTF's default material.
    pub fn surface(&mut self, index: Option<usize>, warnings: &mut Warnings) -> Result<Surface, SceneError> {
        if let Some(&surface) = self.surfaces.get(&index) {
            return Ok(surface);
        }
        let standard = json::Material::default();
        let (source, place) = match index {
            None => (&standard, "/meshes".to_owned()),
            Some(i) => (&self.document.root.materials[i], format!("/materials/{i}")),
        };
        features::material(source, &place, warnings);
        let converter = Converter::new(self.document, &mut self.textures, &place, warnings);
        let Converted { material, sets, cutout } = converter.convert(source)?;
        let index_in_list = self.list.len() as u32;
        self.cutouts.extend(cutout.map(|cutout| Cutout { material: index_in_list, ..cutout }));
        let surface = Surface { index: index_in_list, sets, normal_map: has_normal_map(&material) };
        self.list.push(material);
        self.surfaces.insert(index, surface);
        Ok(surface)
    }

    /// Decodes the images and completes the lists.
    pub fn finish(
        mut self,
        options: &LoadOptions,
        progress: Listener,
        warnings: &mut Warnings,
    ) -> Result<Look, SceneError> {
        let decoded = self.textures.images.decode(self.document, options, progress, warnings)?;
        let images = self.textures.images.len();
        leave_out_black(&mut self.list, &self.textures, &decoded);
        let (opacity, mask_of_material) =
            opacity::masks(&self.cutouts, &mut self.list, &self.textures, &decoded, warnings);
        let textures = self.textures.finish(&decoded);
        let texels = decoded.texels;
        Ok(Look { materials: self.list, textures, texels, opacity, mask_of_material, images })
    }
}

fn has_normal_map(material: &Material) -> bool {
    [Material::NORMAL, Material::CLEARCOAT_NORMAL].iter().any(|&place| material.textures[place] != NONE)
}

/// Surfaces whose emission texture is black everywhere emit nothing. An image is looked through once.
fn leave_out_black(materials: &mut [Material], textures: &Textures, images: &Decoded) {
    const COLOR: u32 = 0x00ff_ffff;
    let mut black: HashMap<usize, bool> = HashMap::new();
    for material in materials {
        let texture = material.textures[Material::EMISSION];
        if texture == NONE {
            continue;
        }
        let slot = textures.slot(texture);
        let is_black = || images.image(slot).iter().all(|texel| texel & COLOR == 0);
        if *black.entry(slot).or_insert_with(is_black) {
            material.textures[Material::EMISSION] = NONE;
            material.emission[..3].fill(0.0);
        }
    }
}
