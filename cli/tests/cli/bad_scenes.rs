//! Scenes that cannot be rendered.

use std::fs;

use serde_json::json;

use crate::bad_input::{RENDER, case, check, file, good, nothing};
use crate::place::Place;
use crate::scene::Scene;

const RENDER_GLB: &[&str] = &["render", "scene.glb", "--size", "8x8", "-o", "out.png"];

#[test]
fn scene_files() {
    check(&[
        case("missing scene", nothing, RENDER, 1, "scene.gltf"),
        case("a folder as scene", |p| fs::create_dir(p.path("scene.gltf")).unwrap(), RENDER, 1, "scene.gltf"),
        case("empty file", |p| file(p, "scene.gltf", ""), RENDER, 1, "scene.gltf"),
        case("not glTF", |p| file(p, "scene.gltf", "once upon\na time"), RENDER, 1, "scene.gltf"),
        case("no known ending", nothing, &["render", "scene.obj", "-o", "out.png"], 2, "scene.obj"),
        case("unknown built-in scene", nothing, &["render", "builtin:nowhere", "-o", "out.png"], 2, "cornell"),
        case("a built-in scene without name", nothing, &["render", "builtin:", "-o", "out.png"], 2, "cornell"),
        case(
            "truncated JSON",
            |p| {
                let text = Scene::lit_floor().document.to_string();
                file(p, "scene.gltf", &text[..text.len() / 2]);
            },
            RENDER,
            1,
            "scene.gltf",
        ),
        case("truncated GLB header", |p| file(p, "scene.glb", b"glTF\x02\0\0\0"), RENDER_GLB, 1, "scene.glb"),
        case(
            "truncated GLB",
            |p| {
                let bytes = Scene::lit_floor().glb();
                file(p, "scene.glb", &bytes[..bytes.len() - 40]);
            },
            RENDER_GLB,
            1,
            "scene.glb",
        ),
        case(
            "GLB with a huge chunk",
            |p| {
                let mut bytes = Scene::lit_floor().glb();
                bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
                file(p, "scene.glb", bytes);
            },
            RENDER_GLB,
            1,
            "scene.glb",
        ),
        case(
            "missing buffer",
            |p| file(p, "scene.gltf", Scene::lit_floor().document.to_string()),
            RENDER,
            1,
            "scene.bin",
        ),
        case(
            "truncated buffer",
            |p| {
                good(p);
                file(p, "scene.bin", [0; 50]);
            },
            RENDER,
            1,
            "scene.gltf",
        ),
    ]);
}

#[test]
fn scene_contents() {
    check(&[
        case(
            "huge vertex count",
            |p| Scene::lit_floor().set("/accessors/0/count", u32::MAX).write(p),
            RENDER,
            1,
            "/accessors/0",
        ),
        case(
            "count beyond 64 bits of bytes",
            |p| Scene::lit_floor().set("/accessors/2/count", u64::MAX).write(p),
            RENDER,
            1,
            "scene.gltf",
        ),
        case(
            "huge buffer",
            |p| Scene::lit_floor().set("/buffers/0/byteLength", 1_u64 << 60).write(p),
            RENDER,
            1,
            "scene.gltf",
        ),
        case(
            "huge offset",
            |p| Scene::lit_floor().set("/bufferViews/1/byteOffset", u64::MAX - 5).write(p),
            RENDER,
            1,
            "scene.gltf",
        ),
        case(
            "accessor of nowhere",
            |p| Scene::lit_floor().set("/meshes/0/primitives/0/indices", 99).write(p),
            RENDER,
            1,
            "scene.gltf",
        ),
        case("NaN position", |p| with_position(p, f32::NAN), RENDER, 1, "scene.gltf"),
        case("infinite position", |p| with_position(p, f32::INFINITY), RENDER, 1, "scene.gltf"),
        case(
            "index beyond the vertices",
            |p| {
                let mut scene = Scene::lit_floor();
                scene.buffer[96] = 77;
                scene.write(p);
            },
            RENDER,
            1,
            "scene.gltf",
        ),
        case("cyclic nodes", |p| with_children(p, json!([1]), json!([0])), RENDER, 1, "/nodes/"),
        case("a node as its own child", |p| with_children(p, json!([0]), json!([])), RENDER, 1, "/nodes/0"),
        case("a missing child", |p| with_children(p, json!([42]), json!([])), RENDER, 1, "scene.gltf"),
        case(
            "no triangles",
            |p| Scene::lit_floor().set("/scenes/0/nodes", json!([2])).write(p),
            RENDER,
            1,
            "triangles",
        ),
        case(
            "no light",
            |p| Scene::lit_floor().set("/materials/1/emissiveFactor", json!([0, 0, 0])).write(p),
            RENDER,
            1,
            "--env",
        ),
        case("no camera", |p| Scene::lit_floor().set("/scenes/0/nodes", json!([0, 1])).write(p), RENDER, 1, "--camera"),
        case(
            "a name over two lines",
            |p| Scene::lit_floor().set("/buffers/0/uri", "no\nsuch\u{1b}[31m file").write(p),
            RENDER,
            1,
            "scene.gltf",
        ),
    ]);
}

fn with_position(place: &Place, x: f32) {
    let mut scene = Scene::lit_floor();
    scene.buffer[12..16].copy_from_slice(&x.to_le_bytes());
    scene.write(place);
}

fn with_children(place: &Place, of_first: serde_json::Value, of_second: serde_json::Value) {
    Scene::lit_floor().set("/nodes/0/children", of_first).set("/nodes/1/children", of_second).write(place);
}
