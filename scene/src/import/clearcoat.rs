//! `KHR_materials_clearcoat`, which the parser leaves as it is.

use gltf::json;
use serde::Deserialize;

use crate::error::{At, SceneError};

/// The extension's fields.
#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
#[expect(clippy::struct_field_names, reason = "the extension's own names")]
pub(super) struct Clearcoat {
    pub clearcoat_factor: f32,
    pub clearcoat_texture: Option<json::texture::Info>,
    pub clearcoat_roughness_factor: f32,
    pub clearcoat_roughness_texture: Option<json::texture::Info>,
    pub clearcoat_normal_texture: Option<json::material::NormalTexture>,
}

impl Clearcoat {
    /// Its name.
    pub const NAME: &str = "KHR_materials_clearcoat";

    /// A material's clear coat, where it has one.
    pub fn of(at: At, material: &json::Material, place: &str) -> Result<Option<Self>, SceneError> {
        let Some(value) = material.extensions.as_ref().and_then(|e| e.others.get(Self::NAME)) else {
            return Ok(None);
        };
        let place = || format!("{place}/extensions/{}", Self::NAME);
        // Lists would be taken for fields without names.
        if !value.is_object() {
            return Err(at.malformed(place(), "is no object"));
        }
        let read = serde_json::from_value(value.clone());
        read.map(Some).map_err(|e| at.malformed(place(), e.to_string()))
    }
}
