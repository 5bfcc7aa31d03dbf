//! Surfaces with holes.

mod common;

use common::{Gltf, png, warned};
use hashcache_core::geometry::Opacity;
use pt_integrator::scene::{Lobes, Material};
use scene::Loaded;
use serde_json::{Value, json};

/// Two triangles: one of this material, whose texture's alpha is 0 at the left and 255 at the right, and one without.
fn load(change: impl FnOnce(&mut Value)) -> Loaded {
    let mut file = Gltf::triangle();
    let view = file.view(&png(2, 1, &[9, 9, 9, 0, 9, 9, 9, 255]));
    let image = json!({"bufferView": view, "mimeType": "image/png"});
    file.textured_material(image, json!({"wrapS": 33071, "wrapT": 33071}), 0);
    change(&mut file.json["materials"][0]);
    let uv = file.vec2(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    file.push("materials", json!({}));
    file.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0, "TEXCOORD_0": uv}, "material": 0},
        {"attributes": {"POSITION": 0}, "material": 1},
    ]);
    let loaded = file.load().unwrap();
    assert_eq!(loaded.data.validate(), Ok(()));
    loaded
}

#[test]
fn a_mask_says_where_rays_pass() {
    for (mode, cutoff, passes_at) in [("MASK", 0.5, 0.5), ("MASK", 0.75, 0.625), ("BLEND", 0.5, 0.5)] {
        let loaded = load(|m| {
            m["alphaMode"] = json!(mode);
            m["alphaCutoff"] = json!(cutoff);
        });
        let opacity = loaded.data.opacity.view();
        assert_eq!(opacity.mask_of_triangle, [0, Opacity::NO_MASK]);
        assert_eq!((opacity.masks.len(), opacity.alpha), (1, &[0, 255][..]));
        // Bilinear from 0 at u = 1/4 to 1 at u = 3/4.
        for (u, expected) in [(0.1, true), (passes_at - 0.02, true), (passes_at + 0.02, false), (0.9, false)] {
            assert_eq!(opacity.passes(0, u, 0.0), expected, "{mode} {cutoff} {u}");
            assert!(!opacity.passes(1, u, 0.0));
        }
        let material = loaded.data.materials[0];
        assert_eq!(material.flags, Material::ALPHA_MASK);
        assert_eq!(warned(&loaded, "blended"), (mode == "BLEND").then_some("/materials/0/alphaMode"));
    }
}

#[test]
fn without_holes_there_is_no_mask() {
    type Change = fn(&mut Value);
    let opaque: [Change; 4] = [
        |m| m["alphaMode"] = json!("OPAQUE"),
        |m| *m = json!({"alphaMode": "MASK"}),
        |m| *m = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}),
        |m| {
            m["alphaMode"] = json!("MASK");
            m["alphaCutoff"] = json!(0);
        },
    ];
    for change in opaque {
        let loaded = load(change);
        assert_eq!(loaded.data.opacity, pt_integrator::scene::OpacityData::default());
        assert_eq!(loaded.data.materials[0].flags, 0);
    }
    // A factor alone may hide all of it.
    let hidden =
        load(|m| *m = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]}}));
    assert!(hidden.data.opacity.view().passes(0, 0.3, 0.3));
    // And a transform moves the holes.
    let moved = load(|m| {
        m["alphaMode"] = json!("MASK");
        m["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({"KHR_texture_transform": {"scale": [-1, 1], "offset": [1, 0]}});
    });
    let opacity = moved.data.opacity.view();
    assert!(!opacity.passes(0, 0.1, 0.0) && opacity.passes(0, 0.9, 0.0));
}

#[test]
fn a_blended_surface_of_one_opacity_is_a_sheet() {
    for (color, opacity, specular) in [(0.15, 0.3, 1.0), (0.5, 0.75, 0.0), (0.0, 0.0, 1.0)] {
        let loaded = load(|m| {
            *m = json!({"alphaMode": "BLEND",
                "pbrMetallicRoughness": {"baseColorFactor": [color, color, color, opacity], "metallicFactor": 0},
                "extensions": {"KHR_materials_specular": {"specularFactor": specular}}});
        });
        assert_eq!(loaded.data.opacity, pt_integrator::scene::OpacityData::default());
        assert!(warned(&loaded, "thin sheets").is_some(), "{:?}", loaded.warnings);
        let material = loaded.data.materials[0];
        let (tint, through) = (material.base_color[0], material.surface[2]);
        assert!((tint * through - (1.0 - opacity)).abs() < 1e-6, "{material:?}");
        assert!((tint * (1.0 - through) - opacity * color).abs() < 1e-6, "{material:?}");
        assert!((material.specular[3] - opacity * specular).abs() < 1e-6 && material.flags == 0);
    }
}

#[test]
fn a_sheet_emits_as_much_as_it_is_there() {
    for opacity in [0.0, 0.25, 0.5] {
        let loaded = load(|m| {
            *m = json!({"alphaMode": "BLEND", "emissiveFactor": [1, 0.5, 0],
                "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, opacity], "metallicFactor": 0},
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}});
        });
        let material = loaded.data.materials[0];
        assert_eq!(material.emission[..3], [8.0 * opacity, 4.0 * opacity, 0.0]);
        assert_eq!(loaded.info.emissive_triangles, u64::from(opacity > 0.0));
        let warning = loaded.warnings.iter().find(|w| w.what.contains("thin sheets")).unwrap();
        assert!(warning.what.contains("highlights are sharp"), "{warning}");
    }
}

#[test]
fn blending_of_what_is_opaque_is_nothing() {
    let factor = |alpha: f32| json!({"baseColorFactor": [1, 1, 1, alpha], "metallicFactor": 0});
    let blended = |pbr: Value| load(|m| *m = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": pbr}));
    let whole = blended(factor(1.0));
    assert_eq!((whole.data.materials[0].lobes(), &*whole.warnings), (Lobes::DIFFUSE | Lobes::REFLECTION, &[][..]));
    assert_eq!(blended(factor(0.99)).warnings.len(), 1);
    // The same for textures; here of one texel, a column of the usual one.
    for (alpha, factor, warns, holes) in
        [(255, 1.0, false, false), (254, 1.0, true, false), (255, 0.99, true, false), (127, 1.0, true, true)]
    {
        let mut file = Gltf::triangle();
        let view = file.view(&png(1, 1, &[9, 9, 9, alpha]));
        file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({}), 0);
        file.json["materials"][0]["alphaMode"] = json!("BLEND");
        file.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, factor]);
        let uv = file.vec2(&[[0.0; 2]; 3]);
        file.json["meshes"][0]["primitives"][0] =
            json!({"attributes": {"POSITION": 0, "TEXCOORD_0": uv}, "material": 0});
        let loaded = file.load().unwrap();
        assert_eq!(warned(&loaded, "blended"), warns.then_some("/materials/0/alphaMode"), "{alpha} {factor}");
        assert_eq!(loaded.data.opacity.masks.len(), usize::from(holes), "{alpha} {factor}");
    }
}

#[test]
fn materials_of_one_image_share_its_alpha() {
    let mut file = Gltf::triangle();
    let view = file.view(&png(2, 1, &[9, 9, 9, 100, 9, 9, 9, 255]));
    file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({}), 0);
    let uv = file.vec2(&[[0.0; 2]; 3]);
    // The second cutoff is too low for holes.
    let materials = [0.5, 0.3, 0.4].map(|cutoff| {
        let mut material = file.json["materials"][0].clone();
        (material["alphaMode"], material["alphaCutoff"]) = (json!("MASK"), json!(cutoff));
        material
    });
    file.json["materials"] = json!(materials);
    let primitive = |i| json!({"attributes": {"POSITION": 0, "TEXCOORD_0": uv}, "material": i});
    file.json["meshes"][0]["primitives"] = json!([0, 1, 2].map(primitive));
    let opacity = file.load().unwrap().data.opacity;
    assert_eq!((opacity.masks.len(), &*opacity.alpha), (2, &[100, 255][..]));
    assert_eq!(opacity.mask_of_triangle, [0, Opacity::NO_MASK, 1]);
    assert!(opacity.masks.iter().all(|mask| mask.first_alpha == 0));
}

/// Looking through the image for each material would take eight thousand million texels, twice.
#[test]
fn an_image_of_many_materials_is_looked_through_once() {
    const SIDE: u32 = 1024;
    const MATERIALS: usize = 8000;
    let mut file = Gltf::triangle();
    let view = file.view(&png(SIDE, SIDE, &[0, 0, 0, 255].repeat((SIDE * SIDE) as usize)));
    file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({}), 0);
    let material = &mut file.json["materials"][0];
    (material["alphaMode"], material["emissiveFactor"]) = (json!("MASK"), json!([1, 1, 1]));
    material["emissiveTexture"] = json!({"index": 0});
    file.json["materials"] = json!(vec![material.clone(); MATERIALS]);
    let uv = file.vec2(&[[0.0; 2]; 3]);
    let primitive = |i| json!({"attributes": {"POSITION": 0, "TEXCOORD_0": uv}, "material": i});
    file.json["meshes"][0]["primitives"] = (0..MATERIALS).map(primitive).collect();
    let start = cpu_time::ThreadTime::now();
    let loaded = file.load().unwrap();
    let taken = start.elapsed();
    assert!(taken.as_secs_f64() < 1.0, "{taken:?}");
    assert_eq!(
        (loaded.info.materials, loaded.info.emissive_triangles, loaded.data.opacity.masks.len()),
        (MATERIALS, 0, 0)
    );
}
