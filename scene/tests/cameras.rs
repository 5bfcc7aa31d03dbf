//! Cameras in scenes and in files.

mod common;

use common::{Gltf, warned};
use scene::SceneError;
use scene::glam::{DVec3, Vec3};
use serde_json::{Value, json};

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
    let dir = tempfile::tempdir().unwrap();
    let loaded = common::load_in(dir.path(), "room.glb", &Gltf::triangle().glb()).unwrap();
    let error = || loaded.view(None).unwrap_err().to_string();
    assert!(error().contains("pass --camera FILE.json with position"), "{}", error());
    // A file that is no camera is not named; one that is, is; the scene's own goes first.
    for (name, text, named) in [
        ("camera.json", "{}", None),
        ("camera.json", CAMERA, Some("camera.json")),
        ("room.camera.json", "[", Some("/camera.json")),
        ("room.camera.json", CAMERA, Some("room.camera.json")),
    ] {
        std::fs::write(dir.path().join(name), text).unwrap();
        let error = error();
        assert_eq!(error.contains("which lies beside it"), named.is_some(), "{error}");
        assert!(named.is_none_or(|file| error.contains(&format!("{file}, which"))), "{error}");
        assert_eq!(error.lines().count(), 1);
    }
}

const CAMERA: &str = r#"{"position":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":90}"#;

#[test]
fn camera_files_are_checked() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("c.json");
    let load = |text: &str| {
        std::fs::write(&path, text).unwrap();
        scene::View::from_file(&path)
    };
    let good = CAMERA;
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
