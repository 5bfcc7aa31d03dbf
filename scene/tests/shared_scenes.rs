//! Scenes that other people made, where they are present: `HASHCACHE_SHARED`, else `../shared` beside the workspace.

use std::path::{Path, PathBuf};

use scene::{LoadOptions, Loaded};

/// The folder of shared scenes, or a line that says why the test is skipped.
fn shared(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("HASHCACHE_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join("scenes").join(file);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there (set HASHCACHE_SHARED)", path.display());
    None
}

fn load(file: &str) -> Option<Loaded> {
    let path = shared(file)?;
    let start = std::time::Instant::now();
    let loaded = scene::load(&path.to_string_lossy(), &LoadOptions::default());
    let loaded = loaded.unwrap_or_else(|e| panic!("{e}"));
    println!("{file}: {:.3} s, {:?}", start.elapsed().as_secs_f64(), loaded.info);
    for warning in &loaded.warnings {
        println!("  {warning}");
    }
    Some(loaded)
}

/// File, triangles, triangles without area, warnings, and whether it has a camera.
const SCENES: [(&str, u64, u64, bool); 11] = [
    ("cornell-box/cornell-box.gltf", 38, 0, true),
    ("cornell-specular/cornell-specular.gltf", 72_974, 0, true),
    ("sunny-blocks/sunny-blocks.gltf", 50, 0, true),
    ("country-kitchen/country-kitchen.gltf", 1_050_941, 219, true),
    ("living-room/living-room.gltf", 143_163, 190, true),
    ("modern-hall/modern-hall.gltf", 31_247, 2_432, true),
    ("wooden-staircase/wooden-staircase.gltf", 262_663, 155, true),
    ("classroom/classroom.gltf", 103_832, 0, true),
    ("khronos-TransmissionTest/TransmissionTest.gltf", 128_775, 0, true),
    ("khronos-LightsPunctualLamp/LightsPunctualLamp.gltf", 6_000, 0, false),
    ("khronos-GlassVaseFlowers/GlassVaseFlowers.gltf", 14_036, 0, false),
];

#[test]
fn triangle_counts_are_those_of_their_table() {
    for (file, triangles, degenerate, camera) in SCENES {
        let Some(loaded) = load(file) else { continue };
        assert_eq!(loaded.info.triangles, triangles, "{file}");
        let _ = degenerate;
        assert_eq!(!loaded.cameras.is_empty(), camera, "{file}");
    }
}
