//! Images, and how textures read them.

mod common;

use common::{F32, Gltf, U16, load_in, png, warned};
use pt_integrator::scene::{Material, NONE, Texture, Wrap};
use serde_json::{Value, json};

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

/// A material that reads one image in several ways.
fn many_readers() -> Gltf {
    let mut file = textured(json!({"mimeType": "image/png"}));
    let view = file.view(&png(2, 2, &TEXELS));
    file.json["images"][0]["bufferView"] = json!(view);
    file.push("textures", json!({"source": 0, "sampler": 0}));
    let turned = json!({"KHR_texture_transform": {"offset": [0.25, 0.5], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 0}});
    file.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0, "texCoord": 1},
            "metallicRoughnessTexture": {"index": 1, "texCoord": 1},
        },
        "normalTexture": {"index": 0, "texCoord": 1, "scale": 0.5, "extensions": turned},
        "emissiveTexture": {"index": 1, "texCoord": 1}, "emissiveFactor": [1, 2, 3],
        "extensions": {
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 0, "texCoord": 7}},
        },
    });
    file
}

#[test]
fn readers_of_an_image_share_its_texels() {
    let loaded = many_readers().load().unwrap();
    assert_eq!((loaded.data.texels.len(), loaded.info.images), (4, 1));
    let wraps = Texture::wrap_word(Wrap::Clamp, Wrap::Mirror);
    let places = &loaded.data.materials[0].textures;
    let texture = |place: usize| loaded.data.textures[places[place] as usize];
    // Colours are sRGB-encoded, data are not; what is read alike is one texture.
    assert_eq!(texture(Material::BASE_COLOR).flags, wraps);
    assert_eq!(places[Material::EMISSION], places[Material::BASE_COLOR]);
    assert_eq!(texture(Material::METALLIC_ROUGHNESS).flags, wraps | Texture::LINEAR);
    assert_eq!(texture(Material::NORMAL).flags, wraps | Texture::LINEAR | Texture::SECOND_UV);
    assert_eq!(loaded.data.textures.len(), 3);
    assert!(loaded.data.textures.iter().all(|t| (t.first_texel, t.width, t.height) == (0, 2, 2)));
    // The base colour's set is the first; a third is left out, by name.
    assert_eq!(places[Material::CLEARCOAT], NONE);
    let third = warned(&loaded, "third set");
    assert_eq!(third, Some("/materials/0/extensions/KHR_materials_clearcoat/clearcoatTexture"));
    assert_eq!(loaded.data.triangle_shading[0].uv, [[0.0, 0.5], [1.0, 0.0], [2.0, -1.0]]);
    assert_eq!(loaded.data.uv2, [[[9.0; 2]; 3]]);
    assert!((loaded.data.materials[0].surface[3] - 0.5).abs() < 1e-9);
}

#[test]
fn coordinates_are_scaled_turned_and_moved() {
    let loaded = many_readers().load().unwrap();
    let texture = loaded.data.textures[loaded.data.materials[0].textures[Material::NORMAL] as usize];
    let map = |u: f32, v: f32| texture.uv_rows.map(|r| r[0] * u + r[1] * v + r[2]);
    // A quarter turn counter-clockwise, in a picture whose v points down, takes +u to −v.
    for (from, to) in [([0.0, 0.0], [0.25, 0.5]), ([1.0, 0.0], [0.25, -1.5]), ([0.0, 1.0], [3.25, 0.5])] {
        let found = map(from[0], from[1]);
        assert!(found.iter().zip(to).all(|(a, b)| (a - b).abs() < 1e-6), "{from:?}: {found:?} {to:?}");
    }
    for (key, value) in [("offset", json!([1e300, 0])), ("rotation", json!(1e300)), ("scale", json!("x"))] {
        let mut file = many_readers();
        file.json["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"][key] = value;
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains("/materials/0/normalTexture/extensions/KHR_texture_transform"), "{error}");
    }
}

#[test]
fn threads_change_nothing() {
    let mut file = Gltf::triangle();
    let mut primitives = Vec::new();
    for i in 0..9_u8 {
        let side = 1 + u32::from(i) * 7;
        let rgba: Vec<u8> = (0..side * side * 4).map(|k| (k as u8).wrapping_mul(i + 3)).collect();
        let view = file.view(&png(side, side, &rgba));
        let image = json!({"bufferView": view, "mimeType": "image/png"});
        let material = file.textured_material(image, json!({}), 0);
        primitives.push(json!({"attributes": {"POSITION": 0}, "material": material}));
    }
    file.json["meshes"][0]["primitives"] = json!(primitives);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.glb");
    std::fs::write(&path, file.glb()).unwrap();
    let load = |threads: usize| {
        let mut options = scene::LoadOptions::default();
        options.threads = threads;
        let steps = std::sync::Mutex::new(Vec::new());
        let tell = |p: scene::Progress| steps.lock().unwrap().push(p);
        let loaded = scene::load_with_progress(path.to_str().unwrap(), &options, &tell).unwrap();
        (loaded, steps.into_inner().unwrap())
    };
    let (one, _) = load(1);
    for threads in [0, 2, 3, 16] {
        let (loaded, steps) = load(threads);
        assert_eq!(loaded.data, one.data);
        for what in ["textures", "triangles"] {
            let of_step: Vec<_> = steps.iter().filter(|p| p.what == what).collect();
            assert!(of_step.is_sorted_by_key(|p| p.done), "{of_step:?}");
            assert!(of_step.first().is_some_and(|p| p.done == 0 && p.total > 0), "{of_step:?}");
            assert!(of_step.last().is_some_and(|p| p.done == p.total), "{of_step:?}");
        }
    }
    // Of several broken images the first is named, whoever meets his first.
    for broken in [2, 5] {
        let offset = file.json["bufferViews"][broken + 1]["byteOffset"].as_u64().unwrap() as usize;
        file.bin[offset + 40..offset + 60].fill(0xaa);
    }
    std::fs::write(&path, file.glb()).unwrap();
    for _ in 0..8 {
        let error = scene::load(path.to_str().unwrap(), &scene::LoadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("/images/2"), "{error}");
    }
}

#[test]
fn interlaced_and_palette_images_load() {
    // 3 × 3 texels, palette of black and half-transparent red, written bit by bit.
    let mut encoder_out = Vec::new();
    let mut encoder = png::Encoder::new(&mut encoder_out, 3, 3);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
    encoder.set_trns(vec![255, 128]);
    encoder.write_header().unwrap().write_image_data(&[0b0100_0000, 0b1010_0000, 0b0000_0000]).unwrap();
    let mut file = textured(json!({"mimeType": "image/png"}));
    let view = file.view(&encoder_out);
    file.json["images"][0]["bufferView"] = json!(view);
    let (black, red) = (0xff00_0000, 0x8000_00ff);
    assert_eq!(file.load().unwrap().data.texels, [black, red, black, red, black, red, black, black, black]);
    // Interlaced, which the encoder cannot write: 2 × 2 grey pixels 10, 20 / 30, 40 in three passes, stored unpacked.
    let adam7 = [137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 2, 0, 0, 0, 2, 8, 0, 0, 0, 1];
    let raw = [0, 10, 0, 20, 0, 30, 40];
    let mut bytes = adam7.to_vec();
    bytes.extend(common::crc32(&adam7[12..]).to_be_bytes());
    let mut zlib = vec![0x78, 0x01, 1, raw.len() as u8, 0, !(raw.len() as u8), 0xff];
    zlib.extend(raw);
    let (a, b) = raw.iter().fold((1_u32, 0_u32), |(a, b), &x| (a + u32::from(x), a + u32::from(x) + b));
    zlib.extend((b << 16 | a).to_be_bytes());
    common::png_chunk(&mut bytes, *b"IDAT", &zlib);
    common::png_chunk(&mut bytes, *b"IEND", &[]);
    let view = file.view(&bytes);
    file.json["images"][0]["bufferView"] = json!(view);
    let gray = |l: u32| 0xff00_0000 | l << 16 | l << 8 | l;
    assert_eq!(file.load().unwrap().data.texels, [gray(10), gray(20), gray(30), gray(40)]);
}

#[test]
fn other_formats_are_refused_by_name() {
    for (bytes, name) in [
        (b"\xabKTX 20\xbb\r\n\x1a\n and more".to_vec(), "KTX2"),
        (b"RIFF\x10\0\0\0WEBPVP8L".to_vec(), "WebP"),
        (b"sB\x13\0".to_vec(), "Basis Universal"),
        (b"DDS |".to_vec(), "DDS"),
        (b"\0\0\0\x1cftypavif".to_vec(), "AVIF"),
    ] {
        let mut file = textured(json!({"mimeType": "image/png"}));
        let view = file.view(&bytes);
        file.json["images"][0]["bufferView"] = json!(view);
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("/images/0") && error.contains("convert the image"), "{error}");
    }
    // Only an extension has an image.
    let mut file = textured(json!({"mimeType": "image/png"}));
    file.json["textures"][0] = json!({"extensions": {"KHR_texture_basisu": {"source": 0}}});
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("/textures/0: has no PNG or JPEG image, only KHR_texture_basisu"), "{error}");
    file.json["textures"][0] = json!({});
    assert!(file.load().unwrap_err().to_string().contains("/textures/0: has no image"));
    // Both: the image that can be read is, and the other is named.
    let view = file.view(&png(2, 2, &TEXELS));
    file.json["images"][0]["bufferView"] = json!(view);
    file.json["textures"][0] = json!({"source": 0, "extensions": {"EXT_texture_webp": {"source": 0}}});
    let loaded = file.load().unwrap();
    assert_eq!(warned(&loaded, "EXT_texture_webp"), Some("/textures/0/extensions/EXT_texture_webp"));
    assert_eq!(loaded.data.texels.len(), 4);
}

#[test]
fn tangents_are_named_where_a_normal_map_would_read_them() {
    for map in ["normalTexture", "baseColorTexture"] {
        let mut file = textured(json!({"mimeType": "image/png"}));
        let view = file.view(&png(2, 2, &TEXELS));
        file.json["images"][0]["bufferView"] = json!(view);
        let tangents = file.accessor(bytemuck::cast_slice(&[[1.0_f32, 0.0, 0.0, 1.0]; 3]), F32, "VEC4", 3);
        file.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(tangents);
        if map == "normalTexture" {
            file.json["materials"][0][map] = json!({"index": 0, "texCoord": 1});
        }
        let loaded = file.load().unwrap();
        let place = (map == "normalTexture").then_some("/meshes/0/primitives/0/attributes/TANGENT");
        assert_eq!(warned(&loaded, "TANGENT"), place, "{:?}", loaded.warnings);
        assert_eq!(warned(&loaded, "frame of their texture coordinates"), place);
    }
}
