//! Small glTF files made in memory.
#![allow(dead_code, reason = "every test file uses another part")]
#![allow(clippy::needless_pass_by_value, reason = "`json!` gives values")]

use std::path::{Path, PathBuf};

use scene::glam::Vec3;
use scene::{LoadOptions, Loaded, SceneError};
use serde_json::{Value, json};

/// The folder of what others made: `HASHCACHE_SHARED`, else `../shared` beside the workspace. It may be absent.
pub fn shared_root() -> PathBuf {
    std::env::var_os("HASHCACHE_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from)
}

/// A glTF file in the making: its JSON, and one buffer.
#[derive(Clone)]
pub struct Gltf {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub const F32: u32 = 5126;
pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const I8: u32 = 5120;
pub const I16: u32 = 5122;

/// A right triangle in z = 0 whose front is towards +z.
pub const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A square in z = 0, corner by corner.
pub const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

impl Gltf {
    /// A file with a default scene and nothing in it.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [], "buffers": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// A file with one triangle at one node.
    pub fn triangle() -> Self {
        let mut file = Self::new();
        let position = file.vec3(&TRIANGLE);
        let mesh = file.mesh(json!([{"attributes": {"POSITION": position}}]));
        file.node(json!({ "mesh": mesh }));
        file
    }

    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let list = list.as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        self.push("accessors", accessor)
    }

    pub fn vec3(&mut self, values: &[[f32; 3]]) -> usize {
        let index = self.accessor(bytemuck::cast_slice(values), F32, "VEC3", values.len());
        self.json["accessors"][index]["min"] = json!([0.0, 0.0, 0.0]);
        self.json["accessors"][index]["max"] = json!([1.0, 1.0, 1.0]);
        index
    }

    pub fn vec2(&mut self, values: &[[f32; 2]]) -> usize {
        self.accessor(bytemuck::cast_slice(values), F32, "VEC2", values.len())
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        self.accessor(bytemuck::cast_slice(values), U16, "SCALAR", values.len())
    }

    pub fn mesh(&mut self, primitives: Value) -> usize {
        self.push("meshes", json!({ "primitives": primitives }))
    }

    /// Adds a node to the default scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        index
    }

    /// Textures the triangles of `primitive` with an image; returns the material.
    pub fn textured_material(&mut self, image: Value, sampler: Value, tex_coord: u32) -> usize {
        let source = self.push("images", image);
        let sampler = self.push("samplers", sampler);
        let index = self.push("textures", json!({"source": source, "sampler": sampler}));
        let texture = json!({"index": index, "texCoord": tex_coord});
        self.push("materials", json!({"pbrMetallicRoughness": {"baseColorTexture": texture}}))
    }

    /// The file as GLB.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.bin.is_empty() && json["buffers"].as_array().is_some_and(Vec::is_empty) {
            json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        }
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut out = Vec::new();
        let total = 12 + 8 + text.len() + 8 + bin.len();
        for word in [u32::from_le_bytes(*b"glTF"), 2, total as u32, text.len() as u32] {
            out.extend(word.to_le_bytes());
        }
        out.extend(b"JSON");
        out.extend(&text);
        out.extend((bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&bin);
        out
    }

    /// Writes the file as GLB into a folder of its own and loads it.
    pub fn load(&self) -> Result<Loaded, SceneError> {
        load_bytes("scene.glb", &self.glb())
    }
}

/// Writes a file into a folder of its own and loads it.
pub fn load_bytes(name: &str, bytes: &[u8]) -> Result<Loaded, SceneError> {
    let dir = tempfile::tempdir().unwrap();
    load_in(dir.path(), name, bytes)
}

/// Writes a file into the folder and loads it.
pub fn load_in(dir: &Path, name: &str, bytes: &[u8]) -> Result<Loaded, SceneError> {
    let path = dir.join(name);
    std::fs::write(&path, bytes).unwrap();
    scene::load(path.to_str().unwrap(), &LoadOptions::default())
}

/// A PNG file of RGBA texels.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    use image::ImageEncoder as _;
    let mut out = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut out);
    encoder.write_image(rgba, width, height, image::ExtendedColorType::Rgba8).unwrap();
    out
}

/// The checksum of PNG's chunks.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

/// Appends a chunk to a PNG file.
pub fn png_chunk(out: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    out.extend((data.len() as u32).to_be_bytes());
    let start = out.len();
    out.extend(kind);
    out.extend(data);
    let sum = crc32(&out[start..]);
    out.extend(sum.to_be_bytes());
}

/// The corners of a triangle as placed, relative to the scene's origin.
pub fn corners(loaded: &Loaded, instance: usize, triangle: usize) -> [Vec3; 3] {
    let data = &loaded.data;
    let instance = &data.instances[instance];
    let first = data.meshes[instance.mesh as usize].first_triangle as usize;
    let corner = |i: u32| instance.point(data.positions[i as usize].into());
    let corners = data.indices[first + triangle].map(corner);
    if instance.mirrored == 1 { [corners[0], corners[2], corners[1]] } else { corners }
}

/// Unit vector to a triangle's front.
pub fn front(loaded: &Loaded, instance: usize, triangle: usize) -> Vec3 {
    let [a, b, c] = corners(loaded, instance, triangle);
    (b - a).cross(c - a).normalize()
}

/// Whether one of the warnings contains `text`, and where.
pub fn warned<'a>(loaded: &'a Loaded, text: &str) -> Option<&'a str> {
    loaded.warnings.iter().find(|w| w.what.contains(text)).map(|w| w.pointer.as_str())
}
