//! Scenes that other people made, where they are present: see [`common::shared_root`].
#![expect(clippy::unreadable_literal, reason = "coordinates as the references print them")]

mod common;

use std::path::PathBuf;

use pt_integrator::scene::{Material, PunctualLight};
use scene::glam::DVec3;
use scene::{LoadOptions, Loaded, View};

/// The folder of shared scenes, or a line that says why the test is skipped.
fn shared(file: &str) -> Option<PathBuf> {
    let path = common::shared_root().join("scenes").join(file);
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

/// File, triangles, triangles without area (`None`: not in their tables), whether it has a camera.
const SCENES: [(&str, u64, Option<u64>, bool); 12] = [
    ("cornell-box/cornell-box.gltf", 38, Some(0), true),
    ("cornell-specular/cornell-specular.gltf", 72_974, None, true),
    ("sunny-blocks/sunny-blocks.gltf", 50, None, true),
    ("country-kitchen/country-kitchen.gltf", 1_050_941, Some(219), true),
    ("living-room/living-room.gltf", 143_163, Some(190), true),
    ("modern-hall/modern-hall.gltf", 31_247, Some(2_432), true),
    ("wooden-staircase/wooden-staircase.gltf", 262_663, Some(155), true),
    ("classroom/classroom.gltf", 103_832, None, true),
    ("khronos-TransmissionTest/TransmissionTest.gltf", 128_775, None, true),
    ("khronos-LightsPunctualLamp/LightsPunctualLamp.gltf", 6_000, None, false),
    ("khronos-ToyCar/ToyCar.gltf", 108_936, None, true),
    ("khronos-GlassVaseFlowers/GlassVaseFlowers.gltf", 14_036, None, false),
];

#[test]
fn triangle_counts_are_those_of_their_table() {
    for (file, triangles, degenerate, camera) in SCENES {
        let Some(loaded) = load(file) else { continue };
        assert_eq!(loaded.info.triangles, triangles, "{file}");
        assert!(degenerate.is_none_or(|d| d == loaded.info.degenerate), "{file}: {:?}", loaded.info);
        assert_eq!(!loaded.cameras.is_empty(), camera, "{file}");
        let warnings: Vec<&str> = loaded.warnings.iter().map(|w| w.what.as_str()).collect();
        let expected = WARNINGS.iter().find(|w| w.0 == file).map_or(&[][..], |w| w.1);
        let named = warnings.iter().zip(expected).all(|(found, expected)| found.contains(expected));
        assert!(warnings.len() == expected.len() && named, "{file}: {warnings:#?}");
        // A Lambertian variant asks for nothing more than it did before there was anything else.
        if degenerate.is_some() {
            let plain = |m: &Material| {
                let rest = Material {
                    base_color: m.base_color,
                    emission: m.emission,
                    flags: m.flags,
                    ..Material::lambert([0.0; 3])
                };
                let texture = m.textures[Material::BASE_COLOR];
                rest.textured(Material::BASE_COLOR, texture) == *m && m.flags & !Material::DOUBLE_SIDED == 0
            };
            assert!(loaded.data.materials.iter().all(plain), "{file}");
        }
    }
}

/// What the files hold beyond what is shown, in the order in which it is named.
const WARNINGS: [(&str, &[&str]); 4] = [
    ("khronos-TransmissionTest/TransmissionTest.gltf", &["KHR_xmp"]),
    ("khronos-LightsPunctualLamp/LightsPunctualLamp.gltf", &["TANGENT", "blended"]),
    ("khronos-ToyCar/ToyCar.gltf", &["occlusion", "KHR_materials_sheen"]),
    ("khronos-GlassVaseFlowers/GlassVaseFlowers.gltf", &["blended", "thickness textures"]),
];

#[test]
fn the_full_variants_load() {
    for (name, warnings) in [
        ("cornell-box", &[][..]),
        ("country-kitchen", &["blended"]),
        ("living-room", &[]),
        ("modern-hall", &[]),
        ("wooden-staircase", &[]),
    ] {
        let Some(full) = load(&format!("{name}/{name}-full.gltf")) else { continue };
        let Some(plain) = load(&format!("{name}/{name}.gltf")) else { continue };
        assert_eq!((full.info.extent, full.info.images), (plain.info.extent, plain.info.images), "{name}");
        assert_eq!(full.data.positions, plain.data.positions, "{name}");
        let found: Vec<&str> = full.warnings.iter().map(|w| w.what.as_str()).collect();
        assert!(found.len() == warnings.len() && found.iter().zip(warnings).all(|(f, w)| f.contains(w)), "{found:#?}");
    }
}

#[test]
fn lights_of_the_sunny_blocks() {
    let Some(loaded) = load("sunny-blocks/sunny-blocks.gltf") else { return };
    let kinds: Vec<f32> = loaded.data.punctual_lights.iter().map(|l| l.position[3]).collect();
    println!("{:?}", loaded.data.punctual_lights);
    assert_eq!(kinds.len(), 3);
    assert!(kinds.contains(&PunctualLight::POINT) && kinds.contains(&PunctualLight::DIRECTIONAL));
}

/// Scene; the reference camera's position, target, up vector and vertical field of view in degrees.
type Pose = (&'static str, [f64; 3], [f64; 3], [f64; 3], f64);

const POSES: [Pose; 5] = [
    ("cornell-box", [278.0, 273.0, -800.0], [278.0, 273.0, -740.0], [0.0, 1.0, 0.0], 39.3077),
    (
        "country-kitchen",
        [1.211, 1.80475, 3.85239],
        [0.7729, 1.76308, 2.95443],
        [-0.018272, 0.999131, -0.037451],
        35.983398,
    ),
    (
        "living-room",
        [5.10518, 0.731065, -2.31789],
        [4.143388, 0.805472, -2.054414],
        [0.071763, 0.997228, -0.019659],
        58.715507,
    ),
    ("modern-hall", [6.91182, 1.65163, 2.55414], [6.011643, 1.65163, 2.118617], [0.0, 1.0, 0.0], 42.995661),
    (
        "wooden-staircase",
        [0.032421, 1.52673, 4.88197],
        [0.024775, 1.571785, 3.883015],
        [0.000345, 0.998985, 0.045054],
        58.54398,
    ),
];

/// The references' cameras are written with six digits.
const POSE_TOLERANCE: f64 = 3e-5;

#[test]
fn cameras_are_those_of_the_references() {
    for (scene, position, target, up, fov) in POSES {
        let Some(loaded) = load(&format!("{scene}/{scene}.gltf")) else { continue };
        let view = loaded.view(None).unwrap();
        let [position, target, up] = [position, target, up].map(DVec3::from);
        let expected = View::look_at(scene.into(), position, target, up, fov.to_radians()).unwrap();
        for (found, expected) in [
            (view.position, position),
            (view.forward, expected.forward),
            (view.up, expected.up),
            (view.right, expected.right),
        ] {
            assert!(found.abs_diff_eq(expected, POSE_TOLERANCE), "{scene}: {found} {expected}");
        }
        assert!((view.fov_y.to_degrees() - fov).abs() < 1e-5, "{scene}");
    }
}

/// Scene, images in use, their texels, mean 8-bit colour (decoded by the Pillow library).
const COLOURS: [(&str, usize, usize, [f64; 3]); 5] = [
    ("country-kitchen", 11, 6_493_185, [182.960, 155.554, 139.395]),
    ("living-room", 4, 4_974_435, [171.242, 112.000, 75.773]),
    ("modern-hall", 3, 2_981_380, [179.525, 108.721, 61.978]),
    ("wooden-staircase", 9, 18_454_838, [145.486, 106.156, 78.606]),
    ("classroom", 3, 3_403_401, [222.880, 171.214, 127.134]),
];

/// Two JPEG decoders may round each texel differently, but hardly in a common direction: at 4:2:0 ours rounds halves up
/// where libjpeg alternates, 1/32 in chroma, 0.06 to 0.1 in blue. A decoder that rounds up twice is off by 0.16 in modern-hall.
const COLOUR_TOLERANCE: f64 = 0.1;

#[test]
fn textures_have_the_mean_colour_that_another_decoder_gives() {
    for (scene, images, texels, expected) in COLOURS {
        let Some(loaded) = load(&format!("{scene}/{scene}.gltf")) else { continue };
        assert_eq!((loaded.info.images, loaded.data.texels.len()), (images, texels), "{scene}");
        for (channel, expected) in expected.into_iter().enumerate() {
            let sum: u64 = loaded.data.texels.iter().map(|t| u64::from(t >> (8 * channel) & 255)).sum();
            let mean = sum as f64 / texels as f64;
            assert!((mean - expected).abs() < COLOUR_TOLERANCE, "{scene} {channel}: {mean} {expected}");
        }
    }
}

#[test]
fn environments_load() {
    for (file, size) in [("living-room/env/sky.exr", None), ("env/venice_sunset_1k.hdr", Some((1024, 512)))] {
        let Some(path) = shared(file) else { continue };
        let (image, warnings) = scene::environment::load(&path, 1.0, &LoadOptions::default()).unwrap();
        assert!(size.is_none_or(|s| s == (image.width, image.height)), "{file}");
        assert_eq!(image.width, 2 * image.height, "{file}");
        assert!(image.texels.iter().any(|t| t[0] > 0.0));
        println!("{file}: {}x{}, {warnings:?}", image.width, image.height);
    }
}

#[test]
fn camera_files_load() {
    for name in ["TransmissionTest", "LightsPunctualLamp", "ToyCar", "GlassVaseFlowers"] {
        let Some(path) = shared(&format!("khronos-{name}/camera.json")) else { continue };
        let view = View::from_file(&path).unwrap();
        assert!((view.fov_y.to_degrees() - 45.0).abs() < 1e-9);
    }
}
