//! Naming what a file holds beyond what is modelled.

use gltf::json;

use super::clearcoat::Clearcoat;
use super::document::{escape, foreign_extensions};
use crate::warning::Warnings;

/// Warns of an extension that is not read.
pub(crate) fn foreign(warnings: &mut Warnings, name: &str, pointer: impl FnOnce() -> String) {
    warnings.add(&message(name), pointer);
}

fn message(name: &str) -> String {
    let what = match name {
        "EXT_mesh_gpu_instancing" => "; its instances are left out",
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" | "MSFT_texture_dds" => {
            "; the PNG or JPEG image beside it is shown"
        }
        _ if name.contains("_materials_") => "; the material is shown without it",
        _ => "; what it says is ignored",
    };
    format!("extension {name} is not modelled{what}")
}

/// Warns of what concerns the file as a whole. Comes last: extensions already met at their place are not repeated.
pub(crate) fn file(root: &json::Root, warnings: &mut Warnings) {
    for name in root.extensions.iter().flat_map(|e| e.others.keys()) {
        if !warnings.contains(&message(name)) {
            foreign(warnings, name, || format!("/extensions/{}", escape(name)));
        }
    }
    let animations = root.animations.len();
    warnings.add_many("animations are not modelled; the file's pose is shown", animations, || "/animations".into());
    for (i, name) in foreign_extensions(root) {
        if !warnings.contains(&message(&name)) {
            warnings.add(&message(&name), || format!("/extensionsUsed/{i}"));
        }
    }
}

/// Warns of a material's fields that are not shown; `place` is its pointer.
pub(crate) fn material(material: &json::Material, place: &str, warnings: &mut Warnings) {
    if material.occlusion_texture.is_some() {
        warnings.add("occlusion textures are ignored: occlusion is computed", || format!("{place}/occlusionTexture"));
    }
    for name in material.extensions.iter().flat_map(|e| e.others.keys()).filter(|n| *n != Clearcoat::NAME) {
        foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
    }
}

/// Warns of a primitive's data that are not shown.
pub(crate) fn primitive(place: &str, primitive: &json::mesh::Primitive, warnings: &mut Warnings) {
    use json::mesh::Semantic;
    use json::validation::Checked;
    if primitive.attributes.keys().any(|k| matches!(k, Checked::Valid(Semantic::Colors(_)))) {
        warnings.add("vertex colours are not modelled; the material's colour is shown", || {
            format!("{place}/attributes/COLOR_0")
        });
    }
    if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
        warnings.add("morph targets are not modelled; the base shape is shown", || format!("{place}/targets"));
    }
    for name in primitive.extensions.iter().flat_map(|e| e.others.keys()) {
        foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
    }
}
