//! Random damage to a small GLB: no panic, no long wait, no large allocation.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use common::{Gltf, SQUARE, png};
use proptest::prelude::*;
use serde_json::json;

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
fn sample() -> Gltf {
    let mut file = Gltf::triangle();
    let image = png(4, 4, &(0..64).collect::<Vec<u8>>());
    let (position, normal) = (file.vec3(&SQUARE), file.vec3(&[[0.0, 0.0, 1.0]; 4]));
    let (uv, indices) = (file.vec2(&[[0.0; 2]; 4]), file.indices(&[0, 1, 2, 0, 2, 3]));
    let view = file.view(&image);
    file.textured_material(json!({"bufferView": view, "mimeType": "image/png"}), json!({"wrapS": 33071}), 0);
    file.push(
        "materials",
        json!({"emissiveFactor": [1, 1, 1], "extensions":
        {"KHR_materials_emissive_strength": {"emissiveStrength": 5}, "KHR_materials_specular": {"specularFactor": 0}}}),
    );
    file.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}));
    file.mesh(json!([
        {"attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv}, "indices": indices, "material": 0},
        {"attributes": {"POSITION": position}, "mode": 6, "material": 1},
    ]));
    let root = file.node(json!({"translation": [1, 2, 3], "children": [2, 3]}));
    assert_eq!(root, 1);
    file.push("nodes", json!({"mesh": 1, "rotation": [0, 0, 0.6, 0.8]}));
    file.push("nodes", json!({"mesh": 1, "scale": [-1, 2, 1]}));
    file.node(json!({"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]}));
    file
}

/// The longest that loading a kilobyte may take, with room for a busy machine.
const SLOWEST: Duration = Duration::from_secs(1);

/// The most that loading a few kilobytes may allocate at once: a decoder's fixed buffers are below it, a count taken
/// at its word is not.
const LARGEST: usize = 48 << 20;

/// Loads the bytes; whatever they are, an answer comes soon and cheaply.
fn survive(bytes: &[u8]) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.glb");
    std::fs::write(&path, bytes).unwrap();
    let before = NOW.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let start = Instant::now();
    let result = scene::load(path.to_str().unwrap(), &scene::LoadOptions::default());
    let (taken, peak) = (start.elapsed(), PEAK.load(Ordering::Relaxed).saturating_sub(before));
    assert!(taken < SLOWEST, "took {taken:?}");
    assert!(peak < LARGEST, "{peak} bytes at once");
    match result {
        Ok(loaded) => loaded.data.validate().unwrap(),
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
}

/// Where the JSON's text ends.
fn text_end(file: &[u8]) -> usize {
    20 + u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut file = sample().glb();
        for (index, value) in changes {
            let i = index.index(file.len());
            file[i] = value;
        }
        survive(&file);
    }

    #[test]
    fn any_digit_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6)) {
        let mut file = sample().glb();
        let digits: Vec<usize> = (20..text_end(&file)).filter(|&i| file[i].is_ascii_digit()).collect();
        for (index, value) in changes {
            file[digits[index.index(digits.len())]] = value;
        }
        survive(&file);
    }

    #[test]
    fn any_number_replaced(which in any::<prop::sample::Index>(), value in prop_oneof![
        Just("0"), Just("-1"), Just("1e300"), Just("4294967295"), Just("4294967296"), Just("18446744073709551615"),
        Just("0.5"), Just("null"), Just("[]"), Just("{}"), Just("\"\""), Just("1000000000"),
    ]) {
        let file = sample().glb();
        let text = std::str::from_utf8(&file[20..text_end(&file)]).unwrap();
        let starts: Vec<usize> = text.match_indices([':', '[', ',']).map(|(i, _)| i + 1)
            .filter(|&i| text[i..].starts_with(|c: char| c.is_ascii_digit())).collect();
        let start = starts[which.index(starts.len())];
        let length = text[start..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap();
        let mut json = format!("{}{value}{}", &text[..start], &text[start + length..]).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = file[..20].to_vec();
        out.extend(&json);
        out.extend(&file[text_end(&file)..]);
        let total = out.len() as u32;
        out[8..12].copy_from_slice(&total.to_le_bytes());
        out[12..16].copy_from_slice(&(json.len() as u32).to_le_bytes());
        survive(&out);
    }

    #[test]
    fn any_piece_cut_out(from in any::<prop::sample::Index>(), length in 1_usize..200) {
        let mut file = sample().glb();
        let from = from.index(file.len());
        let to = (from + length).min(file.len());
        file.drain(from..to);
        survive(&file);
    }
}

#[test]
fn the_sample_itself_loads() {
    let loaded = sample().load().unwrap();
    assert_eq!((loaded.info.triangles, loaded.info.instances, loaded.cameras.len()), (9, 3, 1));
    survive(&sample().glb());
}
