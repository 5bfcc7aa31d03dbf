//! Files that are broken or mean harm: each gives one line with file, place and advice, and nothing else happens.

mod common;

use std::time::{Duration, Instant};

use common::{F32, Gltf, U16, U32, load_bytes, png};
use scene::{LoadOptions, SceneError};
use serde_json::{Value, json};

/// The error of a file, after checking what all errors have in common.
fn error_of(name: &str, bytes: &[u8]) -> String {
    let start = Instant::now();
    let error = load_bytes(name, bytes).expect_err("must be refused").to_string();
    assert!(start.elapsed() < Duration::from_secs(1), "took {:?}: {error}", start.elapsed());
    assert_eq!(error.lines().count(), 1, "{error:?}");
    assert!(!error.chars().any(char::is_control), "{error:?}");
    assert!(error.contains(name), "{error}");
    assert!(error.contains(';'), "no advice: {error}");
    assert!(error.len() < 600, "{error}");
    error
}

/// Expects `change` to make a good triangle fail at `place` with `what`.
#[track_caller]
fn refused(change: impl FnOnce(&mut Gltf), place: &str, what: &str) {
    let mut file = Gltf::triangle();
    change(&mut file);
    let error = error_of("scene.glb", &file.glb());
    assert!(error.contains(&format!("{place}:")) && error.contains(what), "{error}");
}

#[test]
fn no_such_file_or_format() {
    for (source, what) in [
        ("/nonexistent/scene.gltf", "cannot be read"),
        ("scene.obj", "neither .gltf, .glb nor builtin:NAME"),
        ("", "neither .gltf"),
        (
            "builtin:teapot\n",
            "there are builtin:cornell, builtin:furnace, builtin:interior, builtin:thin-wall, builtin:instances",
        ),
        ("builtin:", "no such built-in scene"),
    ] {
        let error = scene::load(source, &LoadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(what) && error.lines().count() == 1, "{error}");
    }
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("folder.gltf");
    std::fs::create_dir(&folder).unwrap();
    let error = scene::load(folder.to_str().unwrap(), &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("not a regular file"), "{error}");
}

#[test]
fn not_gltf() {
    for (bytes, what) in [
        (&b""[..], "line 1, column 0"),
        (b"{", "not glTF"),
        (b"{}", "missing field `asset`"),
        (b"\xff\xfe", "not glTF"),
        (br#"{"asset":{"version":"1.0"}}"#, "/asset/version"),
        (br#"{"asset":{"version":"2.0"}}"#, "holds no triangles"),
        (br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}]}"#, "holds no triangles"),
        (br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}]}"#, "/scenes/0/nodes/0: points to something"),
    ] {
        let error = error_of("scene.gltf", bytes);
        assert!(error.contains(what), "{error}");
    }
    let deep = format!("{{\"asset\":{}", "[".repeat(1_000_000));
    assert!(error_of("scene.gltf", deep.as_bytes()).contains("not glTF"));
    let mut marked = b"\xef\xbb\xbf".to_vec();
    marked.extend(br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}]}"#);
    assert!(error_of("scene.gltf", &marked).contains("holds no triangles"));
}

#[test]
fn glb_containers() {
    let good = Gltf::triangle().glb();
    let word = |i: usize, value: u32| {
        let mut file = good.clone();
        file[i..i + 4].copy_from_slice(&value.to_le_bytes());
        file
    };
    let text = u32::from_le_bytes(good[12..16].try_into().unwrap());
    let bin = 20 + text as usize;
    for (bytes, what) in [
        (good[..8].to_vec(), "the file ends in it"),
        (good[..16].to_vec(), "bytes announced"),
        (good[..good.len() - 1].to_vec(), "bytes announced"),
        (word(4, 1), "GLB version 1"),
        (word(8, 0), "0 bytes announced"),
        (word(8, 11), "11 bytes announced"),
        (word(8, 12), "reach beyond the file"),
        (word(8, u32::MAX), "4294967295 bytes announced"),
        (word(12, u32::MAX), "the chunk at byte 12: its 4294967295 bytes reach beyond"),
        (word(12, 0), "the chunk at byte 20"),
        (word(16, 0), "the first chunk: is not JSON"),
        (word(bin, u32::MAX), "reach beyond the file"),
        (word(bin, 8), "/buffers/0: 36 bytes announced, 8 there"),
        (word(bin + 4, 0), "/buffers/0: has no bytes"),
    ] {
        let error = error_of("scene.glb", &bytes);
        assert!(error.contains(what), "{what}: {error}");
    }
    // Every truncation is refused, and none panics.
    for length in 0..good.len() {
        error_of("scene.glb", &good[..length]);
    }
}

#[test]
fn buffers() {
    let buffer = |value: Value| move |f: &mut Gltf| f.json["buffers"] = json!([value]);
    refused(buffer(json!({"byteLength": 1 << 20})), "/buffers/0", "1048576 bytes announced, 36 there");
    refused(buffer(json!({"byteLength": u64::MAX})), "/buffers/0", "the limit is 4294967296");
    refused(buffer(json!({"byteLength": 36, "uri": "a.bin"})), "/buffers/0/uri", "cannot be read");
    refused(buffer(json!({"byteLength": 36, "uri": "../a.bin"})), "/buffers/0/uri", "leaves the scene's folder");
    refused(buffer(json!({"byteLength": 36, "uri": "/dev/zero"})), "/buffers/0/uri", "leaves the scene's folder");
    refused(buffer(json!({"byteLength": 36, "uri": "http://x/a"})), "/buffers/0/uri", "only relative paths");
    refused(buffer(json!({"byteLength": 36, "uri": "data:;base64,AAAA"})), "/buffers/0", "3 there");
    refused(buffer(json!({"byteLength": 36, "uri": "data:;base64,????"})), "/buffers/0/uri", "not base64");
    refused(buffer(json!({"byteLength": 36, "uri": "x".repeat(1 << 20)})), "/buffers/0/uri", "cannot be read");
    refused(|f| f.json["buffers"] = json!([{"byteLength": 36}, {"byteLength": 1}]), "/buffers/1", "has no bytes");
    refused(|f| f.json["bufferViews"][0]["buffer"] = json!(7), "/bufferViews/0/buffer", "does not exist");
    refused(|f| f.json["bufferViews"][0]["byteOffset"] = json!(1), "/bufferViews/0", "outside the buffer");
    refused(|f| f.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX), "/bufferViews/0", "outside the buffer");
    refused(|f| f.json["bufferViews"][0]["byteLength"] = json!(u64::MAX), "/bufferViews/0", "outside the buffer");
    refused(|f| f.json["bufferViews"][0]["byteStride"] = json!(3), "/bufferViews/0/byteStride", "does not know");
    refused(|f| f.json["bufferViews"][0]["byteStride"] = json!(8), "/accessors/0", "overlap");
    let missing = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "buffers": [{"byteLength": 4}]});
    assert!(error_of("scene.gltf", missing.to_string().as_bytes()).contains("/buffers/0: has no bytes"));
}

#[test]
fn accessors() {
    let set = |key: &'static str, value: Value| move |f: &mut Gltf| f.json["accessors"][0][key] = value;
    for count in [4_u64, 1 << 32, 1 << 61, u64::MAX / 12, u64::MAX] {
        refused(set("count", json!(count)), "/accessors/0", "reach beyond their view");
    }
    refused(set("byteOffset", json!(4)), "/accessors/0", "reach beyond their view");
    refused(set("byteOffset", json!(u64::MAX)), "/accessors/0", "reach beyond their view");
    refused(set("bufferView", json!(9)), "/accessors/0/bufferView", "does not exist");
    refused(set("bufferView", Value::Null), "/accessors/0/bufferView", "is missing");
    refused(set("componentType", json!(1)), "/accessors/0/componentType", "does not know");
    refused(set("type", json!("VEC9")), "/accessors/0/type", "does not know");
    refused(set("type", json!("SCALAR")), "/accessors/0", "expected");
    let sparse = json!({"count": 1, "indices": {"bufferView": 0, "componentType": 5123}, "values": {"bufferView": 0}});
    refused(set("sparse", sparse), "/accessors/0", "is sparse");
    refused(set("count", json!(0)), "scene.glb", "holds no triangles");
    // Bounds in the file are not trusted, nor even read.
    let mut file = Gltf::triangle();
    file.json["accessors"][0]["min"] = json!([9, 9, 9]);
    file.json["accessors"][0].as_object_mut().unwrap().remove("max");
    file.load().unwrap();
}

#[test]
fn indices_and_attributes() {
    let indices = |list: &'static [u16]| {
        move |f: &mut Gltf| {
            let a = f.indices(list);
            f.json["meshes"][0]["primitives"][0]["indices"] = json!(a);
        }
    };
    refused(indices(&[0, 1, 3]), "/accessors/1", "index 2 is 3, there are 3 vertices");
    refused(indices(&[0, 1, 65535]), "/accessors/1", "index 2 is 65535");
    refused(indices(&[0, 1]), "scene.glb", "holds no triangles");
    let typed = |component: u32, kind: &'static str| {
        move |f: &mut Gltf| {
            let a = f.accessor(&[0; 24], component, kind, 3);
            f.json["meshes"][0]["primitives"][0]["indices"] = json!(a);
        }
    };
    refused(typed(F32, "SCALAR"), "/accessors/1", "unsigned integers");
    refused(typed(U16, "VEC2"), "/accessors/1", "expected");
    let attribute = |name: &'static str, value: u64| {
        move |f: &mut Gltf| f.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(value)
    };
    refused(attribute("POSITION", 5), "/meshes/0/primitives/0/attributes/POSITION", "does not exist");
    refused(attribute("NORMAL", 5), "/meshes/0/primitives/0/attributes/NORMAL", "does not exist");
    refused(attribute("TANGENT", 5), "/meshes/0/primitives/0/attributes/TANGENT", "does not exist");
    refused(
        |f| f.json["meshes"][0]["primitives"][0]["attributes"] = json!({}),
        "/meshes/0/primitives/0/attributes/POSITION",
        "is missing",
    );
    refused(
        |f| f.json["meshes"][0]["primitives"][0]["material"] = json!(0),
        "/meshes/0/primitives/0/material",
        "does not exist",
    );
    refused(
        |f| f.json["meshes"][0]["primitives"][0]["mode"] = json!(9),
        "/meshes/0/primitives/0/mode",
        "does not know",
    );
    let short = |f: &mut Gltf| {
        let normal = f.vec3(&[[0.0, 0.0, 1.0]; 2]);
        f.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    };
    refused(short, "/meshes/0/primitives/0/attributes/NORMAL", "2 entries for 3 vertices");
}

#[test]
fn positions_that_are_not_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refused(
            |f| f.bin[16..20].copy_from_slice(&bad.to_le_bytes()),
            "/accessors/0",
            "vertex 1 has a coordinate that is not finite",
        );
    }
    refused(|f| f.bin[16..20].copy_from_slice(&f32::MAX.to_le_bytes()), "/nodes", "wider than");
}

#[test]
fn nodes() {
    let set = |key: &'static str, value: Value| move |f: &mut Gltf| f.json["nodes"][0][key] = value;
    refused(set("children", json!([0])), "/nodes/0", "reached twice");
    refused(set("children", json!([1])), "/nodes/0/children/0", "does not exist");
    refused(set("mesh", json!(1)), "/nodes/0/mesh", "does not exist");
    refused(set("camera", json!(0)), "/nodes/0/camera", "does not exist");
    refused(set("scale", json!([1e300, 1, 1])), "/nodes/0", "not finite");
    let short = error_of("scene.gltf", br#"{"asset":{"version":"2.0"},"nodes":[{"translation":[1,2]}]}"#);
    assert!(short.contains("line 1, column 56: not glTF: invalid length 2"), "{short}");
    refused(set("rotation", json!([0, 0, 0, 0])), "/nodes/0", "length 0");
    refused(set("matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])), "/nodes/0", "not affine");
    refused(set("matrix", json!([1e300, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])), "/nodes/0", "not finite");
    refused(|f| f.json["scenes"][0]["nodes"] = json!([0, 0]), "/nodes/0", "reached twice");
    refused(|f| f.json["scene"] = json!(3), "/scene", "does not exist");
    let cycle = |f: &mut Gltf| {
        f.json["nodes"] = json!([{"children": [1]}, {"children": [2]}, {"children": [0], "mesh": 0}]);
    };
    refused(cycle, "/nodes/0", "reached twice");
    // Two children shared by each of 40 levels would be 2^40 nodes.
    let lattice = |f: &mut Gltf| {
        let mut nodes = vec![json!({"mesh": 0})];
        for i in 0..40 {
            nodes.push(json!({"children": [i, i]}));
        }
        f.json["nodes"] = json!(nodes);
        f.json["scenes"][0]["nodes"] = json!([40]);
    };
    refused(lattice, "/nodes/0", "reached twice");
    let huge = |f: &mut Gltf| {
        let nodes: Vec<_> = (0..20).map(|i| json!({"children": [i + 1], "scale": [1e30, 1, 1]})).collect();
        f.json["nodes"] = json!(nodes);
        f.json["nodes"][19] = json!({"mesh": 0});
    };
    refused(huge, "/nodes/10", "overflows");
}

#[test]
fn a_deep_chain_of_nodes_is_no_problem() {
    let mut file = Gltf::triangle();
    let depth = 100_000;
    let mut nodes: Vec<_> = (1..depth).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"mesh": 0}));
    file.json["nodes"] = json!(nodes);
    assert_eq!(file.load().unwrap().info.triangles, 1);
}

#[test]
fn extensions_that_are_required() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "ACME_x\ny"] {
        let required = |f: &mut Gltf| f.json["extensionsRequired"] = json!(["KHR_materials_specular", name]);
        let shown = name.replace('\n', "\\n");
        refused(required, "/extensionsRequired/1", &shown);
    }
}

#[test]
fn cameras_and_materials() {
    for yfov in [0.0, -1.0, 3.2, 1e300] {
        let camera = |f: &mut Gltf| {
            f.push("cameras", json!({"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.1}}));
            f.node(json!({"camera": 0}));
        };
        refused(camera, "/cameras/0", "field of view");
    }
    let flat = |f: &mut Gltf| {
        f.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}));
        f.node(json!({"camera": 0, "scale": [1, 0, 1]}));
    };
    refused(flat, "/cameras/0", "span space");
    let material = |value: Value| {
        move |f: &mut Gltf| {
            f.push("materials", value);
            f.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        }
    };
    refused(material(json!({"emissiveFactor": [-1, 0, 0]})), "/materials/0/emissiveFactor", "radiance");
    refused(material(json!({"emissiveFactor": [1e300, 0, 0]})), "/materials/0/emissiveFactor", "radiance");
    let factor = json!({"pbrMetallicRoughness": {"baseColorFactor": [1e300, 0, 0, 1]}});
    refused(material(factor), "/materials/0/pbrMetallicRoughness/baseColorFactor", "not finite");
    let bright = json!({"pbrMetallicRoughness": {"baseColorFactor": [2, -1, 0.5, 1]}});
    let mut file = Gltf::triangle();
    material(bright)(&mut file);
    let loaded = file.load().unwrap();
    assert_eq!(loaded.data.materials[0].base_color[..3], [1.0, 0.0, 0.5]);
    assert!(common::warned(&loaded, "are clamped").is_some());
}

#[test]
fn images() {
    let image = |bytes: Vec<u8>| {
        move |f: &mut Gltf| {
            let view = f.view(&bytes);
            f.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({}), 0);
            f.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        }
    };
    let good = png(2, 2, &[200; 16]);
    let mut wide = good.clone();
    wide[16..24].copy_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0]);
    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(8, 8).write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
    let mut jpeg = jpeg.into_inner();
    // The frame's height and width, 65500 each: 4.3 gigatexels in a few hundred bytes.
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff, 0xdc, 0xff, 0xdc]);
    refused(image(jpeg), "/images/0", "65500x65500 pixels cannot be in");
    let mut huge = good.clone();
    huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    for file in [&mut wide, &mut huge] {
        let sum = common::crc32(&file[12..29]);
        file[29..33].copy_from_slice(&sum.to_be_bytes());
    }
    refused(image(vec![]), "/images/0", "neither PNG nor JPEG");
    refused(image(b"GIF89a".to_vec()), "/images/0", "neither PNG nor JPEG");
    refused(image(good[..good.len() / 2].to_vec()), "/images/0", "no usable PNG");
    refused(image(vec![0xff, 0xd8, 0xff, 0xe0]), "/images/0", "no usable PNG");
    refused(image(wide), "/images/0", "16384x16384 pixels cannot be in");
    refused(image(huge), "/images/0", "cannot be in");
    let uri = |uri: &'static str| {
        move |f: &mut Gltf| {
            f.textured_material(json!({"uri": uri}), json!({}), 0);
            f.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        }
    };
    refused(uri("a.png"), "/images/0/uri", "cannot be read");
    refused(uri("../a.png"), "/images/0/uri", "leaves the scene's folder");
    refused(uri("data:image/png;base64,AAAA"), "/images/0", "neither PNG nor JPEG");
    let none = |f: &mut Gltf| {
        f.textured_material(json!({}), json!({}), 0);
        f.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    };
    refused(none, "/images/0", "neither uri nor bufferView");
}

#[test]
fn limits_hold() {
    let mut file = Gltf::triangle();
    let indices = file.accessor(&[0; 12 * 4], U32, "SCALAR", 12);
    file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.glb");
    std::fs::write(&path, file.glb()).unwrap();
    let load = |change: &dyn Fn(&mut LoadOptions)| {
        let mut options = LoadOptions::default();
        change(&mut options);
        scene::load(path.to_str().unwrap(), &options)
    };
    assert!(load(&|o| o.max_triangles = 4).is_ok());
    let pictured = {
        let mut file = Gltf::triangle();
        let mut primitives = Vec::new();
        for _ in 0..3 {
            let view = file.view(&png(4, 4, &[7; 64]));
            let material = file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({}), 0);
            primitives.push(json!({"attributes": {"POSITION": 0}, "material": material}));
        }
        file.json["meshes"][0]["primitives"] = json!(primitives);
        file
    };
    std::fs::write(&path, pictured.glb()).unwrap();
    assert!(load(&|o| o.max_texels = 48).is_ok());
    let error = load(&|o| o.max_texels = 47).unwrap_err().to_string();
    assert!(error.contains("/images/2: 16 more texels, the limit is 47") && error.contains("max_texels"), "{error}");
    std::fs::write(&path, file.glb()).unwrap();
    for error in [load(&|o| o.max_triangles = 3), load(&|o| o.max_bytes = 100)] {
        let error = error.unwrap_err();
        assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
        assert_eq!(error.to_string().lines().count(), 1);
    }
    // A thousand primitives that share one accessor announce more than the file holds: counted before anything is made.
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": indices});
    file.json["meshes"][0]["primitives"] = json!(vec![primitive; 1000]);
    std::fs::write(&path, file.glb()).unwrap();
    let error = load(&|o| o.max_triangles = 3999).unwrap_err().to_string();
    assert!(error.contains("4000 triangles") && error.contains("max_triangles"), "{error}");
}
