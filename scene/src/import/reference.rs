//! Textures as materials name them.

use gltf::json;
use hashcache_core::float;
use json::extensions::texture::TextureTransform;
use pt_integrator::scene::Texture;

use super::document::escape;
use super::features;
use crate::error::{At, SceneError};
use crate::warning::Warnings;

/// The extension that moves, turns and scales coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// A texture, and how a material reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reference {
    /// Index of the texture.
    pub texture: usize,
    /// Which set of the vertices' coordinates.
    pub set: u32,
    /// From those coordinates to the image's; see [`Texture::uv_rows`].
    pub rows: [[f32; 4]; 2],
}

impl Reference {
    /// A `textureInfo`; `place` is its pointer.
    pub fn new(at: At, info: &json::texture::Info, place: &str, warnings: &mut Warnings) -> Result<Self, SceneError> {
        let extensions = info.extensions.as_ref();
        for name in extensions.iter().flat_map(|e| e.others.keys()) {
            features::foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
        }
        let transform = extensions.and_then(|e| e.texture_transform.as_ref());
        Self { texture: info.index.value(), set: info.tex_coord, rows: Texture::IDENTITY }.moved(at, transform, place)
    }

    /// A `normalTextureInfo`, and its scale.
    pub fn normal(
        at: At,
        info: &json::material::NormalTexture,
        place: &str,
        warnings: &mut Warnings,
    ) -> Result<(Self, f32), SceneError> {
        if !info.scale.is_finite() {
            return Err(at.malformed(format!("{place}/scale"), "is not finite"));
        }
        let mut transform = None;
        for (name, value) in info.extensions.iter().flat_map(|e| &e.others) {
            let place = || format!("{place}/extensions/{}", escape(name));
            if name == TRANSFORM {
                let read = serde_json::from_value::<TextureTransform>(value.clone());
                transform = Some(read.map_err(|e| at.malformed(place(), e.to_string()))?);
            } else {
                features::foreign(warnings, name, place);
            }
        }
        let plain = Self { texture: info.index.value(), set: info.tex_coord, rows: Texture::IDENTITY };
        Ok((plain.moved(at, transform.as_ref(), place)?, info.scale))
    }

    /// Offset · rotation · scale. Coordinates turn counter-clockwise as one sees the image, whose v points down: so do
    /// Khronos' viewer and test model; the shader in the extension's text turns them the other way.
    fn moved(mut self, at: At, transform: Option<&TextureTransform>, place: &str) -> Result<Self, SceneError> {
        let Some(transform) = transform else { return Ok(self) };
        let ([x, y], [width, height]) = (transform.offset.0, transform.scale.0);
        let (sin, cos) = float::sin_cos(transform.rotation.0);
        self.rows = [[cos * width, sin * height, x, 0.0], [-sin * width, cos * height, y, 0.0]];
        self.set = transform.tex_coord.unwrap_or(self.set);
        if self.rows.as_flattened().iter().all(|x| x.is_finite()) {
            Ok(self)
        } else {
            Err(at.malformed(format!("{place}/extensions/{TRANSFORM}"), "has a number that is not finite"))
        }
    }
}
