//! Camera moves: what the curve promises, and files that break.
#![expect(clippy::float_cmp, reason = "what is kept or hit is kept or hit to the bit")]

mod common;

use std::path::PathBuf;

use proptest::prelude::*;
use scene::glam::DVec3;
use scene::{CameraKey, CameraPath, SceneError};

/// A key whose view is valid.
fn key() -> impl Strategy<Value = CameraKey> {
    let number = || -50.0..50.0_f64;
    let light = prop_oneof![Just(0.0), Just(1.0), 0.0..20.0_f64];
    ((number(), number(), number()), (-20.0..20.0_f64, -9.0..9.0_f64), 0.1..2.5_f64, light).prop_map(
        |((x, y, z), (side, rise), fov_y, light)| CameraKey {
            time: 0.0,
            position: DVec3::new(x, y, z),
            target: DVec3::new(x + side, y + rise, z - 30.0),
            up: DVec3::Y,
            fov_y,
            light,
        },
    )
}

/// Keys in the order of time, from evenly spaced to a million times farther from one neighbour than from the other.
fn keys() -> impl Strategy<Value = Vec<CameraKey>> {
    let step = prop_oneof![Just(0.5), 0.1..3.0_f64, (-3.0..3.0_f64).prop_map(|e| 10_f64.powf(e))];
    (prop::collection::vec((key(), step), 1..8), -100.0..100.0_f64).prop_map(|(steps, mut time)| {
        let mut keys = Vec::new();
        for (mut key, step) in steps {
            time += step;
            key.time = time;
            keys.push(key);
        }
        keys
    })
}

/// The path, or `None` where the curve swings to something that is no view.
fn path(keys: &[CameraKey], frames: u32) -> Option<CameraPath> {
    CameraPath::new("path", keys.to_vec(), frames).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Every frame has a finite view and a light factor between the smallest and the largest of the keys.
    #[test]
    fn frames_are_views(keys in keys(), frames in 1..60_u32) {
        let Some(path) = path(&keys, frames) else { return Ok(()) };
        let lights = keys.iter().map(|k| k.light);
        let (least, most) = (lights.clone().fold(f64::INFINITY, f64::min), lights.fold(0.0, f64::max));
        for i in 0..frames {
            let (view, light) = path.frame(i).unwrap();
            prop_assert!(view.position.is_finite() && view.fov_y > 0.0 && view.fov_y < std::f64::consts::PI);
            prop_assert!((view.forward.length() - 1.0).abs() < 1e-12 && view.forward.dot(view.up).abs() < 1e-12);
            prop_assert!(light >= 0.0 && f64::from(light) >= least * 0.999_999 && f64::from(light) <= most * 1.000_001);
        }
        prop_assert!(path.frame(frames).is_none() && path.frame(u32::MAX).is_none());
    }

    /// The first and the last frame are the first and the last key; evenly spaced keys are all hit.
    #[test]
    fn keys_are_hit(mut keys in keys(), parts in 1..6_u32) {
        for (i, key) in keys.iter_mut().enumerate() {
            key.time = i as f64 * 0.25;
        }
        let frames = (keys.len() as u32 - 1) * parts + 1;
        let Some(path) = path(&keys, frames) else { return Ok(()) };
        for (i, key) in keys.iter().enumerate() {
            let frame = i as u32 * parts;
            // Frames that are no exact fraction land an ULP beside the key.
            let (view, light) = path.frame(frame).unwrap();
            let off = (view.position - key.position).length();
            prop_assert!(off < 1e-9, "key {i}: {off}");
            prop_assert!((view.fov_y - key.fov_y).abs() < 1e-9 && (f64::from(light) - key.light).abs() < 1e-5);
            if frame == 0 || frame == frames - 1 {
                prop_assert_eq!((view.position, view.fov_y, light), (key.position, key.fov_y, key.light as f32));
            }
        }
    }

    /// What all keys agree in stays, to the bit, whatever the times.
    #[test]
    fn rest_is_rest(one in key(), keys in keys(), frames in 1..40_u32) {
        let keys: Vec<_> = keys.iter().map(|k| CameraKey { time: k.time, ..one }).collect();
        let path = path(&keys, frames).unwrap();
        let first = path.frame(0).unwrap();
        for i in 1..frames {
            prop_assert_eq!(&path.frame(i).unwrap(), &first);
        }
    }

    /// Keys on a straight line at a steady speed give that line, however their times are spaced.
    #[test]
    fn steady_motion_stays_steady(keys in keys(), frames in 2..40_u32) {
        let start = keys[0];
        let at = |time: f64| {
            let moved = DVec3::new(0.3, -0.1, 0.2) * (time - start.time);
            (start.position + moved, start.target + moved)
        };
        let keys: Vec<_> = keys
            .iter()
            .map(|k| {
                let (position, target) = at(k.time);
                CameraKey { time: k.time, position, target, ..start }
            })
            .collect();
        let path = path(&keys, frames).unwrap();
        for i in 0..frames {
            let expected = at(path.time(i)).0;
            let found = path.frame(i).unwrap().0.position;
            prop_assert!((found - expected).length() < 1e-6 * (1.0 + expected.length()), "{found} {expected}");
        }
    }

    /// Time turned round gives the same move backwards.
    #[test]
    fn time_may_be_turned_round(keys in keys(), frames in 2..40_u32) {
        let turned: Vec<_> = keys.iter().rev().map(|k| CameraKey { time: -k.time, ..*k }).collect();
        let (Some(there), Some(back)) = (path(&keys, frames), path(&turned, frames)) else { return Ok(()) };
        for i in 0..frames {
            let (a, b) = (there.frame(i).unwrap().0, back.frame(frames - 1 - i).unwrap().0);
            prop_assert!((a.position - b.position).length() < 1e-6 * (1.0 + a.position.length()), "{} {}", a.position, b.position);
        }
    }

    /// The curve has no corner: speeds to both sides of a key agree.
    #[test]
    fn motion_is_smooth(mut keys in prop::collection::vec(key(), 3..6)) {
        const PARTS: u32 = 4096;
        for (i, key) in keys.iter_mut().enumerate() {
            key.time = i as f64;
        }
        let frames = (keys.len() as u32 - 1) * PARTS + 1;
        let Some(path) = path(&keys, frames) else { return Ok(()) };
        let place = |i: u32| path.frame(i).unwrap().0.position;
        for key in 1..keys.len() as u32 - 1 {
            let i = key * PARTS;
            let (before, after) = (place(i) - place(i - 1), place(i + 1) - place(i));
            prop_assert!((after - before).length() * f64::from(PARTS) < 1000.0 / f64::from(PARTS) * 10.0);
        }
    }
}

fn written(text: &str) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("move.json");
    std::fs::write(&file, text).unwrap();
    (dir, file)
}

const KEY: &str = r#"{"time":@,"position":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":45}"#;

fn with_keys(keys: &[String], frames: &str) -> String {
    format!(r#"{{"keys":[{}],"frames":{frames}}}"#, keys.join(","))
}

#[test]
fn broken_files_are_refused_in_one_line() {
    let key = |time: &str| KEY.replace('@', time);
    let good = key("0");
    let pair = |second: String| with_keys(&[good.clone(), second], "2");
    let cases = [
        (String::new(), "line 1, column 0"),
        ("{}".into(), "missing field `keys`"),
        ("[1,2".into(), "not a camera path"),
        (with_keys(&[], "1"), "/keys: there is no key"),
        (with_keys(std::slice::from_ref(&good), "0"), "/frames: 0 is not"),
        (with_keys(std::slice::from_ref(&good), "1000001"), "/frames: 1000001 is not"),
        (with_keys(std::slice::from_ref(&good), "-1"), "not a camera path"),
        (with_keys(std::slice::from_ref(&good), "1.5"), "not a camera path"),
        (with_keys(std::slice::from_ref(&good), "1e99"), "not a camera path"),
        (with_keys(&[good.replace("\"up\"", "\"upp\"")], "1"), "unknown field `upp`"),
        (with_keys(&[good.replace("\"up\":[0,1,0],", "")], "1"), "missing field `up`"),
        (with_keys(&[good.replace("[0,1,0]", "[0,1]")], "1"), "not a camera path"),
        (pair(key("0")), "/keys/1/time: 0 is not after"),
        (pair(key("-1")), "/keys/1/time: -1 is not after"),
        (pair(key("1e999")), "not a camera path"),
        (pair(key("NaN")), "not a camera path"),
        (pair(key("1").replace("45}", "0}")), "/keys/1/fov_y_deg: 0 is not between"),
        (pair(key("1").replace("45}", "180}")), "/keys/1/fov_y_deg: 180 is not between"),
        (pair(key("1").replace("45}", "45,\"light\":-0.5}")), "/keys/1/light: -0.5 is not a factor"),
        (pair(key("1").replace("45}", "45,\"light\":1e40}")), "/keys/1/light"),
        (pair(key("1").replace("[0,1,5]", "[0,1,0]")), "/keys/1: position and target coincide"),
        (pair(key("1").replace("\"up\":[0,1,0]", "\"up\":[0,0,2]")), "/keys/1: the up vector is parallel"),
        (pair(key("1").replace("\"up\":[0,1,0]", "\"up\":[0,0,0]")), "/keys/1: the up vector is 0"),
        // Half way between views that look at each other's position, eye and target coincide.
        (
            with_keys(&[good.clone(), key("1").replace("[0,1,5]", "[0,1,-5]")], "3"),
            "/keys: frame 1, between keys: position and target coincide",
        ),
        // Numbers whose difference is infinite.
        (
            with_keys(&[good.replace("[0,1,5]", "[1e308,1,5]"), key("1").replace("[0,1,5]", "[-1e308,1,5]")], "3"),
            "/keys: frame 0, between keys: has a number that is not finite",
        ),
    ];
    for (text, expected) in cases {
        let (_dir, file) = written(&text);
        let error = CameraPath::from_file(&file).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
        assert!(error.contains("move.json: ") && error.contains("; write {") && error.lines().count() == 1, "{error}");
    }
    let missing = CameraPath::from_file(std::path::Path::new("/nonexistent/move.json")).unwrap_err();
    assert!(matches!(missing, SceneError::Read { .. }), "{missing}");
    let (_dir, file) = written(&" ".repeat((1 << 24) + 1));
    assert!(matches!(CameraPath::from_file(&file), Err(SceneError::TooLarge { .. })));
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let good =
        CameraKey { time: 0.0, position: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov_y: 1.0, light: 1.0 };
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for value in bad {
        for broken in [
            CameraKey { time: value, ..good },
            CameraKey { position: DVec3::new(0.0, value, 0.0), ..good },
            CameraKey { target: DVec3::new(value, 0.0, 0.0), ..good },
            CameraKey { up: DVec3::new(0.0, 1.0, value), ..good },
            CameraKey { fov_y: value, ..good },
            CameraKey { light: value, ..good },
        ] {
            let error = CameraPath::new("a\nb", vec![broken], 1).unwrap_err().to_string();
            assert!(error.contains("/keys/0") && error.lines().count() == 1, "{error}");
        }
    }
}

#[test]
fn one_key_stands_and_two_make_a_line() {
    let (_dir, file) = written(&with_keys(&[KEY.replace('@', "3")], "4"));
    let still = CameraPath::from_file(&file).unwrap();
    assert_eq!((still.frames(), still.keys().len()), (4, 1));
    assert!((0..4).all(|i| still.frame(i) == still.frame(0) && still.time(i) == 3.0));
    let second = KEY.replace('@', "2").replace("[0,1,5]", "[4,1,5]").replace("45}", "45,\"light\":3}");
    let (_dir, file) = written(&with_keys(&[KEY.replace('@', "0"), second], "5"));
    let line = CameraPath::from_file(&file).unwrap();
    for i in 0..5_u32 {
        let (view, light) = line.frame(i).unwrap();
        assert_eq!((view.position.x, light, line.time(i)), (f64::from(i), 1.0 + 0.5 * i as f32, 0.5 * f64::from(i)));
    }
    let (_dir, file) = written(&with_keys(&[KEY.replace('@', "0"), KEY.replace('@', "1")], "1"));
    assert_eq!(CameraPath::from_file(&file).unwrap().time(0), 0.0);
}

#[test]
fn shared_paths_end_at_the_reference() {
    let shared = common::shared_root();
    let Ok(folder) = std::fs::read_dir(shared.join("refs/paths")) else {
        eprintln!("skipped: no camera paths at {}; set HASHCACHE_SHARED", shared.display());
        return;
    };
    for entry in folder {
        let file = entry.unwrap().path();
        let path = CameraPath::from_file(&file).unwrap();
        assert_eq!(path.frames(), 30, "{}", file.display());
        let last = path.keys().last().unwrap();
        let (view, light) = path.frame(29).unwrap();
        assert_eq!((view.position, view.fov_y, light), (last.position, last.fov_y, 1.0));
        let name = file.file_stem().unwrap().to_str().unwrap();
        let scene = shared.join(format!("scenes/{name}/{name}.gltf"));
        if name == "cornell-box" {
            let loaded = scene::load(scene.to_str().unwrap(), &scene::LoadOptions::default()).unwrap();
            let camera = loaded.view(None).unwrap();
            assert!((camera.position - view.position).length() < 0.01 && camera.forward.dot(view.forward) > 0.999_999);
        }
    }
}
