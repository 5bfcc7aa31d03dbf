//! Plain geometry, rays and hits.

mod opacity;
mod opacity_error;

pub use opacity::{Opacity, OpacityMask};
pub use opacity_error::OpacityError;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A ray segment `origin + t·direction`, `t_min < t < t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin in scene units (metres, relative to the scene's origin).
    pub origin: Vec3,
    /// Smallest accepted distance, in units of the direction's length.
    pub t_min: f32,
    /// Direction, of any length above 0.
    pub direction: Vec3,
    /// Largest accepted distance, in units of the direction's length.
    pub t_max: f32,
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray direction's length.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex.
    pub v: f32,
    /// Index of the triangle in [`Geometry::indices`].
    pub triangle: u32,
    /// Index of the instance in [`Geometry::instances`].
    pub instance: u32,
}

/// A run of triangles that is placed as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Mesh {
    /// First triangle in [`Geometry::indices`].
    pub first_triangle: u32,
    /// Number of triangles.
    pub triangle_count: u32,
}

/// A placed mesh.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// Rows of the affine map from the mesh's space to the scene's: `x' = rows[0]·(x, y, z, 1)`, …
    pub to_scene: [[f32; 4]; 3],
    /// Index of the mesh in [`Geometry::meshes`].
    pub mesh: u32,
    /// 1 when the map mirrors (its determinant is negative), so that the winding turns round; else 0.
    pub mirrored: u32,
    /// Zero.
    pub reserved: [u32; 2],
}

impl Instance {
    /// A mesh where it was modelled.
    pub const fn identity(mesh: u32) -> Self {
        Self {
            to_scene: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
            mesh,
            mirrored: 0,
            reserved: [0; 2],
        }
    }

    /// The place of a point of the mesh in the scene.
    pub fn point(&self, p: Vec3) -> Vec3 {
        let row = |r: &[f32; 4]| r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
        Vec3::new(row(&self.to_scene[0]), row(&self.to_scene[1]), row(&self.to_scene[2]))
    }
}

/// Triangle meshes and where they stand; everything a ray caster needs. Indices have been checked by whoever made it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geometry<'a> {
    /// Vertex positions, in the space of their mesh.
    pub positions: &'a [[f32; 3]],
    /// Triangles: three indices into `positions`, counter-clockwise seen from the front.
    pub indices: &'a [[u32; 3]],
    /// Meshes.
    pub meshes: &'a [Mesh],
    /// Placed meshes.
    pub instances: &'a [Instance],
    /// Holes in triangles; [`Opacity::NONE`] where there are none.
    pub opacity: Opacity<'a>,
}
