//! Masks: where surfaces have holes.

use std::collections::HashMap;

use hashcache_core::geometry::OpacityMask;
use pt_integrator::scene::{Material, NONE, OpacityData, Texture, Wrap};

use super::images::Decoded;
use super::textures::Textures;
use crate::warning::Warnings;

/// A material with holes.
#[derive(Clone, Debug)]
pub(crate) struct Cutout {
    /// Index in the scene's list.
    pub material: u32,
    /// The texture whose alpha says where, or [`NONE`]: everywhere alike.
    pub texture: u32,
    /// Factor on the texture's alpha.
    pub factor: f32,
    /// Below this there is a hole.
    pub cutoff: f32,
    /// The mask stands for blending that this field asks for.
    pub blended: Option<String>,
}

/// What is said of blended surfaces that are not opaque everywhere.
const MASKS: &str = "blended surfaces are shown as masks: there from an opacity of 0.5 on, not there below";

/// The alpha of an image that materials read.
struct Alpha {
    /// Its extremes.
    range: [u8; 2],
    /// Its place in the list, once a mask needs it.
    first: Option<u32>,
}

/// The bits of [`Texture::flags`] that say what is outside of the image.
const WRAPS: u32 = 15;

/// The masks of these materials, and each material's. One that has no hole anywhere gets none and is opaque. An image is
/// looked through once, however many materials read it.
pub(crate) fn masks(
    cutouts: &[Cutout],
    materials: &mut [Material],
    textures: &Textures,
    images: &Decoded,
    warnings: &mut Warnings,
) -> (OpacityData, Vec<u32>) {
    let mut data = OpacityData::default();
    let mut of_material = vec![NONE; materials.len()];
    let mut by_image: HashMap<Option<usize>, Alpha> = HashMap::new();
    for cutout in cutouts {
        let textured = cutout.texture != NONE;
        let (slot, texture) = if textured {
            (Some(textures.slot(cutout.texture)), *textures.get(cutout.texture))
        } else {
            (None, Texture::new(0, [1, 1], [Wrap::Clamp; 2]))
        };
        let size = slot.map_or([1, 1], |slot| images.places[slot].size);
        let alpha = || slot.map_or(&[u32::MAX][..], |slot| images.image(slot)).iter().map(|texel| (texel >> 24) as u8);
        let image = by_image.entry(slot).or_insert_with(|| {
            let range = alpha().fold([u8::MAX, 0], |[low, high], x| [low.min(x), high.max(x)]);
            Alpha { range, first: None }
        });
        let mut mask = OpacityMask {
            first_alpha: 0,
            width: size[0],
            height: size[1],
            wrap: texture.flags & WRAPS,
            uv_rows: texture.uv_rows,
            cutoff: cutout.cutoff,
            factor: cutout.factor,
            reserved: [0; 2],
        };
        if let Some(place) = &cutout.blended
            && (OpacityMask { cutoff: 1.0, ..mask }).has_holes_in(image.range)
        {
            warnings.add(MASKS, || place.clone());
        }
        if !mask.has_holes_in(image.range) {
            continue;
        }
        mask.first_alpha = *image.first.get_or_insert_with(|| {
            let first = data.alpha.len() as u32;
            data.alpha.extend(alpha());
            first
        });
        let material = &mut materials[cutout.material as usize];
        material.flags |= Material::ALPHA_MASK;
        (material.base_color[3], material.emission[3]) = (cutout.factor, cutout.cutoff);
        of_material[cutout.material as usize] = data.masks.len() as u32;
        data.masks.push(mask);
    }
    (data, of_material)
}
