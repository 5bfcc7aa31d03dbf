//! Naming what a file holds beyond what is modelled.

use gltf::json;

use super::document::{escape, foreign_extensions};
use crate::warning::Warnings;

/// Warns of an extension that is not respected.
pub(crate) fn foreign(warnings: &mut Warnings, name: &str, pointer: impl FnOnce() -> String) {
    warnings.add(&message(name), pointer);
}

fn message(name: &str) -> String {
    let what = match name {
        "KHR_lights_punctual" => "; its lights are left out",
        "KHR_texture_transform" => "; textures are shown untransformed",
        "EXT_mesh_gpu_instancing" => "; its instances are left out",
        _ if name.contains("_materials_") => "; the diffuse base colour is shown",
        _ => "; what it says is ignored",
    };
    format!("extension {name} is not modelled yet{what}")
}

/// Warns of what concerns the file as a whole. Comes last: extensions already met at their place are not repeated.
pub(crate) fn file(root: &json::Root, warnings: &mut Warnings) {
    let animations = root.animations.len();
    warnings.add_many("animations are not modelled; the file's pose is shown", animations, || "/animations".into());
    for (i, name) in foreign_extensions(root) {
        if !warnings.contains(&message(&name)) {
            warnings.add(&message(&name), || format!("/extensionsUsed/{i}"));
        }
    }
}

/// Warns of a material's fields that are not shown.
pub(crate) fn material(index: usize, material: &json::Material, warnings: &mut Warnings) {
    let place = |rest: &str| format!("/materials/{index}{rest}");
    let pbr = &material.pbr_metallic_roughness;
    if pbr.metallic_factor.0 != 0.0 {
        let what = "metallic reflection is not modelled yet; the base colour is shown as a Lambertian surface";
        warnings.add(what, || place("/pbrMetallicRoughness"));
    }
    let extensions = material.extensions.as_ref();
    // Dielectric reflection is there unless this extension turns it off.
    if extensions.and_then(|e| e.specular.as_ref()).is_none_or(|s| s.specular_factor.0 != 0.0) {
        let what = "specular reflection is not modelled yet; the base colour is shown as a Lambertian surface";
        warnings.add(what, || place(""));
    }
    let textures = [
        (
            pbr.metallic_roughness_texture.is_some(),
            "metallic-roughness textures are not modelled yet",
            "/pbrMetallicRoughness/metallicRoughnessTexture",
        ),
        (
            material.normal_texture.is_some(),
            "normal maps are not modelled yet; surfaces are shown smooth",
            "/normalTexture",
        ),
        (
            material.occlusion_texture.is_some(),
            "occlusion textures are ignored: occlusion is computed",
            "/occlusionTexture",
        ),
        (
            material.emissive_texture.is_some(),
            "emissive textures are not modelled yet; such surfaces are shown without emission",
            "/emissiveTexture",
        ),
    ];
    for (_, what, rest) in textures.into_iter().filter(|t| t.0) {
        warnings.add(what, || place(rest));
    }
    if !matches!(material.alpha_mode, json::validation::Checked::Valid(json::material::AlphaMode::Opaque)) {
        warnings.add("alpha is not modelled yet; surfaces are shown opaque", || place("/alphaMode"));
    }
    for name in extensions.iter().flat_map(|e| e.others.keys()) {
        foreign(warnings, name, || place(&format!("/extensions/{}", escape(name))));
    }
    let texture = pbr.base_color_texture.as_ref().and_then(|t| t.extensions.as_ref());
    for name in texture.iter().flat_map(|e| e.others.keys()) {
        let rest = format!("/pbrMetallicRoughness/baseColorTexture/extensions/{}", escape(name));
        foreign(warnings, name, || place(&rest));
    }
}

/// Warns of a primitive's data that are not shown.
pub(crate) fn primitive(place: &str, primitive: &json::mesh::Primitive, warnings: &mut Warnings) {
    use json::mesh::Semantic;
    use json::validation::Checked;
    if primitive.attributes.keys().any(|k| matches!(k, Checked::Valid(Semantic::Colors(_)))) {
        warnings.add("vertex colours are not modelled yet", || format!("{place}/attributes/COLOR_0"));
    }
    if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
        warnings.add("morph targets are not modelled; the base shape is shown", || format!("{place}/targets"));
    }
    for name in primitive.extensions.iter().flat_map(|e| e.others.keys()) {
        foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
    }
}
