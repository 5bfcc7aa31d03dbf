//! What a triangle needs besides its corners.

use bytemuck::{Pod, Zeroable};

use super::NONE;

/// Normals, material and texture coordinates of one triangle. 40 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleShading {
    /// Vertex normals in the mesh's space, octahedral; all three [`NONE`]: the triangle's own normal shades.
    pub normals: [u32; 3],
    /// Index of the material.
    pub material: u32,
    /// Texture coordinates of the three vertices; (0, 0) is the image's upper left corner.
    pub uv: [[f32; 2]; 3],
}

impl TriangleShading {
    /// A flat triangle without texture coordinates.
    pub const fn flat(material: u32) -> Self {
        Self { normals: [NONE; 3], material, uv: [[0.0; 2]; 3] }
    }

    /// Whether the triangle's own normal shades.
    pub fn is_flat(&self) -> bool {
        self.normals == [NONE; 3]
    }
}
