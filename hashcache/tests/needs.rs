//! What scenes need, and that a feature that a scene does without costs nothing but time.

use hashcache::feature::FEATURES;
use hashcache::{FeatureSet, FramePlan, Image, Needs, Preview, Settings};

fn preview(scene: &str, set: &[(&str, &str)]) -> Preview {
    let mut settings = Settings::default();
    settings.set("size", "40x30").unwrap();
    for (key, value) in set {
        settings.set(key, value).unwrap();
    }
    Preview::open(scene, &settings).unwrap()
}

/// Two frames at rest, the second one's bits.
fn picture(scene: &str, set: &[(&str, &str)]) -> Image {
    let preview = preview(scene, set);
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    session.frame(preview.camera(), &mut |_| ()).unwrap();
    session.frame(preview.camera(), &mut |_| ()).unwrap().image
}

fn bits(image: &Image) -> Vec<u32> {
    image.pixels.as_flattened().iter().map(|x| x.to_bits()).collect()
}

const PIPELINES: [&[(&str, &str)]; 5] = [
    &[("cache", "none"), ("filter", "none")],
    &[("cache", "none")],
    &[("cache", "octree")],
    &[("cache", "grid"), ("filter", "screen"), ("cache.direct", "traced")],
    &[("cache", "octree"), ("cache.store", "3"), ("filter", "none")],
];

#[test]
fn forcing_what_a_scene_does_without_changes_no_bit() {
    for pipeline in PIPELINES {
        for scene in ["builtin:cornell", "builtin:furnace"] {
            let plain = bits(&picture(scene, pipeline));
            let needs = preview(scene, &[]).needs().clone();
            let absent: Vec<_> = FEATURES.iter().filter(|feature| !feature.is_needed(&needs)).collect();
            assert!(absent.len() >= 8, "{scene} needs little");
            for name in absent.iter().map(|feature| feature.name).chain(["all"]) {
                let forced = [pipeline, &[("needs.force", name)]].concat();
                assert!(bits(&picture(scene, &forced)) == plain, "{scene}, {pipeline:?}: {name}");
            }
        }
    }
}

#[test]
fn plans_tell_what_is_left_out() {
    let plain = preview("builtin:cornell", &[]);
    let names: Vec<_> = plain.plan().saved.iter().map(|saving| saving.feature).collect();
    for feature in FEATURES {
        assert_eq!(names.contains(&feature.name), feature.name != "triangle_lights", "{}", feature.name);
    }
    assert!(names.contains(&"alpha_masks") && names.contains(&"second_uv"));
    let layers = plain.plan().saved.iter().find(|saving| saving.feature == "layers").unwrap();
    // Three layers of 128 bytes and 48 of fronts, a record of 96 and an estimate of 32; 32 behind, 32 carried.
    assert_eq!(layers.bytes, 40 * 30 * (3 * (128 + 48 + 96 + 32) + 64));
    // There is room for 2¹⁹ records: those of the first layer of so many pixels, or of all of fewer.
    let large = preview("builtin:cornell", &[("size", "1024x512")]);
    let layers = large.plan().saved.iter().find(|saving| saving.feature == "layers").unwrap();
    assert_eq!(layers.bytes, 1024 * 512 * (3 * (128 + 48) + 64));
    assert_eq!((plain.plan().layers, plain.plan().reuses_paths), (1, true));
    let text = plain.plan().to_string();
    for part in ["Lambert", "needs diffuse: ", "needs lights: 2 emissive triangles", "leaves out layers: ", "MiB"] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }

    let stats = serde_json::to_value(plain.render(&mut |_| ()).unwrap().stats).unwrap();
    assert_eq!(stats["needs"]["lobes"], serde_json::json!(["diffuse"]));
    assert_eq!(stats["saved"].as_array().unwrap().len(), names.len());
    assert_eq!(stats["settings"]["needs.force"], "none");
}

#[test]
fn plans_tell_what_asks_for_layers() {
    let needs = Needs { lobes: vec!["diffuse", "coat"], layers: 3, rough_lobes: true, ..Needs::default() };
    let text = FramePlan::new(needs, &Settings::default(), 1).to_string();
    let least = layered_filter::front::LEAST_ROUGHNESS;
    for part in [&format!("roughness from {least} on"), "what is seen through it by reflection or transmission"] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    assert!(!text.contains("solid"), "{text}");
}

#[test]
fn sets_of_features_are_read_and_written() {
    for feature in FEATURES {
        let set = FeatureSet::parse(feature.name).unwrap();
        assert!(set.contains(feature) && set.to_string() == feature.name && set == FeatureSet::of(feature));
    }
    let all = FeatureSet::parse("all").unwrap();
    assert!(FEATURES.iter().all(|feature| all.contains(feature)));
    assert_eq!(FeatureSet::parse(&all.to_string()), Ok(all));
    assert_eq!(FeatureSet::parse("none"), Ok(FeatureSet::NONE));
    for bad in ["", "glossy,", "Glossy", "all,glossy", "glossy glossy"] {
        let told = FeatureSet::parse(bad).unwrap_err();
        assert!(told.contains("textures") && told.contains("none"), "{bad}: {told}");
    }
}
