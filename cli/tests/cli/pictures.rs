//! What pictures look like: exposure, curve, and errors as colours.

use std::fs;

use serde_json::Value;

use crate::bad_input::{Case, case, check, file, good};
use crate::place::Place;
use crate::scene::Scene;

const SMALL: [&str; 5] = ["render", "builtin:cornell", "--size", "24x16", "-q"];

fn energy(place: &Place, image: &str, reference: &str) -> f64 {
    let report: Value =
        serde_json::from_str(&place.succeed(&["compare", image, reference, "--json"]).stdout).expect("JSON");
    report["energy_ratio"].as_f64().expect("light")
}

#[test]
fn exposure_and_curve_are_for_png_alone() {
    let place = Place::new();
    let render = |set: &[&str], png: &str, exr: &str| {
        place.succeed(&[&SMALL[..], set, &["-o", png, "-o", exr]].concat());
    };
    render(&[], "plain.png", "plain.exr");
    render(&["--set", "image.exposure=-1"], "dark.png", "dark.exr");
    render(&["--set", "image.tonemap=filmic"], "film.png", "film.exr");
    let bytes = |name: &str| fs::read(place.path(name)).expect("a file");
    assert!(bytes("plain.exr") == bytes("dark.exr") && bytes("plain.exr") == bytes("film.exr"));
    // The lamp is clipped at any exposure here; all else is half as bright.
    let dark = energy(&place, "dark.png", "plain.png");
    assert!((0.45..0.75).contains(&dark), "{dark}");
    let film = energy(&place, "film.png", "plain.png");
    assert!((film - 1.0).abs() > 0.02, "{film}");
}

#[test]
fn a_heat_map_is_black_where_pictures_agree() {
    let place = Place::new();
    place.succeed(&[&SMALL[..], &["-o", "a.exr"]].concat());
    place.succeed(&[&SMALL[..], &["--seed", "1", "-o", "b.exr"]].concat());
    let told = place.succeed(&["compare", "a.exr", "b.exr"]).stdout;
    for metric in ["flip", "relative"] {
        let map = |of: &str, name: &str| {
            let run = place.succeed(&["compare", "a.exr", of, "--heat-map", name, "--heat-map-of", metric]);
            (run.stdout, fs::read(place.path(name)).expect("a heat map"))
        };
        let (same, map_of_same) = map("a.exr", "same.png");
        let (other, map_of_other) = map("b.exr", "other.png");
        assert!(map_of_same != map_of_other && same != other && other == told, "{metric}");
        // Magma's first colour has red and green 0.
        let bright = |name: &str| place.succeed(&["compare", name, "a.exr", "--json"]).stdout;
        let report: Value = serde_json::from_str(&bright("same.png")).expect("JSON");
        assert_eq!((&report["energy_ratio_rgb"][0], &report["energy_ratio_rgb"][1]), (&0.0.into(), &0.0.into()));
        let report: Value = serde_json::from_str(&bright("other.png")).expect("JSON");
        assert!(report["energy_ratio_rgb"][0].as_f64().expect("red") > 0.0);
    }
}

#[test]
fn default_names_suit_every_system() {
    let place = Place::new();
    place.succeed(&["render", "builtin:thin-wall:0.1", "--size", "8x8", "-q"]);
    assert_eq!(place.names(""), ["thin-wall-0.1.png"]);
}

#[test]
fn a_camera_file_shows_a_scene_without_cameras() {
    let place = Place::new();
    good(&place);
    place.succeed(&["render", "scene.gltf", "--size", "16x16", "-q", "-o", "a.exr"]);
    Scene::lit_floor().without("cameras").set("/nodes/2", serde_json::json!({})).write(&place);
    let run = place.run(&["render", "scene.gltf", "--size", "16x16", "-q", "-o", "b.exr"]);
    assert!(run.status == 1 && run.stderr.contains("--camera"), "{}", run.stderr);
    // The view of the scene's own camera: 20 degrees down.
    let view = r#"{"position":[0,1,2.5],"target":[0,0.657980,1.560307],"up":[0,1,0],"fov_y_deg":45.836624}"#;
    file(&place, "view.json", view);
    place.succeed(&["render", "scene.gltf", "--camera", "view.json", "--size", "16x16", "-q", "-o", "b.exr"]);
    let ratio = energy(&place, "b.exr", "a.exr");
    assert!((ratio - 1.0).abs() < 1e-2, "{ratio}");
}

#[test]
fn a_plan_tells_needs_and_goes_into_a_file() {
    let place = Place::new();
    good(&place);
    let text = place.succeed(&["plan", "scene.gltf", "--size", "16x16", "--stats", "plan.json"]).stdout;
    assert!(text.contains("needs "), "{text}");
    let stats: Value = serde_json::from_slice(&fs::read(place.path("plan.json")).expect("a file")).expect("JSON");
    for key in ["scene", "backend", "settings", "needs", "plan", "saved", "time_s", "cpu_s"] {
        assert!(!stats[key].is_null(), "{key} is missing in {stats}");
    }
    let stages = stats["plan"].as_array().expect("stages");
    assert!(stages.iter().all(|stage| text.contains(stage["stage"].as_str().expect("a name"))), "{text}");
    assert_eq!(stats["frames"], 0);
    let measured = place.succeed(&["plan", "scene.gltf", "--size", "16x16", "--measure"]).stdout;
    assert!(!text.contains("ns a sample") && measured.contains("ns a sample"), "{text}{measured}");
}

fn two_sizes(place: &Place) {
    for (name, size) in [("a.exr", "8x8"), ("b.exr", "8x9")] {
        place.succeed(&["render", "builtin:furnace", "--size", size, "-q", "-o", name]);
    }
}

#[test]
fn command_lines_about_pictures() {
    const CASES: &[Case] = &[
        case(
            "a curve that does not exist",
            good,
            &["render", "scene.gltf", "--set", "image.tonemap=aces"],
            2,
            "filmic",
        ),
        case("exposure NaN", good, &["render", "scene.gltf", "--set", "image.exposure=NaN"], 2, "image.exposure"),
        case("exposure out of range", good, &["render", "scene.gltf", "--set", "image.exposure=1e9"], 2, "100"),
        case(
            "exposure, no png",
            good,
            &["render", "scene.gltf", "--set", "image.exposure=1", "-o", "a.exr"],
            2,
            ".png",
        ),
        case(
            "curve, no png",
            good,
            &["render", "scene.gltf", "--set", "image.tonemap=filmic", "-o", "a.hdr"],
            2,
            ".png",
        ),
        case(
            "curve, statistics alone",
            good,
            &["render", "scene.gltf", "--set", "image.exposure=1", "--stats", "s"],
            2,
            ".png",
        ),
        case("exposure of a sweep", good, &["trade", "scene.gltf", "--set", "image.exposure=1", "-o", "t"], 2, "trade"),
        case(
            "exposures to sweep",
            good,
            &["trade", "scene.gltf", "--vary", "image.exposure=0,1", "-o", "t"],
            2,
            "trade",
        ),
        case(
            "exposure of a move in exr",
            good,
            &["fly", "scene.gltf", "--path", "p.json", "-o", "d", "--set", "image.exposure=1"],
            2,
            "--format png",
        ),
        case("rotation in words", good, &["render", "scene.gltf", "--set", "env.rotation=left"], 2, "env.rotation"),
        case(
            "rotation of nothing",
            good,
            &["render", "scene.gltf", "--set", "env.rotation=9", "-o", "a.png"],
            1,
            "--env",
        ),
        case("a heat map in exr", two_sizes, &["compare", "a.exr", "a.exr", "--heat-map", "m.exr"], 2, ".png"),
        case(
            "a heat map of an image that is not there",
            two_sizes,
            &["compare", "m.png", "a.exr", "--heat-map", "m.png"],
            1,
            "m.png",
        ),
        case("a heat map without a name", two_sizes, &["compare", "a.exr", "a.exr", "--heat-map"], 2, "--heat-map"),
        case("a heat map nowhere", two_sizes, &["compare", "a.exr", "a.exr", "--heat-map", "no/m.png"], 1, "no/m.png"),
        case("a heat map of two sizes", two_sizes, &["compare", "a.exr", "b.exr", "--heat-map", "m.png"], 1, "a.exr"),
        case(
            "a metric without a map",
            two_sizes,
            &["compare", "a.exr", "a.exr", "--heat-map-of", "flip"],
            2,
            "--heat-map",
        ),
        case(
            "a metric that does not exist",
            two_sizes,
            &["compare", "a.exr", "a.exr", "--heat-map", "m.png", "--heat-map-of", "psnr"],
            2,
            "flip, relative",
        ),
        case("a plan over its scene", good, &["plan", "scene.gltf", "--stats", "scene.gltf"], 2, "which is read"),
        case(
            "statistics over the scene",
            good,
            &["render", "scene.gltf", "--size", "8x8", "--stats", "./scene.gltf"],
            2,
            "which is read",
        ),
        case("a plan nowhere", good, &["plan", "scene.gltf", "--stats", "no/plan.json"], 1, "no/plan.json"),
    ];
    check(CASES);
}

#[test]
fn a_heat_map_does_not_take_an_image_s_place() {
    let place = Place::new();
    place.succeed(&["render", "builtin:furnace", "--size", "8x8", "-q", "-o", "a.png", "-o", "b.png"]);
    let before = place.contents();
    for name in ["a.png", "./b.png"] {
        let run = place.run(&["compare", "a.png", "b.png", "--heat-map", name]);
        assert!(run.status == 2 && run.stderr.contains(name) && run.stderr.lines().count() == 1, "{}", run.stderr);
    }
    assert!(place.contents() == before);
}
