//! Loading under watch: an answer comes soon, cheaply, in one line.
#![allow(dead_code, reason = "every test file uses another part")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::common::{Gltf, SQUARE, png};

/// Bytes allocated now, and most since the last reset.
static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counted.
struct Counting;

#[expect(unsafe_code, reason = "a global allocator can only be given so; it hands everything to the system's")]
// SAFETY: both calls are the system allocator's with the same arguments; the counters don't touch the memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller's promises are the system allocator's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the pointer came from `alloc` above, so from the system's allocator, with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A file with a bit of everything.
pub fn sample() -> Gltf {
    let mut file = Gltf::triangle();
    let image = png(4, 4, &(0..64).map(|i| i * 4).collect::<Vec<u8>>());
    let (position, normal) = (file.vec3(&SQUARE), file.vec3(&[[0.0, 0.0, 1.0]; 4]));
    let (uv, other) = (file.vec2(&SQUARE.map(|[x, y, _]| [x, y])), file.vec2(&[[0.5; 2]; 4]));
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(8, 8, image::Rgb([90, 120, 200]))
        .write_to(&mut jpeg, image::ImageFormat::Jpeg)
        .unwrap();
    let (view, jpeg) = (file.view(&image), file.view(jpeg.get_ref()));
    file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({"wrapS": 33071}), 0);
    let source = file.push("images", json!({"bufferView": jpeg, "mimeType": "image/jpeg"}));
    file.push("textures", json!({"source": source}));
    let moved =
        json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 0.5, "scale": [2, 3], "texCoord": 1}});
    file.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 0.75], "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "baseColorTexture": {"index": 0, "extensions": moved}, "metallicRoughnessTexture": {"index": 1},
        },
        "normalTexture": {"index": 1, "scale": 0.5, "extensions": moved}, "doubleSided": true,
        "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 1, "texCoord": 1},
        "alphaMode": "MASK", "alphaCutoff": 0.4,
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 5},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0],
                "specularTexture": {"index": 0}, "specularColorTexture": {"index": 1}},
            "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": {"index": 1}},
            "KHR_materials_volume": {"thicknessFactor": 0.1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0]},
            "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 1},
                "clearcoatRoughnessFactor": 0.1, "clearcoatRoughnessTexture": {"index": 1},
                "clearcoatNormalTexture": {"index": 1, "scale": 2, "extensions": moved}},
        },
    });
    file.push(
        "materials",
        json!({"emissiveFactor": [1, 1, 1], "alphaMode": "BLEND", "extensions":
            {"KHR_materials_unlit": {}, "KHR_materials_sheen": {"sheenRoughnessFactor": 0.5}}}),
    );
    file.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}));
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, 0.5, 0], "intensity": 20, "range": 4},
        {"type": "spot", "intensity": 3, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 2},
    ]}});
    file.mesh(json!([
        {"attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "TEXCOORD_1": other},
            "indices": indices, "material": 0},
        {"attributes": {"POSITION": position}, "mode": 6, "material": 1},
    ]));
    let root = file.node(json!({"translation": [1, 2, 3], "children": [2, 3]}));
    assert_eq!(root, 1);
    file.push("nodes", json!({"mesh": 1, "rotation": [0, 0, 0.6, 0.8]}));
    file.push("nodes", json!({"mesh": 1, "scale": [-1, 2, 1]}));
    file.node(json!({"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]}));
    for light in 0..3 {
        let extensions = json!({"KHR_lights_punctual": {"light": light}});
        file.node(json!({"rotation": [0, 0.6, 0, 0.8], "extensions": extensions}));
    }
    file
}

/// How long an answer may take, and how many bytes may be allocated for it at once.
#[derive(Clone, Copy)]
pub struct Bounds {
    pub time: Duration,
    pub bytes: usize,
}

/// For a few kilobytes: with room for a busy machine; decoders' fixed buffers are below it, a count taken at its word is
/// not.
pub const SMALL: Bounds = Bounds { time: Duration::from_secs(1), bytes: 48 << 20 };

/// Loads a scene; whatever it is, an answer comes soon and cheaply.
pub fn survive_scene(path: &Path, bounds: Bounds) {
    let load = || scene::load(path.to_str().unwrap(), &scene::LoadOptions::default());
    match watched(bounds, load) {
        Ok(loaded) => {
            loaded.data.validate().unwrap();
            let numbers = loaded.data.materials.iter().flat_map(|m| {
                [m.base_color, m.emission, m.specular, m.interior, m.surface, m.coat].into_iter().flatten()
            });
            assert!(numbers.chain(loaded.data.punctual_lights.iter().flat_map(light)).all(f32::is_finite));
            assert!(loaded.data.uv2.iter().flatten().flatten().all(|x| x.is_finite()));
        }
        Err(error) => one_line(&error.to_string()),
    }
}

fn light(light: &pt_integrator::scene::PunctualLight) -> impl Iterator<Item = f32> + use<> {
    [light.position, light.direction, light.intensity, light.range].into_iter().flatten()
}

/// Reads a camera file and a path file with this content.
pub fn survive_camera(path: &Path, bounds: Bounds) {
    match watched(bounds, || scene::View::from_file(path)) {
        Ok(view) => assert!(view.position.is_finite() && view.forward.is_finite() && view.fov_y > 0.0),
        Err(error) => one_line(&error.to_string()),
    }
    match watched(bounds, || scene::CameraPath::from_file(path)) {
        Ok(path) => assert!((0..path.frames().min(64)).all(|i| path.frame(i).is_some())),
        Err(error) => one_line(&error.to_string()),
    }
}

fn one_line(error: &str) {
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(!error.chars().any(char::is_control) && error.len() < 2000, "{error:?}");
}

fn watched<T>(bounds: Bounds, work: impl FnOnce() -> T) -> T {
    let before = NOW.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let start = Instant::now();
    let result = work();
    let (taken, peak) = (start.elapsed(), PEAK.load(Ordering::Relaxed).saturating_sub(before));
    assert!(taken < bounds.time, "took {taken:?}");
    assert!(peak < bounds.bytes, "{peak} bytes at once");
    result
}
