//! Command lines that are wrong whatever the files hold.

use crate::bad_input::{case, check, good, nothing};
use crate::place::Place;

#[test]
fn command_lines() {
    check(&[
        case("no command", nothing, &[], 2, "render"),
        case("unknown command", nothing, &["rendr"], 2, "render"),
        case("command not built: view", nothing, &["view", "scene.gltf"], 2, "render, fly, plan, trade, info, compare"),
        case("no scene", nothing, &["render"], 2, "SCENE"),
        case("two scenes", nothing, &["render", "a.gltf", "b.gltf"], 2, "b.gltf"),
        case("unknown option", good, &["render", "scene.gltf", "--frobnicate"], 2, "--frobnicate"),
        case("unknown option with a near one", good, &["render", "scene.gltf", "--chache", "none"], 2, "--cache"),
        case("option not built: --time", good, &["render", "scene.gltf", "--time", "3"], 2, "--time"),
        case("option not built: --preset", good, &["render", "scene.gltf", "--preset", "preview"], 2, "--preset"),
        case("an option of another command", good, &["plan", "scene.gltf", "-o", "x.png"], 2, "-o"),
        case("value not built: --backend", good, &["render", "scene.gltf", "--backend", "wgpu"], 2, "cpu"),
        case("value not built: --integrator", good, &["render", "scene.gltf", "--integrator", "bdpt"], 2, "path"),
        case("value not built: --cache", good, &["render", "scene.gltf", "--cache", "points"], 2, "grid, none"),
        case("value not built: --visibility", good, &["render", "scene.gltf", "--visibility", "cached"], 2, "exact"),
        case("value that does not exist: --filter", good, &["render", "scene.gltf", "--filter", "median"], 2, "none"),
        case("value not built by --set", good, &["render", "scene.gltf", "--set", "cache=surface"], 2, "grid, none"),
        case("a missing value", good, &["render", "scene.gltf", "--cache"], 2, "grid, none"),
        case("an empty value", good, &["render", "scene.gltf", "--cache", ""], 2, "grid, none"),
        case("size 0x0", good, &["render", "scene.gltf", "--size", "0x0"], 2, "--size 0x0"),
        case("size 8x0", good, &["render", "scene.gltf", "--size", "8x0"], 2, "--size 8x0"),
        case("size -8x8", good, &["render", "scene.gltf", "--size", "-8x8"], 2, "--size"),
        case("size in words", good, &["render", "scene.gltf", "--size", "large"], 2, "WIDTHxHEIGHT"),
        case("size beyond the largest", good, &["render", "scene.gltf", "--size", "4294967295x4294967295"], 2, "16384"),
        case("size beyond 64 bits", good, &["render", "scene.gltf", "--size", "99999999999999999999x1"], 2, "16384"),
        case("no samples", good, &["render", "scene.gltf", "--spp", "0"], 2, "--spp 0"),
        case("negative samples", good, &["render", "scene.gltf", "--spp", "-4"], 2, "--spp -4"),
        case("half a sample", good, &["render", "scene.gltf", "--spp", "0.5"], 2, "--spp 0.5"),
        case("too many samples", good, &["render", "scene.gltf", "--spp", "99999999999"], 2, "--spp"),
        case("negative bounces", good, &["render", "scene.gltf", "--max-bounces", "-1"], 2, "--max-bounces"),
        case("negative seed", good, &["render", "scene.gltf", "--seed", "-1"], 2, "--seed"),
        case("negative threads", good, &["render", "scene.gltf", "--threads", "-1"], 2, "--threads"),
        case("NaN scale", good, &["render", "scene.gltf", "--env-scale", "NaN"], 2, "--env-scale"),
        case("infinite scale", good, &["render", "scene.gltf", "--env-scale", "inf"], 2, "--env-scale"),
        case("negative scale", good, &["render", "scene.gltf", "--env-scale", "-1"], 2, "--env-scale"),
        case("an option twice", good, &["render", "scene.gltf", "--spp", "1", "--spp", "2"], 2, "--spp"),
        case("unknown setting", good, &["render", "scene.gltf", "--set", "grid.sel=3"], 2, "grid.cell"),
        case("setting without value", good, &["render", "scene.gltf", "--set", "spp"], 2, "KEY=VALUE"),
        case("setting and option", good, &["render", "scene.gltf", "--spp", "1", "--set", "spp=2"], 2, "spp"),
        case(
            "settings that conflict",
            good,
            &["render", "scene.gltf", "--threads", "2", "--set", "cpu.launcher=serial"],
            2,
            "cpu.launcher=serial",
        ),
    ]);
}

#[cfg(unix)]
#[test]
fn a_name_that_is_not_text() {
    use std::os::unix::ffi::OsStrExt as _;
    let place = Place::new();
    let run = place.command(&["render"]).arg(std::ffi::OsStr::from_bytes(b"\xff.gltf")).output().unwrap();
    assert_eq!(run.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&run.stderr).lines().count(), 1);
}
