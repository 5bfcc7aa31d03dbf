//! Materials, textures, cameras and what is warned of.
#![expect(clippy::needless_pass_by_value, reason = "`json!` gives values")]

mod common;

use common::{Gltf, U16, load_in, png, warned};
use pt_integrator::scene::{Material, NONE, Texture, Wrap};
use scene::SceneError;
use scene::glam::{DVec3, Vec3};
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
    assert_eq!(loaded.data.triangle_shading[0].emitter, NONE);
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
        assert_eq!(loaded.data.triangle_shading[0].emitter, 0);
        assert_eq!(loaded.info.emissive_triangles, 1);
        assert_eq!(loaded.warnings, []);
    }
}

#[test]
fn emitters_are_numbered_within_their_mesh() {
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
    let emitters: Vec<u32> = loaded.data.triangle_shading.iter().map(|s| s.emitter).collect();
    assert_eq!(emitters, [0, NONE, 1, 0]);
    assert_eq!(loaded.info.emissive_triangles, 4);
}

#[test]
fn what_is_not_modelled_is_named_once_with_its_place() {
    let mut file = with_material(json!({
        "normalTexture": {"index": 0}, "alphaMode": "MASK",
        "extensions": {"KHR_materials_clearcoat": {}},
    }));
    file.push("images", json!({"uri": "missing.png"}));
    file.push("textures", json!({"source": 0}));
    file.push("materials", json!({}));
    file.push("animations", json!({"channels": [], "samplers": []}));
    let colour = file.vec3(&[[1.0; 3]; 3]);
    file.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_a\nnimation", "KHR_materials_specular"]);
    file.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0, "COLOR_0": colour}, "material": 0},
        {"attributes": {"POSITION": 0}, "material": 1},
        {"attributes": {"POSITION": 0}},
    ]);
    file.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    let loaded = file.load().unwrap();
    for (text, place) in [
        ("metallic reflection", "/materials/0/pbrMetallicRoughness"),
        ("specular reflection", "/materials/0"),
        ("normal maps", "/materials/0/normalTexture"),
        ("alpha", "/materials/0/alphaMode"),
        ("KHR_materials_clearcoat", "/materials/0/extensions/KHR_materials_clearcoat"),
        ("vertex colours", "/meshes/0/primitives/0/attributes/COLOR_0"),
        ("without a material", "/meshes"),
        ("animations", "/animations"),
        ("KHR_lights_punctual", "/nodes/0/extensions/KHR_lights_punctual"),
        ("nimation is not modelled", "/extensionsUsed/1"),
    ] {
        assert_eq!(warned(&loaded, text), Some(place), "{text}: {:#?}", loaded.warnings);
        assert_eq!(loaded.warnings.iter().filter(|w| w.what.contains(text)).count(), 1, "{text}");
    }
    assert!(loaded.warnings.iter().all(|w| w.to_string().lines().count() == 1));
    assert_eq!(loaded.info.punctual_lights, 1);
}

#[test]
fn an_emissive_texture_turns_emission_off() {
    let mut file = with_material(lambert(json!({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}})));
    file.push("images", json!({"uri": "missing.png"}));
    file.push("textures", json!({"source": 0}));
    let loaded = file.load().unwrap();
    assert!(!loaded.data.materials[0].emits());
    assert_eq!(warned(&loaded, "emissive textures"), Some("/materials/0/emissiveTexture"));
}

/// Four texels: red, green / blue, half-transparent grey.
const TEXELS: [u8; 16] = [255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 128, 128, 128, 64];

/// A triangle with the texture coordinates 0…2 in set 1 and nonsense in set 0.
fn textured(image: Value) -> Gltf {
    let mut file = Gltf::triangle();
    let (zero, one) = (file.vec2(&[[9.0; 2]; 3]), file.vec2(&[[0.0, 0.5], [1.0, 0.0], [2.0, -1.0]]));
    file.textured_material(image, json!({"wrapS": 33071, "wrapT": 33648}), 1);
    file.json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0, "TEXCOORD_0": zero, "TEXCOORD_1": one}, "material": 0}]);
    file
}

#[test]
fn textures_from_buffer_views_data_uris_and_files() {
    let image = png(2, 2, &TEXELS);
    let base64 = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &image);
    let inline = textured(json!({"uri": format!("data:image/png;base64,{base64}")}));
    let mut embedded = textured(json!({"mimeType": "image/png"}));
    let view = embedded.view(&image);
    embedded.json["images"][0]["bufferView"] = json!(view);
    let beside = textured(json!({"uri": "sub/a%20b.png"}));
    for file in [inline, embedded, beside] {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir(dir.path().join("sub")).unwrap();
        std::fs::write(dir.path().join("sub/a b.png"), &image).unwrap();
        let loaded = load_in(dir.path(), "s.glb", &file.glb()).unwrap();
        assert_eq!(loaded.data.textures, [Texture::new(0, [2, 2], [Wrap::Clamp, Wrap::Mirror])]);
        assert_eq!(loaded.data.texels, [0xff00_00ff, 0xff00_ff00, 0xffff_0000, 0x4080_8080]);
        assert_eq!(loaded.data.triangle_shading[0].uv, [[0.0, 0.5], [1.0, 0.0], [2.0, -1.0]]);
        assert_eq!(loaded.data.materials[0].textures[Material::BASE_COLOR], 0);
    }
}

#[test]
fn an_image_of_two_textures_is_stored_once() {
    let mut file = textured(json!({"mimeType": "image/png"}));
    let view = file.view(&png(2, 2, &TEXELS));
    file.json["images"][0]["bufferView"] = json!(view);
    file.push("textures", json!({"source": 0}));
    file.push("materials", json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}));
    let mut second = file.json["meshes"][0]["primitives"][0].clone();
    second["material"] = json!(1);
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let loaded = file.load().unwrap();
    assert_eq!((loaded.data.textures.len(), loaded.info.images, loaded.data.texels.len()), (2, 1, 4));
    assert_eq!(loaded.data.textures[1].flags, 0);
    assert_eq!(loaded.data.triangle_shading[1].uv, [[9.0; 2]; 3]);
}

#[test]
fn jpeg_grey_and_deep_images_become_rgba8() {
    let gray = image::GrayImage::from_pixel(16, 8, image::Luma([100]));
    let deep = image::ImageBuffer::from_pixel(3, 5, image::Rgb([65535_u16, 0, 25700]));
    let cases: [(image::DynamicImage, image::ImageFormat, u32, bool); 2] = [
        (gray.into(), image::ImageFormat::Jpeg, 0xff64_6464, false),
        (deep.into(), image::ImageFormat::Png, 0xff64_00ff, true),
    ];
    for (image, format, texel, warns) in cases {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        let mut file = textured(json!({"mimeType": "image/any"}));
        let view = file.view(bytes.get_ref());
        file.json["images"][0]["bufferView"] = json!(view);
        let loaded = file.load().unwrap();
        assert_eq!(loaded.data.texels.len() as u32, image.width() * image.height());
        assert!(loaded.data.texels.iter().all(|&t| t == texel), "{:x?}", loaded.data.texels);
        assert_eq!(warned(&loaded, "16 bits").is_some(), warns);
    }
}

#[test]
fn texture_coordinates_missing_normalised_or_not_finite() {
    let mut file = textured(json!({"mimeType": "image/png"}));
    let view = file.view(&png(2, 2, &TEXELS));
    file.json["images"][0]["bufferView"] = json!(view);
    let mut missing = file.clone();
    missing.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_1");
    let loaded = missing.load().unwrap();
    assert!(warned(&loaded, "without the texture's coordinates").is_some());
    assert_eq!(loaded.data.triangle_shading[0].uv, [[0.0; 2]; 3]);

    let mut nan = file.clone();
    let set = nan.vec2(&[[f32::NAN, 0.0], [0.5, f32::INFINITY], [0.5, 0.5]]);
    nan.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(set);
    let loaded = nan.load().unwrap();
    assert_eq!(loaded.warnings.iter().find(|w| w.what.contains("not finite")).unwrap().count, 2);
    assert_eq!(loaded.data.triangle_shading[0].uv, [[0.0; 2], [0.0; 2], [0.5; 2]]);

    let words: [u16; 6] = [0, 65535, 65535, 0, 0, 0];
    let set = file.accessor(bytemuck::cast_slice(&words), U16, "VEC2", 3);
    file.json["accessors"][set]["normalized"] = json!(true);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(set);
    assert_eq!(file.load().unwrap().data.triangle_shading[0].uv, [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
}

/// A camera of 0.7 radians.
fn perspective() -> Value {
    json!({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 3.0}})
}

#[test]
fn cameras_look_along_their_nodes_minus_z() {
    let mut file = Gltf::triangle();
    file.push("cameras", perspective());
    file.push(
        "cameras",
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 2, "znear": 1}}),
    );
    let half = std::f32::consts::FRAC_1_SQRT_2;
    file.node(json!({"camera": 1}));
    file.node(json!({"name": "left", "camera": 0, "translation": [1e6, 2, 3], "scale": [2, 2, 2],
        "rotation": [0, half, 0, half]}));
    file.node(json!({"camera": 0, "name": "1"}));
    let loaded = file.load().unwrap();
    assert_eq!(warned(&loaded, "orthographic"), Some("/cameras/1"));
    assert_eq!(loaded.cameras.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(), ["left", "1"]);
    let view = &loaded.cameras[0];
    assert!(view.forward.abs_diff_eq(-DVec3::X, 1e-7) && view.right.abs_diff_eq(-DVec3::Z, 1e-7));
    assert_eq!(view.position, DVec3::new(1e6, 2.0, 3.0));
    let camera = view.camera(loaded.origin, 200, 100).unwrap();
    assert!(camera.up.abs_diff_eq(Vec3::Y, 1e-6) && (camera.fov_y - 0.7).abs() < 1e-6);
    assert_eq!((camera.width, camera.height), (200, 100));
    assert_eq!(camera.position.as_dvec3() + loaded.origin, view.position);
    // A name goes before an index.
    assert_eq!(loaded.view(Some("1")).unwrap().position, DVec3::ZERO);
    assert_eq!(loaded.view(Some("0")).unwrap().name, "left");
    assert_eq!(loaded.view(None).unwrap().name, "left");
    let error = loaded.view(Some("top\n")).unwrap_err();
    assert!(matches!(error, SceneError::UnknownCamera { .. }));
    assert_eq!(error.to_string().lines().count(), 1, "{error}");
    assert!(view.camera(loaded.origin, 0, 10).is_err());
}

#[test]
fn a_scene_without_camera_says_what_to_pass() {
    let loaded = Gltf::triangle().load().unwrap();
    let error = loaded.view(None).unwrap_err().to_string();
    assert!(error.contains("--camera FILE.json"), "{error}");
}

#[test]
fn camera_files_are_checked() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("c.json");
    let load = |text: &str| {
        std::fs::write(&path, text).unwrap();
        scene::View::from_file(&path)
    };
    let good = r#"{"position":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":90}"#;
    let view = load(good).unwrap();
    assert_eq!((view.right, view.up), (DVec3::X, DVec3::Y));
    assert!((view.fov_y - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    for (from, to) in [
        ("90", "0"),
        ("90", "180"),
        ("90", "-1"),
        ("90", "\"wide\""),
        ("90", "1e999"),
        ("[0,1,0],\"up\"", "[0,1,5],\"up\""),
        ("\"up\":[0,1,0]", "\"up\":[0,0,1]"),
        ("\"up\":[0,1,0]", "\"up\":[0,0,0]"),
        ("\"up\"", "\"upwards\""),
        ("[0,1,5]", "[0,1]"),
        ("}", ""),
        ("}", ",\"zoom\":1}"),
    ] {
        let error = load(&good.replace(from, to)).unwrap_err().to_string();
        assert!(error.contains("c.json") && error.lines().count() == 1, "{from} -> {to}: {error}");
    }
    assert!(matches!(scene::View::from_file(&dir.path().join("none.json")), Err(SceneError::Read { .. })));
}
