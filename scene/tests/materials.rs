//! Materials, textures, cameras and what is warned of.
#![expect(clippy::needless_pass_by_value, reason = "`json!` gives values")]

mod common;

use common::{Gltf, warned};
use hashcache_core::float;
use pt_integrator::scene::{Lobes, Material};
use serde_json::{Value, json};

/// A triangle with this material.
fn with_material(material: Value) -> Gltf {
    let mut file = Gltf::triangle();
    file.push("materials", material);
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

/// A metallic factor of 0 and no specular reflection.
fn lambert(rest: Value) -> Value {
    let mut material = json!({
        "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.1, 0.2, 0.3, 1]},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
    });
    for (key, value) in rest.as_object().unwrap() {
        match value.as_object() {
            Some(members) if key == "extensions" => {
                material["extensions"].as_object_mut().unwrap().extend(members.clone());
            }
            _ => material[key] = value.clone(),
        }
    }
    material
}

#[test]
fn a_lambertian_material_gives_no_warning() {
    let loaded = with_material(lambert(json!({}))).load().unwrap();
    assert_eq!(loaded.data.materials, [Material::lambert([0.1, 0.2, 0.3])]);
    assert_eq!(loaded.warnings, []);
    assert!(!loaded.data.emits(0));
}

#[test]
fn emission_is_factor_times_strength_and_drops_normals() {
    for double_sided in [false, true] {
        let mut file = with_material(lambert(json!({
            "emissiveFactor": [1.0, 0.5, 0.0], "doubleSided": double_sided,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8.0}},
        })));
        let normal = file.vec3(&[[0.0, 1.0, 0.0]; 3]);
        file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
        let loaded = file.load().unwrap();
        assert_eq!(loaded.data.materials[0].emission[..3], [8.0, 4.0, 0.0]);
        assert_eq!(loaded.data.materials[0].flags, u32::from(double_sided) * Material::DOUBLE_SIDED);
        assert!(loaded.data.triangle_shading[0].is_flat());
        assert!(loaded.data.emits(0));
        assert_eq!(loaded.info.emissive_triangles, 1);
        assert_eq!(loaded.warnings, []);
    }
}

#[test]
fn emitters_are_counted_where_they_are_placed() {
    let mut file = with_material(lambert(json!({"emissiveFactor": [1, 1, 1]})));
    file.push("materials", lambert(json!({})));
    file.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0}, "material": 0},
        {"attributes": {"POSITION": 0}, "material": 1},
        {"attributes": {"POSITION": 0}, "material": 0},
    ]);
    file.mesh(json!([{"attributes": {"POSITION": 0}, "material": 0}]));
    file.node(json!({"mesh": 1}));
    file.node(json!({"mesh": 1}));
    let loaded = file.load().unwrap();
    assert_eq!([0, 1, 2, 3].map(|triangle| loaded.data.emits(triangle)), [true, false, true, true]);
    assert_eq!(loaded.info.emissive_triangles, 4);
}

#[test]
fn what_is_not_modelled_is_named_once_with_its_place() {
    let mut file = with_material(json!({
        "occlusionTexture": {"index": 0}, "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]},
        "extensions": {"KHR_materials_sheen": {}},
    }));
    file.push("images", json!({"uri": "missing.png"}));
    file.push("textures", json!({"source": 0}));
    file.push("materials", json!({}));
    file.push("animations", json!({"channels": [], "samplers": []}));
    let colour = file.vec3(&[[1.0; 3]; 3]);
    file.json["extensionsUsed"] =
        json!(["KHR_materials_sheen", "KHR_a\nnimation", "KHR_materials_specular", "KHR_xmp"]);
    file.json["extensions"] = json!({"KHR_xmp": {}});
    file.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0, "COLOR_0": colour}, "material": 0},
        {"attributes": {"POSITION": 0}, "material": 1},
        {"attributes": {"POSITION": 0}},
    ]);
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {}});
    let loaded = file.load().unwrap();
    for (text, place) in [
        ("occlusion", "/materials/0/occlusionTexture"),
        ("blended", "/materials/0/alphaMode"),
        ("KHR_materials_sheen", "/materials/0/extensions/KHR_materials_sheen"),
        ("vertex colours", "/meshes/0/primitives/0/attributes/COLOR_0"),
        ("animations", "/animations"),
        ("its instances are left out", "/nodes/0/extensions/EXT_mesh_gpu_instancing"),
        ("nimation is not modelled", "/extensionsUsed/1"),
        ("KHR_xmp", "/extensions/KHR_xmp"),
    ] {
        assert_eq!(warned(&loaded, text), Some(place), "{text}: {:#?}", loaded.warnings);
        assert_eq!(loaded.warnings.iter().filter(|w| w.what.contains(text)).count(), 1, "{text}");
    }
    assert_eq!(loaded.warnings.len(), 8, "{:#?}", loaded.warnings);
    assert!(loaded.warnings.iter().all(|w| w.to_string().lines().count() == 1));
}

#[test]
fn the_default_material_is_white_rough_metal() {
    let loaded = Gltf::triangle().load().unwrap();
    let expected = Material { surface: [1.0, 1.0, 0.0, 1.0], ..Material::lambert([1.0; 3]) };
    assert_eq!(loaded.data.materials, [expected]);
    assert_eq!(loaded.warnings, []);
    assert_eq!(loaded.data.materials[0].lobes(), Lobes::REFLECTION);
}

/// The material that these fields give.
#[track_caller]
fn converted(source: Value) -> Material {
    let loaded = with_material(source).load().unwrap();
    assert_eq!(loaded.warnings, []);
    loaded.data.materials[0]
}

#[test]
fn metal_plastic_glass_and_coats() {
    let base = Material::lambert([1.0; 3]);
    let metal = converted(json!({"pbrMetallicRoughness": {"roughnessFactor": 0.25}, "extensions": {
        "KHR_materials_ior": {"ior": 1.8}, "KHR_materials_transmission": {"transmissionFactor": 1}}}));
    // Below metal there is nothing that could transmit.
    assert_eq!(metal, Material { surface: [1.0, 0.25, 0.0, 1.0], ..base });
    let plastic = converted(json!({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5}}));
    assert_eq!(plastic, Material { surface: [0.0, 0.5, 0.0, 1.0], specular: [1.0; 4], ..base });
    let tinted = converted(json!({"pbrMetallicRoughness": {"metallicFactor": 0.5}, "extensions": {
        "KHR_materials_ior": {"ior": 1.8},
        "KHR_materials_specular": {"specularFactor": 0.75, "specularColorFactor": [0.5, 1, 2]}}}));
    let expected = Material {
        surface: [0.5, 1.0, 0.0, 1.0],
        specular: [0.5, 1.0, 2.0, 0.75],
        interior: [0.0, 0.0, 0.0, 1.8],
        ..base
    };
    assert_eq!(tinted, expected);
    let glass = |volume: Value| {
        converted(json!({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": volume}}))
    };
    let pane = Material { surface: [0.0, 0.0, 1.0, 1.0], specular: [1.0; 4], ..base };
    assert_eq!(glass(json!({"attenuationDistance": 2, "attenuationColor": [0, 0, 0]})), pane);
    assert_eq!(glass(json!({"thicknessFactor": 1})), Material { flags: Material::VOLUME, ..pane });
    let amber = glass(json!({"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0]}));
    let expected = [0.0, 0.5 * std::f32::consts::LN_2, 0.5 * float::ln(1e6), 1.5];
    assert!(amber.interior.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{:?}", amber.interior);
    // Without transmission a volume has no inside that could be seen.
    let solid = converted(lambert(json!({"extensions": {"KHR_materials_volume": {"thicknessFactor": 1}}})));
    assert_eq!(solid, Material::lambert([0.1, 0.2, 0.3]));
    let coated = converted(lambert(json!({"extensions": {"KHR_materials_clearcoat":
        {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25}}})));
    assert_eq!(coated, Material { coat: [0.5, 0.25, 1.0, 0.0], ..Material::lambert([0.1, 0.2, 0.3]) });
    assert_eq!(coated.lobes(), Lobes::DIFFUSE | Lobes::COAT);
    let unlit = converted(lambert(json!({"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_unlit": {}}})));
    assert_eq!(unlit, Material { flags: Material::UNLIT, ..Material::lambert([0.1, 0.2, 0.3]) });
}

#[test]
fn factors_that_mean_nothing_are_clamped_by_name_or_refused() {
    let pbr = |key: &str, value: Value| json!({"pbrMetallicRoughness": {key: value}});
    let extension = |name: &str, fields: Value| json!({"extensions": {name: fields}});
    let transmitting = |name: &str, fields: Value| {
        json!({"pbrMetallicRoughness": {"metallicFactor": 0},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, name: fields}})
    };
    for (material, place, what) in [
        (pbr("metallicFactor", json!(2)), "/pbrMetallicRoughness/metallicFactor", "clamped"),
        (pbr("roughnessFactor", json!(-1)), "/pbrMetallicRoughness/roughnessFactor", "clamped"),
        (
            extension("KHR_materials_transmission", json!({"transmissionFactor": 1.5})),
            "/extensions/KHR_materials_transmission/transmissionFactor",
            "clamped",
        ),
        (transmitting("KHR_materials_ior", json!({"ior": 0.5})), "/extensions/KHR_materials_ior/ior", "clamped"),
        (
            transmitting("KHR_materials_volume", json!({"thicknessFactor": 1, "attenuationColor": [2, 1, 1]})),
            "/extensions/KHR_materials_volume/attenuationColor",
            "clamped",
        ),
        (
            transmitting("KHR_materials_volume", json!({"thicknessFactor": -1})),
            "/extensions/KHR_materials_volume/thicknessFactor",
            "read as 0",
        ),
        (
            transmitting("KHR_materials_specular", json!({"specularColorFactor": [1, -1, 1]})),
            "/extensions/KHR_materials_specular/specularColorFactor",
            "read as 0",
        ),
    ] {
        let loaded = with_material(material).load().unwrap();
        assert_eq!(warned(&loaded, what), Some(&*format!("/materials/0{place}")), "{:?}", loaded.warnings);
        let m = &loaded.data.materials[0];
        let unit = m.surface.iter().all(|x| (0.0..=1.0).contains(x));
        assert!(unit && m.interior[3] >= 1.0 && m.interior[..3].iter().all(|a| *a >= 0.0), "{m:?}");
    }
    let infinite = with_material(transmitting("KHR_materials_ior", json!({"ior": 0}))).load().unwrap();
    assert!(infinite.warnings.is_empty() && infinite.data.materials[0].interior[3] > 1e3);
    for (ior, expected) in [(-1.5, 1.0), (-1e-30, 1.0), (1e-30, 1.0), (1e30, 1e4), (0.999, 1.0)] {
        let loaded = with_material(transmitting("KHR_materials_ior", json!({"ior": ior}))).load().unwrap();
        assert_eq!(warned(&loaded, "clamped"), Some("/materials/0/extensions/KHR_materials_ior/ior"), "{ior}");
        assert_eq!(loaded.data.materials[0].interior[3].to_bits(), f32::to_bits(expected), "{ior}");
    }
    for (material, place) in [
        (pbr("metallicFactor", json!(1e300)), "/pbrMetallicRoughness/metallicFactor"),
        (json!({"normalTexture": {"index": 0, "scale": 1e300}}), "/normalTexture/scale"),
        (json!({"alphaMode": "MASK", "alphaCutoff": 1e300}), "/alphaCutoff"),
        (transmitting("KHR_materials_ior", json!({"ior": 1e300})), "/extensions/KHR_materials_ior/ior"),
        (
            transmitting("KHR_materials_volume", json!({"thicknessFactor": 1, "attenuationDistance": 0})),
            "/extensions/KHR_materials_volume/attenuationDistance",
        ),
        (extension("KHR_materials_clearcoat", json!({"clearcoatFactor": "x"})), "/extensions/KHR_materials_clearcoat"),
        (extension("KHR_materials_clearcoat", json!([])), "/extensions/KHR_materials_clearcoat"),
        (
            extension("KHR_materials_clearcoat", json!({"clearcoatFactor": 1e300})),
            "/extensions/KHR_materials_clearcoat/clearcoatFactor",
        ),
        (
            extension("KHR_materials_clearcoat", json!({"clearcoatFactor": 1, "clearcoatTexture": {"index": 99}})),
            "/textures/99",
        ),
    ] {
        let mut file = with_material(material.clone());
        file.push("images", json!({"uri": "missing.png"}));
        file.push("textures", json!({"source": 0}));
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains(&format!("{place}:")) && error.lines().count() == 1, "{material}: {error}");
    }
}

#[test]
fn what_cannot_be_seen_is_not_even_read() {
    // The images do not exist: reading one would be an error.
    let missing = json!({"index": 0});
    for material in [
        json!({"pbrMetallicRoughness": {"metallicFactor": 0, "metallicRoughnessTexture": missing},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0, "specularTexture": missing}}}),
        json!({"emissiveTexture": missing}),
        json!({"occlusionTexture": missing}),
        json!({"extensions": {"KHR_materials_transmission": {"transmissionTexture": missing}}}),
        json!({"extensions": {"KHR_materials_clearcoat": {"clearcoatTexture": missing}}}),
        json!({"extensions": {"KHR_materials_unlit": {}}, "normalTexture": missing}),
    ] {
        let mut file = with_material(material);
        file.push("images", json!({"uri": "missing.png"}));
        file.push("textures", json!({"source": 0}));
        let loaded = file.load().unwrap();
        assert_eq!((loaded.info.images, loaded.data.textures.len()), (0, 0));
    }
}

#[test]
fn an_emission_texture_keeps_normals_unless_it_is_black() {
    for (level, emits) in [(200, true), (0, false)] {
        let mut file = with_material(lambert(json!({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}})));
        let view = file.view(&common::png(1, 1, &[level, level, level, 255]));
        file.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
        file.push("textures", json!({"source": 0}));
        let normal = file.vec3(&[[0.0, 0.6, 0.8]; 3]);
        let uv = file.vec2(&[[0.0; 2]; 3]);
        file.json["meshes"][0]["primitives"][0]["attributes"] =
            json!({"POSITION": 0, "NORMAL": normal, "TEXCOORD_0": uv});
        let loaded = file.load().unwrap();
        assert_eq!(loaded.data.materials[0].emits(), emits);
        assert_eq!(loaded.data.emits(0), emits);
        assert!(!loaded.data.triangle_shading[0].is_flat(), "surfaces with lit spots stay smooth");
        assert_eq!(loaded.warnings, []);
    }
}
