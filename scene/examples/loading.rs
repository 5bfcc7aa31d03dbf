//! Times loading, and measures the memory it takes: of given scenes, or of one made for it, a million triangles and 201 MB
//! of textures.
//!
//! ```sh
//! cargo run --release -p hashcache-scene --example loading [-- SCENE.gltf…]
//! ```
//! Each scene is loaded in a process of its own, so that its peak is its own.

use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use cpu_time::ProcessTime;
use hashcache_core::float;
use hashcache_core::hash::{pcg2d, to_unit_f32};
use scene::{LoadOptions, Loaded, Progress};
use serde_json::{Value, json};

/// Says that the arguments after it are to be loaded here.
const HERE: &str = "--here";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [first, file] = arguments.as_slice()
        && first == HERE
    {
        return measure(file);
    }
    let folder = tempfile::tempdir()?;
    if arguments.is_empty() {
        println!("making a scene …");
        arguments.push(make(folder.path())?);
    }
    println!("{:>8} {:>8} {:>10} {:>10} {:>6}  scene", "wall s", "CPU-s", "scene MB", "peak MB", "ratio");
    for file in arguments {
        let status = Command::new(std::env::current_exe()?).args([HERE, &file]).status()?;
        if !status.success() {
            return Err(format!("{file}: {status}").into());
        }
    }
    Ok(())
}

/// Loads the scene and prints a row.
fn measure(file: &str) -> Result<(), Box<dyn Error>> {
    let before = peak()?;
    let (start, cpu) = (Instant::now(), ProcessTime::now());
    let steps = std::sync::Mutex::new((0, 0));
    let count = |p: Progress| {
        let mut steps = steps.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if p.what == "textures" { steps.0 += 1 } else { steps.1 += 1 }
    };
    let loaded = scene::load_with_progress(file, &LoadOptions::default(), &count)?;
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let (size, peak) = (bytes(&loaded) as f64 * 1e-6, (peak()? - before) as f64 * 1e-6);
    let ratio = peak / size;
    println!("{wall:8.2} {cpu:8.2} {size:10.1} {peak:10.1} {ratio:6.2}  {file}");
    println!("         {} triangles, {} texels", loaded.info.triangles, loaded.data.texels.len());
    Ok(())
}

/// The process's largest resident size so far.
fn peak() -> Result<u64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).ok_or("no VmHWM in /proc/self/status")?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse()?;
    Ok(kilobytes * 1024)
}

/// The size of the scene's lists.
fn bytes(loaded: &Loaded) -> usize {
    let data = &loaded.data;
    size_of_val(data.positions.as_slice())
        + size_of_val(data.indices.as_slice())
        + size_of_val(data.triangle_shading.as_slice())
        + size_of_val(data.uv2.as_slice())
        + size_of_val(data.texels.as_slice())
        + size_of_val(data.opacity.mask_of_triangle.as_slice())
        + size_of_val(data.opacity.uv.as_slice())
        + data.opacity.alpha.len()
}

/// Texels a side.
const SIDE: u32 = 2048;
/// Images, every second one a PNG.
const IMAGES: u32 = 12;
/// Rows and columns of quads for each image.
const QUADS: [u32; 2] = [204, 205];

/// Writes the scene and gives its path.
fn make(folder: &Path) -> Result<String, Box<dyn Error>> {
    let (mut bin, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    let (mut images, mut textures, mut materials, mut primitives) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut add = |bytes: Vec<u8>, component: u32, kind: &str, count: usize| {
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        let bounds = if kind == "VEC3" { json!([0, 0, 0]) } else { Value::Null };
        let mut accessor =
            json!({"bufferView": views.len() - 1, "componentType": component, "type": kind, "count": count});
        if bounds.is_array() {
            (accessor["min"], accessor["max"]) = (bounds.clone(), bounds);
        }
        accessors.push(accessor);
        bin.extend(bytes);
        accessors.len() - 1
    };
    for i in 0..IMAGES {
        let name = format!("{i}.{}", if i % 2 == 0 { "jpg" } else { "png" });
        picture(i).save(folder.join(&name))?;
        images.push(json!({ "uri": name }));
        textures.push(json!({ "source": i }));
        materials.push(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}));
        let [rows, columns] = QUADS;
        let points = (0..=rows).flat_map(|y| (0..=columns).map(move |x| [x as f32, y as f32]));
        let (mut position, mut uv) = (Vec::new(), Vec::new());
        for [x, y] in points {
            position.push([x * 0.01, float::sin(x * 0.1) * float::cos(y * 0.1) + 4.0 * i as f32, y * 0.01]);
            uv.push([x / columns as f32, y / rows as f32]);
        }
        let count = position.len();
        let normal = vec![[0.0_f32, 1.0, 0.0]; count];
        let mut indices = Vec::new();
        for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
            let a = y * (columns + 1) + x;
            indices.extend([a, a + columns + 1, a + 1, a + 1, a + columns + 1, a + columns + 2]);
        }
        let bytes = |floats: &[f32]| bytemuck::cast_slice(floats).to_vec();
        let position = add(bytes(position.as_flattened()), 5126, "VEC3", count);
        let normal = add(bytes(normal.as_flattened()), 5126, "VEC3", count);
        let uv = add(bytes(uv.as_flattened()), 5126, "VEC2", count);
        let indices = add(bytemuck::cast_slice(&indices).to_vec(), 5125, "SCALAR", indices.len());
        let attributes = json!({"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv});
        primitives.push(json!({"attributes": attributes, "indices": indices, "material": i}));
    }
    let length = bin.len();
    std::fs::write(folder.join("scene.bin"), bin)?;
    let file = folder.join("scene.gltf");
    let text = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": length, "uri": "scene.bin"}],
        "images": images, "textures": textures, "materials": materials,
    });
    std::fs::write(&file, text.to_string())?;
    Ok(file.to_string_lossy().into_owned())
}

/// Something like a photograph: slow changes of colour, edges, and noise of a few steps.
fn picture(seed: u32) -> image::RgbImage {
    image::RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let slow = |k: f32| float::sin(x as f32 * 0.004 * k + y as f32 * 0.003 + seed as f32);
        let edge = if (x / 128 + y / 96) % 2 == 0 { 40.0 } else { 0.0 };
        let noise = to_unit_f32(pcg2d([x, y ^ (seed << 16)])[0]) * 10.0;
        image::Rgb([1.0, 1.7, 2.3].map(|k| (110.0 + 70.0 * slow(k) + edge + noise).clamp(0.0, 255.0) as u8))
    })
}
