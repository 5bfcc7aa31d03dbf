//! Frames of scenes with mirrors and glass: layers one behind another.

use hashcache::{Image, Preview, Settings};

const SCENE: &str = "builtin:interior";

fn preview(set: &[(&str, &str)]) -> Preview {
    let mut settings = Settings::default();
    settings.set("size", "64x48").unwrap();
    for (key, value) in set {
        settings.set(key, value).unwrap();
    }
    Preview::open(SCENE, &settings).unwrap()
}

fn frames(preview: &Preview, frames: u32) -> Vec<Image> {
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    (0..frames).map(|_| session.frame(preview.camera(), &mut |_| ()).unwrap().image).collect()
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flatten().map(|&x| f64::from(x)).sum();
    sum / (3 * image.pixels.len()) as f64
}

#[test]
fn scenes_with_mirrors_have_layers() {
    let preview = preview(&[]);
    let (needs, plan) = (preview.needs(), preview.plan());
    assert!(needs.is_glossy() && needs.lobes.contains(&"reflection"), "{needs:?}");
    assert!(needs.layers > 1 && plan.layers == needs.layers.min(4) && !plan.reuses_paths, "{plan:?}");
    assert!(plan.to_string().contains("layers"), "{plan}");
    for (set, layers) in [
        (&[("filter.layers", "1")][..], 1),
        (&[("filter.layers", "2")], 2),
        (&[("filter.layers", "8")], needs.layers),
        (&[("cache", "none")], 1),
    ] {
        assert_eq!(self::preview(set).plan().layers, layers, "{set:?}");
    }
}

/// Every number of layers, cache and filter shows the light of path tracing.
#[test]
fn layers_keep_the_energy_of_path_tracing() {
    let reference = preview(&[("cache", "none"), ("filter", "none"), ("spp", "384")]);
    let reference = mean(&reference.render(&mut |_| ()).unwrap().image);
    for cache in ["octree", "grid"] {
        for (filter, layers, direct) in [
            ("layered", "4", "cached"),
            ("layered", "4", "traced"),
            ("layered", "1", "cached"),
            ("screen", "4", "cached"),
            ("none", "4", "cached"),
        ] {
            let set = [
                ("cache", cache),
                ("filter", filter),
                ("filter.layers", layers),
                ("cache.direct", direct),
                ("spp", "32"),
                ("seed", "1"),
            ];
            let ratio = mean(&preview(&set).render(&mut |_| ()).unwrap().image) / reference;
            // 98,304 paths of a room without a lamp in sight know the mean to about 2 %.
            assert!((ratio - 1.0).abs() < 0.06, "{cache} {filter} {layers} {direct}: energy {ratio}");
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    for set in [
        &[("cache", "octree")][..],
        &[("cache", "grid"), ("cache.direct", "traced"), ("cache.store", "3")],
        &[("cache", "octree"), ("filter", "screen")],
        &[("cache", "none")],
    ] {
        let of = |launcher: &[(&str, &str)]| frames(&preview(&[set, launcher].concat()), 2);
        let serial = of(&[("cpu.launcher", "serial")]);
        assert!(of(&[("threads", "2")]) == serial, "{set:?}");
        assert!(of(&[("threads", "3")]) == serial, "{set:?}");
    }
}

#[test]
fn each_layer_has_its_pictures() {
    let preview = preview(&[]);
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    session.frame(preview.camera(), &mut |_| ()).unwrap();
    let aovs = session.aovs().unwrap();
    let lit = |name: &str| {
        let (_, image) = aovs.iter().find(|(found, _)| *found == name).unwrap_or_else(|| panic!("no {name}"));
        assert!(image.pixels.iter().flatten().all(|x| x.is_finite()), "{name}");
        image.pixels.iter().filter(|pixel| pixel.iter().any(|&x| x > 0.0)).count()
    };
    assert!(lit("albedo") > lit("layer1_albedo") && lit("layer1_albedo") > 0);
    for layer in 1..preview.plan().layers {
        for what in ["albedo", "normal", "depth", "emission", "direct", "cached"] {
            lit(&format!("layer{layer}_{what}"));
        }
    }
    assert_eq!(aovs.len() as u32, 10 + 6 * (preview.plan().layers - 1));
}
