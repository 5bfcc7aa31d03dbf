//! Camera moves that cannot be rendered.

use std::fs;

use serde_json::json;

use crate::bad_input::{case, check, file, good};
use crate::fly::path;
use crate::place::Place;

const BAD: &[&str] = &["fly", "scene.gltf", "--path", "path.json", "--size", "8x8", "-o", "out"];
const REFS: &[&str] =
    &["fly", "scene.gltf", "--path", "path.json", "--size", "8x8", "-o", "out", "--references", "refs"];

fn moving(place: &Place) {
    good(place);
    path(place, 2);
}

/// A path file of this text.
fn text(place: &Place, text: &str) {
    good(place);
    file(place, "path.json", text);
}

/// A path file of keys at these times.
fn keys(place: &Place, times: &[u32], frames: u32) {
    let key =
        |time| json!({"time": time, "position": [0, 1, 2], "target": [0, 1, 0], "up": [0, 1, 0], "fov_y_deg": 40});
    let keys: Vec<_> = times.iter().map(key).collect();
    text(place, &json!({ "keys": keys, "frames": frames }).to_string());
}

#[test]
fn path_files() {
    check(&[
        case("no path", good, &["fly", "scene.gltf", "-o", "out"], 2, "--path"),
        case("no folder", good, &["fly", "scene.gltf", "--path", "path.json"], 2, "-o"),
        case("missing path file", good, BAD, 1, "path.json"),
        case("broken path file", |p| text(p, "{\"keys\": ["), BAD, 1, "path.json"),
        case("no keys", |p| keys(p, &[], 3), BAD, 1, "/keys"),
        case("no frames", |p| keys(p, &[0], 0), BAD, 1, "/frames"),
        case("keys out of order", |p| keys(p, &[1, 0], 3), BAD, 1, "/keys/1/time"),
        case("missing scene", |p| path(p, 2), BAD, 1, "scene.gltf"),
        case(
            "a camera besides the path",
            moving,
            &["fly", "scene.gltf", "--path", "path.json", "-o", "out", "--camera", "front"],
            2,
            "--camera",
        ),
        case(
            "unknown format",
            moving,
            &["fly", "scene.gltf", "--path", "path.json", "-o", "out", "--format", "bmp"],
            2,
            "png",
        ),
    ]);
}

#[test]
fn folders() {
    fn refs(place: &Place) {
        moving(place);
        fs::create_dir(place.path("refs")).unwrap();
    }
    check(&[
        case(
            "the folder is a file",
            |p| {
                moving(p);
                file(p, "out", "text");
            },
            BAD,
            1,
            "out",
        ),
        case(
            "no folder for the folder",
            moving,
            &["fly", "scene.gltf", "--path", "path.json", "-o", "no/out"],
            1,
            "no/out",
        ),
        case(
            "frames of another move",
            |p| {
                moving(p);
                fs::create_dir(p.path("out")).unwrap();
                file(p, "out/frame_0002.exr", "");
            },
            BAD,
            1,
            "frame_0002.exr",
        ),
        case("no folder of references", moving, REFS, 1, "refs"),
        case("an empty folder of references", refs, REFS, 1, "frame_0001.exr"),
        case(
            "a broken reference",
            |p| {
                refs(p);
                file(p, "refs/frame_0001.exr", "no picture");
            },
            REFS,
            1,
            "frame_0001.exr",
        ),
        case(
            "a reference of another size",
            |p| {
                refs(p);
                p.succeed(&["render", "builtin:cornell", "--size", "8x9", "-o", "refs/frame_0000.exr", "-q"]);
            },
            REFS,
            1,
            "8x9",
        ),
    ]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written() {
    check(&[case(
        "read-only folder",
        moving,
        &["fly", "scene.gltf", "--path", "path.json", "-o", "/proc/out"],
        1,
        "/proc/out",
    )]);
}
