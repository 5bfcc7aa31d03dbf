//! A small scene as a glTF document, and ways to spoil it.

use std::fs;

use serde_json::{Value, json};

use crate::place::Place;

/// A glTF document and its buffer.
pub struct Scene {
    pub document: Value,
    pub buffer: Vec<u8>,
}

impl Scene {
    /// A floor, a lamp above it that shines down, and a camera that sees the floor.
    pub fn lit_floor() -> Self {
        let floor = [[-1.0_f32, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
        let lamp = [[-0.5_f32, 2.0, -0.5], [0.5, 2.0, -0.5], [0.5, 2.0, 0.5], [-0.5, 2.0, 0.5]];
        let mut buffer: Vec<u8> = floor.iter().chain(&lamp).flatten().flat_map(|x| x.to_le_bytes()).collect();
        buffer.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
        let mesh = |positions: u32, material: u32| json!({"primitives": [{"attributes": {"POSITION": positions}, "indices": 2, "material": material}]});
        let document = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0, 1, 2]}],
            "nodes": [
                {"mesh": 0},
                {"mesh": 1},
                {"camera": 0, "translation": [0.0, 1.0, 2.5], "rotation": [-0.173_648, 0.0, 0.0, 0.984_808]},
            ],
            "cameras": [{"name": "front", "type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01}}],
            "meshes": [mesh(0, 0), mesh(1, 1)],
            "materials": [
                {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0},
                 "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}}},
                {"pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
                 "emissiveFactor": [1.0, 1.0, 1.0],
                 "extensions": {"KHR_materials_specular": {"specularFactor": 0.0},
                                "KHR_materials_emissive_strength": {"emissiveStrength": 5.0}}},
            ],
            "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength"],
            "buffers": [{"uri": "scene.bin", "byteLength": buffer.len()}],
            "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 12}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 0, -1], "max": [1, 0, 1]},
                {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3",
                 "min": [-0.5, 2, -0.5], "max": [0.5, 2, 0.5]},
                {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            ],
        });
        Self { document, buffer }
    }

    /// Changes the value at a JSON pointer, which must be there; the last part may be new in an object.
    pub fn set(mut self, pointer: &str, value: impl Into<Value>) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        let parent = self.document.pointer_mut(parent).expect("a pointer that leads somewhere");
        match parent {
            Value::Array(items) => items[key.parse::<usize>().expect("an index")] = value.into(),
            parent => parent[key] = value.into(),
        }
        self
    }

    /// Takes a key away.
    pub fn without(mut self, key: &str) -> Self {
        self.document.as_object_mut().expect("an object").remove(key).expect("a key that is there");
        self
    }

    /// Writes `scene.gltf` and `scene.bin`.
    pub fn write(&self, place: &Place) {
        fs::write(place.path("scene.gltf"), self.document.to_string()).expect("written");
        fs::write(place.path("scene.bin"), &self.buffer).expect("written");
    }

    /// The same as one binary file.
    pub fn glb(mut self) -> Vec<u8> {
        self.document["buffers"][0].as_object_mut().expect("an object").remove("uri");
        let padded = |mut bytes: Vec<u8>, fill: u8| {
            bytes.resize(bytes.len().next_multiple_of(4), fill);
            bytes
        };
        let json = padded(self.document.to_string().into_bytes(), b' ');
        let buffer = padded(self.buffer, 0);
        let mut file = b"glTF".to_vec();
        let words = [2, (12 + 8 + json.len() + 8 + buffer.len()) as u32, json.len() as u32];
        file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        file.extend(b"JSON");
        file.extend(&json);
        file.extend((buffer.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(&buffer);
        file
    }
}
