//! Camera moves.

use std::fs;

use serde_json::{Value, json};

use crate::bad_input::file;
use crate::place::{Place, has_stats};
use crate::scene::Scene;
use crate::table::Table;

/// From rest, at which the lamps change once, to a move.
pub fn path(place: &Place, frames: u32) {
    let key = |time: f64, x: f64, light: f64| json!({"time": time, "position": [x, 0.0, 3.9], "target": [x, 0.0, 0.0], "up": [0, 1, 0], "fov_y_deg": 39.3, "light": light});
    let keys = [key(0.0, 0.0, 1.0), key(1.0, 0.0, 1.0), key(2.0, 0.0, 1.0), key(3.0, 0.3, 2.0)];
    file(place, "path.json", json!({ "keys": keys, "frames": frames }).to_string());
}

const FLY: [&str; 8] = ["fly", "builtin:cornell", "--path", "path.json", "--size", "32x32", "-o", "out"];

fn fly(place: &Place, options: &[&str]) -> String {
    place.succeed(&[&FLY[..], options].concat()).stderr
}

fn summary(place: &Place, folder: &str) -> Value {
    serde_json::from_slice(&fs::read(place.path(folder).join("summary.json")).expect("a summary")).expect("JSON")
}

#[test]
fn a_move_writes_frames_rows_and_a_summary() {
    let place = Place::new();
    path(&place, 4);
    let told = fly(&place, &[]);
    assert!(told.starts_with("out: 4 frames of 32x32") && told.lines().count() == 1, "{told}");
    let expected =
        ["frame_0000.exr", "frame_0001.exr", "frame_0002.exr", "frame_0003.exr", "metrics.csv", "summary.json"];
    assert_eq!(place.names("out"), expected);
    let summary = summary(&place, "out");
    has_stats(&summary);
    assert!(!summary["path"].is_null(), "path is missing in {summary}");
    let frames = summary["frames"].as_array().expect("a list");
    assert_eq!(frames.len(), 4);
    let metrics = Table::read(&place, "out/metrics.csv");
    assert_eq!(metrics.columns.join(","), "frame,time_s,cpu_s,relmse,relmse_trimmed,ms_ssim,flip,energy_ratio,flicker");
    for (index, frame) in frames.iter().enumerate() {
        assert_eq!(frame["index"], index);
        assert!(frame["time_s"].as_f64().unwrap() > 0.0 && frame["cpu_s"].as_f64().unwrap() > 0.0);
        assert!(frame["relmse"].is_null());
        assert_eq!(metrics.number(index, "frame"), Some(index as f64));
        assert_eq!(metrics.number(index, "time_s"), frame["time_s"].as_f64());
        assert_eq!(metrics.number(index, "relmse"), None);
        assert_eq!(metrics.number(index, "flicker"), frame["flicker"].as_f64());
    }
    // Frames 0 to 2 rest, so their flicker is known without references; the last one moves and doubles the light.
    let flicker: Vec<_> = (0..4).map(|row| metrics.number(row, "flicker")).collect();
    assert!(matches!(flicker[..], [None, Some(a), Some(b), None] if a > 0.0 && b > 0.0), "{flicker:?}");
    let [before, after] = ["out/frame_0002.exr", "out/frame_0003.exr"];
    let report: Value = serde_json::from_str(&place.succeed(&["compare", after, before, "--json"]).stdout).unwrap();
    let ratio = report["energy_ratio"].as_f64().unwrap();
    assert!((1.5..2.5).contains(&ratio), "twice the light: {ratio}");
}

#[test]
fn references_give_errors_where_there_are_any() {
    let place = Place::new();
    path(&place, 4);
    fly(&place, &["-q", "--spp", "2"]);
    fs::rename(place.path("out"), place.path("refs")).unwrap();
    fs::remove_file(place.path("refs/frame_0001.exr")).unwrap();
    fly(&place, &["-q", "--references", "refs", "--spp", "2"]);
    let same = summary(&place, "out");
    let relmse: Vec<_> = (0..4).map(|i| same["frames"][i]["relmse"].as_f64()).collect();
    assert_eq!(relmse, [Some(0.0), None, Some(0.0), Some(0.0)]);
    // At rest one reference serves two frames; without change of either, a frame flickers by its difference from it.
    let flicker = |i: usize| same["frames"][i]["flicker"].as_f64();
    assert_eq!((flicker(0), flicker(3)), (None, Some(0.0)));
    assert!(flicker(1).unwrap() > 0.0 && flicker(2).unwrap() > 0.0);
    fly(&place, &["-q", "--references", "refs", "--spp", "2", "--seed", "5"]);
    let other = summary(&place, "out");
    let last = &other["frames"][3];
    for key in ["relmse", "relmse_trimmed", "flip", "flicker"] {
        assert!(last[key].as_f64().unwrap() > 0.0, "{key}: {last}");
    }
    assert!((last["energy_ratio"].as_f64().unwrap() - 1.0).abs() < 0.5 && last["ms_ssim"].is_null(), "{last}");
}

#[test]
fn frames_do_not_depend_on_threads() {
    for cache in ["octree", "grid", "none"] {
        let place = Place::new();
        path(&place, 3);
        let frames = |threads: &str| {
            fly(&place, &["-q", "--cache", cache, "--threads", threads]);
            let read = |name: &str| fs::read(place.path("out").join(name)).unwrap();
            ["frame_0000.exr", "frame_0001.exr", "frame_0002.exr"].map(read)
        };
        assert!(frames("1") == frames("2"), "{cache}");
    }
}

#[test]
fn a_later_move_replaces_an_earlier_one_and_never_mixes_with_it() {
    let place = Place::new();
    path(&place, 2);
    fly(&place, &["-q"]);
    fly(&place, &["-q"]);
    path(&place, 1);
    let run = place.run(&FLY);
    assert!(run.status == 1 && run.stderr.contains("frame_0001.exr"), "{}", run.stderr);
    fs::remove_file(place.path("out/frame_0001.exr")).unwrap();
    let run = place.run(&[&FLY[..], &["--format", "png"]].concat());
    assert!(run.status == 1 && run.stderr.contains("frame_0000.exr"), "{}", run.stderr);
    fly(&place, &["-q"]);
    assert_eq!(place.names("out"), ["frame_0000.exr", "metrics.csv", "summary.json"]);
}

#[test]
fn a_folder_that_is_there_will_do_and_frames_may_be_png() {
    let place = Place::new();
    path(&place, 1);
    fs::create_dir(place.path("out")).unwrap();
    file(&place, "out/notes.txt", "mine");
    fly(&place, &["-q", "--format", "png"]);
    assert_eq!(place.names("out"), ["frame_0000.png", "metrics.csv", "notes.txt", "summary.json"]);
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_whole_files_only() {
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let place = Place::new();
    path(&place, 100_000);
    let mut run = place.command(&FLY).arg("-q").stderr(Stdio::piped()).spawn().expect("the command starts");
    let started = Instant::now();
    while !place.path("out/frame_0003.exr").exists() {
        assert!(started.elapsed() < Duration::from_secs(60), "no frame after a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    assert_eq!(run.wait().unwrap().signal(), Some(2), "ends by the signal, as a shell expects");
    let names = place.names("out");
    let frames = names.iter().filter(|name| name.starts_with("frame_")).count();
    assert_eq!(names.len(), frames + 1, "frames and metrics.csv, nothing else: {names:?}");
    for (index, name) in names[..frames].iter().enumerate() {
        assert_eq!(*name, format!("frame_{index:04}.exr"));
    }
    let last = format!("out/{}", names[frames - 1]);
    place.succeed(&["compare", &last, &last]);
    // A row follows its frame.
    let rows = Table::read(&place, "out/metrics.csv").rows.len();
    assert!(rows == frames || rows + 1 == frames, "{rows} rows, {frames} frames");
    let others: Vec<_> =
        place.contents().into_iter().filter(|(path, _)| path.to_string_lossy().contains(".hashcache-")).collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn a_scene_needs_no_camera_of_its_own() {
    let place = Place::new();
    path(&place, 1);
    Scene::lit_floor().set("/scenes/0/nodes", json!([0, 1])).write(&place);
    place.succeed(&["fly", "scene.gltf", "--path", "path.json", "--size", "8x8", "-o", "out", "-q"]);
    assert_eq!(place.names("out").len(), 3);
}
