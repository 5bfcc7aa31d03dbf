//! Cameras, environments and images that cannot be read, and outputs that cannot be written.

use std::fs;

use crate::bad_input::{RENDER, case, check, file, good};
use crate::place::Place;

#[test]
fn files_beside_the_scene() {
    const CAMERA: &[&str] = &["render", "scene.gltf", "-o", "out.png", "--camera", "camera.json"];
    const ENV: &[&str] = &["render", "scene.gltf", "-o", "out.png", "--env", "sky.hdr"];
    fn camera(place: &Place, text: &str) {
        good(place);
        file(place, "camera.json", text);
    }
    check(&[
        case("unknown camera", good, &["render", "scene.gltf", "-o", "out.png", "--camera", "back"], 1, "front"),
        case("camera index too large", good, &["render", "scene.gltf", "-o", "out.png", "--camera", "7"], 1, "front"),
        case("missing camera file", good, CAMERA, 1, "camera.json"),
        case("broken camera file", |p| camera(p, "{\"position\": [0,"), CAMERA, 1, "camera.json"),
        case("incomplete camera file", |p| camera(p, "{\"position\": [0, 0, 1]}"), CAMERA, 1, "camera.json"),
        case(
            "camera that looks at itself",
            |p| camera(p, r#"{"position":[0,1,2],"target":[0,1,2],"up":[0,1,0],"fov_y_deg":40}"#),
            CAMERA,
            1,
            "camera.json",
        ),
        case(
            "camera with no opening",
            |p| camera(p, r#"{"position":[0,1,2],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":0}"#),
            CAMERA,
            1,
            "camera.json",
        ),
        case("missing environment", good, ENV, 1, "sky.hdr"),
        case(
            "truncated environment",
            |p| {
                good(p);
                file(p, "sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n");
            },
            ENV,
            1,
            "sky.hdr",
        ),
        case(
            "huge environment",
            |p| {
                good(p);
                file(p, "sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n");
            },
            ENV,
            1,
            "sky.hdr",
        ),
    ]);
}

#[test]
fn outputs() {
    check(&[
        case("unknown ending", good, &["render", "scene.gltf", "-o", "out.bmp"], 2, ".png"),
        case("no ending", good, &["render", "scene.gltf", "-o", "out"], 2, ".png"),
        case("no such folder", good, &["render", "scene.gltf", "-o", "no/out.png"], 1, "no/out.png"),
        case("a file as folder", good, &["render", "scene.gltf", "-o", "scene.bin/out.png"], 1, "scene.bin"),
        case(
            "second output unwritable",
            good,
            &["render", "scene.gltf", "-o", "a.png", "-o", "no/b.png"],
            1,
            "no/b.png",
        ),
        case(
            "statistics unwritable",
            good,
            &["render", "scene.gltf", "-o", "a.png", "--stats", "no/s.json"],
            1,
            "no/s.json",
        ),
        case(
            "output is a folder",
            |p| {
                good(p);
                fs::create_dir(p.path("out.png")).unwrap();
            },
            RENDER,
            1,
            "out.png",
        ),
        case(
            "pictures that nothing makes",
            good,
            &["render", "scene.gltf", "--aov", "aov", "--cache", "none", "--filter", "none"],
            2,
            "cache=none",
        ),
        case("no folder for the folder", good, &["render", "scene.gltf", "--aov", "no/aov"], 1, "no/aov"),
        case("a file as folder of pictures", good, &["render", "scene.gltf", "--aov", "scene.bin"], 1, "scene.bin"),
        case(
            "a picture's name is taken by a folder",
            |p| {
                good(p);
                fs::create_dir_all(p.path("aov/albedo.exr")).unwrap();
            },
            &["render", "scene.gltf", "--size", "8x8", "-o", "out.png", "--aov", "aov", "-q"],
            1,
            "albedo.exr",
        ),
        case("one file for two outputs", good, &["render", "scene.gltf", "-o", "a.png", "-o", "./a.png"], 2, "a.png"),
        case(
            "the default name is taken",
            |p| {
                good(p);
                file(p, "scene.png", "a texture");
            },
            &["render", "scene.gltf"],
            1,
            "-o",
        ),
    ]);
}

#[cfg(target_os = "linux")]
#[test]
fn outputs_of_linux() {
    check(&[
        case("read-only folder", good, &["render", "scene.gltf", "-o", "/proc/out.png"], 1, "/proc/out.png"),
        case(
            "a device as output",
            good,
            &["render", "scene.gltf", "-o", "a.png", "--stats", "/dev/null"],
            1,
            "/dev/null",
        ),
        case(
            "a link as output",
            |p| {
                good(p);
                std::os::unix::fs::symlink("scene.bin", p.path("out.png")).unwrap();
            },
            RENDER,
            1,
            "link",
        ),
    ]);
}

#[test]
fn comparisons() {
    fn two(place: &Place) {
        file(place, "broken.png", b"\x89PNG\r\n\x1a\n rest is missing");
        file(place, "text.exr", "no picture");
        place.succeed(&["render", "builtin:cornell", "--size", "8x8", "-o", "a.png", "--quiet"]);
        place.succeed(&["render", "builtin:cornell", "--size", "8x9", "-o", "b.png", "--quiet"]);
    }
    check(&[
        case("missing image", two, &["compare", "no.png", "a.png"], 1, "no.png"),
        case("missing reference", two, &["compare", "a.png", "no.png"], 1, "no.png"),
        case("broken image", two, &["compare", "broken.png", "a.png"], 1, "broken.png"),
        case("text as image", two, &["compare", "a.png", "text.exr"], 1, "text.exr"),
        case("sizes differ", two, &["compare", "a.png", "b.png"], 1, "8x9"),
        case("no reference", two, &["compare", "a.png"], 2, "REFERENCE"),
    ]);
}
