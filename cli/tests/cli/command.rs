//! What works, and what help and files look like.

use std::fs;

use serde_json::Value;

use crate::place::{Place, has_stats};
use crate::scene::Scene;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn help_names_what_is_built_and_nothing_else() {
    let place = Place::new();
    let help = place.succeed(&["--help"]).stdout;
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let commands: Vec<_> = commands.filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(commands, ["render", "fly", "plan", "trade", "info", "compare"]);

    let help = place.succeed(&["render", "--help"]).stdout;
    let values = |option: &str| -> Vec<String> {
        let line = help.lines().find(|line| line.trim_start().starts_with(option)).expect("the option is in help");
        let (_, values) = line.split_once("[possible values: ").expect("its values are, too");
        values.trim_end_matches(']').split(", ").map(str::to_owned).collect()
    };
    assert_eq!(values("--backend "), ["cpu"]);
    assert_eq!(values("--integrator "), ["path"]);
    assert_eq!(values("--cache "), ["octree", "grid", "none"]);
    assert_eq!(values("--visibility "), ["exact"]);
    assert_eq!(values("--filter "), ["layered", "screen", "none"]);
    let options = help.split_whitespace().filter_map(|word| word.strip_prefix("--")).map(|word| word.trim_matches(','));
    let options: std::collections::BTreeSet<_> = options.collect();
    let expected = [
        "aov",
        "backend",
        "cache",
        "camera",
        "env",
        "env-scale",
        "filter",
        "help",
        "integrator",
        "max-bounces",
        "output",
        "quiet",
        "seed",
        "set",
        "size",
        "spp",
        "stats",
        "threads",
        "visibility",
    ];
    assert_eq!(options, expected.into());
}

#[test]
fn a_render_writes_all_files_and_nothing_else() {
    let place = Place::new();
    Scene::lit_floor().write(&place);
    let args =
        ["render", "scene.gltf", "--size", "24x16", "-o", "a.png", "-o", "b.exr", "-o", "c.hdr", "--stats", "s.json"];
    let run = place.succeed(&args);
    assert!(run.stdout.is_empty());
    let mut names: Vec<_> = fs::read_dir(place.path("")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["a.png", "b.exr", "c.hdr", "s.json", "scene.bin", "scene.gltf"]);
    // The three hold the same picture as far as their formats can, and it is not black.
    for (image, least) in [("a.png", 40.0), ("c.hdr", 40.0)] {
        let report = json(&place.succeed(&["compare", image, "b.exr", "--json"]).stdout);
        assert_eq!((&report["width"], &report["height"]), (&24.into(), &16.into()));
        assert!(report["psnr_db"].as_f64().unwrap() > least, "{image}: {report}");
        assert!(report["mse"].as_f64().unwrap() > 0.0, "8 bits are not floats: {report}");
    }
    let stats = json(&fs::read_to_string(place.path("s.json")).unwrap());
    has_stats(&stats);
    assert!(stats["rays"]["closest"].as_u64().unwrap() >= 24 * 16);
}

#[test]
fn pictures_beside_the_picture_go_into_a_folder() {
    let place = Place::new();
    for run in ["into a new folder", "over its files"] {
        place.succeed(&["render", "builtin:cornell", "--size", "24x16", "-q", "--aov", "aov"]);
        assert_eq!(place.names(""), ["aov"], "{run}");
        let names = place.names("aov");
        for name in ["albedo.exr", "normal.exr", "depth.exr", "samples.exr"] {
            assert!(names.iter().any(|found| found == name), "{name} is missing in {names:?}");
        }
        assert!(names.iter().all(|name| name.split_once('.').is_some_and(|(_, ending)| ending == "exr")), "{names:?}");
        let report = json(&place.succeed(&["compare", "aov/albedo.exr", "aov/albedo.exr", "--json"]).stdout);
        assert_eq!((&report["width"], &report["height"], &report["relmse"]), (&24.into(), &16.into(), &0.0.into()));
    }
}

#[test]
fn the_default_output_is_named_after_the_scene() {
    let place = Place::new();
    place.succeed(&["render", "builtin:cornell", "--size", "8x8", "--quiet"]);
    assert!(place.path("cornell.png").is_file());
    let only_stats = Place::new();
    only_stats.succeed(&["render", "builtin:cornell", "--size", "8x8", "--quiet", "--stats", "s.json"]);
    assert_eq!(only_stats.contents().len(), 1);
}

#[test]
fn quiet_is_quiet_and_else_the_summary_is_one_line() {
    let place = Place::new();
    let quiet = place.succeed(&["render", "builtin:cornell", "--size", "8x8", "-o", "a.png", "-q"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    let told = place.succeed(&["render", "builtin:cornell", "--size", "8x8", "-o", "a.png"]);
    assert_eq!(told.stderr.lines().count(), 1, "{}", told.stderr);
    assert!(told.stderr.starts_with("a.png: 8x8"), "{}", told.stderr);
}

#[test]
fn the_image_depends_on_the_seed_and_not_on_threads() {
    for cache in ["octree", "grid", "none"] {
        let place = Place::new();
        let render = |name: &str, options: &[&str]| {
            let mut args = vec!["render", "builtin:cornell", "--size", "40x30", "-q", "--cache", cache, "-o", name];
            args.extend(options);
            place.succeed(&args);
            fs::read(place.path(name)).unwrap()
        };
        let one = render("one.exr", &["--threads", "1"]);
        assert!(one == render("two.exr", &["--threads", "2"]), "{cache}: two threads differ from one");
        assert!(one == render("serial.exr", &["--set", "cpu.launcher=serial"]), "{cache}: serial differs");
        assert!(one != render("other.exr", &["--seed", "1"]), "{cache}: the seed does nothing");
    }
}

#[test]
fn an_image_equals_itself() {
    let place = Place::new();
    place.succeed(&["render", "builtin:cornell", "--size", "176x176", "-q", "-o", "a.exr"]);
    let report = json(&place.succeed(&["compare", "a.exr", "a.exr", "--json"]).stdout);
    for key in ["relmse", "relmse_trimmed", "mse", "flip"] {
        assert_eq!(report[key], 0.0, "{key}");
    }
    assert!(report["psnr_db"].is_null());
    assert_eq!((&report["ms_ssim"], &report["energy_ratio"]), (&1.0.into(), &1.0.into()));
    let text = place.succeed(&["compare", "a.exr", "a.exr"]).stdout;
    assert!(text.contains("PSNR            infinite") && text.contains("FLIP            0.000000"), "{text}");
}

#[test]
fn plan_and_info_tell_about_a_scene() {
    let place = Place::new();
    Scene::lit_floor().write(&place);
    let [grid, none] = ["grid", "none"].map(|cache| place.succeed(&["plan", "scene.gltf", "--cache", cache]).stdout);
    assert!(grid.contains("trace") && grid.contains("query"), "{grid}");
    assert!(none.contains("trace") && !none.contains("query"), "{none}");
    let info = place.succeed(&["info", "scene.gltf"]).stdout;
    assert!(info.contains("triangles") && info.contains("front"), "{info}");
    assert!(place.succeed(&["info", "builtin:"]).stdout.lines().any(|line| line.starts_with("builtin:cornell ")));
    // A scene without camera or light cannot be rendered, but looked at.
    Scene::lit_floor()
        .set("/scenes/0/nodes", serde_json::json!([0]))
        .without("cameras")
        .set("/nodes/2", serde_json::json!({}))
        .write(&place);
    assert!(place.succeed(&["info", "scene.gltf"]).stdout.contains("triangles"));
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let place = Place::new();
    for args in [&["--help"][..], &["info", "builtin:"]] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let run = place.command(args).stdout(writer).output().expect("the command starts");
        assert_eq!((run.status.code(), run.stderr.as_slice()), (Some(0), &b""[..]), "{args:?}");
    }
}
