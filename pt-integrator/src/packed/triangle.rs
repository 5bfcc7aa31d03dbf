//! What a hit looks up.

use bytemuck::{Pod, Zeroable};
use hashcache_core::geometry::Instance;

/// A corner of a triangle. 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PackedVertex {
    /// Position in the mesh's space.
    pub position: [f32; 3],
    /// Normal in the mesh's space, octahedral.
    pub normal: u32,
}

/// All that shading needs to know of one triangle, in one place: a hit costs two cache lines. 80 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SceneTriangle {
    /// Corners; all three normals [`crate::scene::NONE`]: the triangle's own normal shades.
    pub vertices: [PackedVertex; 3],
    /// Texture coordinates of the corners.
    pub uv: [[f32; 2]; 3],
    /// Index of the material.
    pub material: u32,
    /// Index among the emitting triangles of its mesh, or [`crate::scene::NONE`].
    pub emitter: u32,
}

/// A placed mesh with the map of its normals. 112 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SceneInstance {
    /// Rows of the affine map from the mesh's space to the scene's.
    pub to_scene: [[f32; 4]; 3],
    /// Rows of the map of normals, up to a positive factor: the matrix of cofactors, times the determinant's sign;
    /// w is 0.
    pub normal_to_scene: [[f32; 4]; 3],
    /// Index of the mesh.
    pub mesh: u32,
    /// [`SceneInstance::IDENTITY`], [`SceneInstance::MIRRORED`].
    pub flags: u32,
    /// Index of its first triangle's light; see [`SceneTriangle::emitter`]. Only known in a scene with emission
    /// textures; else 0.
    pub first_light: u32,
    /// Zero.
    pub reserved: u32,
}

impl SceneInstance {
    /// Flag: the mesh stands where it was modelled, so nothing needs to be transformed.
    pub const IDENTITY: u32 = 1;
    /// Flag: the map mirrors, so that the winding turns round.
    pub const MIRRORED: u32 = 2;

    /// An instance with what shading derives from its map.
    pub fn new(instance: &Instance) -> Self {
        let m = &instance.to_scene;
        let cofactor = |r: usize, c: usize| {
            let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
            // In f64: products of small scales leave the range of f32.
            f64::from(m[r1][c1]) * f64::from(m[r2][c2]) - f64::from(m[r1][c2]) * f64::from(m[r2][c1])
        };
        let mirrored = instance.mirrored != 0;
        let mut cofactors = [[0.0_f64; 3]; 3];
        for (r, row) in cofactors.iter_mut().enumerate() {
            for (c, x) in row.iter_mut().enumerate() {
                *x = cofactor(r, c);
            }
        }
        let largest = cofactors.as_flattened().iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let factor = if largest > 0.0 { 1.0 / largest } else { 0.0 } * if mirrored { -1.0 } else { 1.0 };
        let row = |r: [f64; 3]| [(r[0] * factor) as f32, (r[1] * factor) as f32, (r[2] * factor) as f32, 0.0];
        let identity = instance.to_scene == Instance::identity(0).to_scene && !mirrored;
        Self {
            to_scene: instance.to_scene,
            normal_to_scene: cofactors.map(row),
            mesh: instance.mesh,
            flags: if identity { Self::IDENTITY } else { 0 } | if mirrored { Self::MIRRORED } else { 0 },
            first_light: 0,
            reserved: 0,
        }
    }

    /// Whether the map mirrors.
    #[inline]
    pub const fn is_mirrored(&self) -> bool {
        self.flags & Self::MIRRORED != 0
    }
}
