//! A scene as a loader builds it.

use alloc::vec::Vec;

use hashcache_core::geometry::{Geometry, Instance, Mesh};

use super::{Camera, Environment, Material, SceneError, Texture, TriangleShading, validate};

/// A whole scene in lists. Indices point into the other lists; [`SceneData::validate`] checks them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneData {
    /// Vertex positions, in the space of their mesh.
    pub positions: Vec<[f32; 3]>,
    /// Triangles: three indices into `positions`, counter-clockwise seen from the front.
    pub indices: Vec<[u32; 3]>,
    /// Runs of triangles that are placed as one.
    pub meshes: Vec<Mesh>,
    /// Placed meshes.
    pub instances: Vec<Instance>,
    /// One for each triangle in `indices`.
    pub triangle_shading: Vec<TriangleShading>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Images in `texels`.
    pub textures: Vec<Texture>,
    /// Texels of all textures.
    pub texels: Vec<u32>,
    /// Light from outside, if there is any.
    pub environment: Option<Environment>,
    /// Cameras, in the file's order.
    pub cameras: Vec<Camera>,
}

impl SceneData {
    /// The part that a ray caster needs.
    pub fn geometry(&self) -> Geometry<'_> {
        Geometry {
            positions: &self.positions,
            indices: &self.indices,
            meshes: &self.meshes,
            instances: &self.instances,
        }
    }

    /// Checks every index, length and number that later code relies on.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn validate(&self) -> Result<(), SceneError> {
        validate::scene(self)
    }
}
