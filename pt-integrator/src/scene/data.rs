//! A scene as a loader builds it.

use alloc::vec::Vec;

use hashcache_core::geometry::{Geometry, Instance, Mesh};

use super::{
    Camera, Environment, Material, OpacityData, PunctualLight, SceneError, Texture, TriangleShading, validate,
};

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
    /// Second texture coordinates of the vertices, for each triangle in `indices`; or empty.
    pub uv2: Vec<[[f32; 2]; 3]>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Images in `texels`.
    pub textures: Vec<Texture>,
    /// Texels of all textures.
    pub texels: Vec<u32>,
    /// Light from outside, if there is any.
    pub environment: Option<Environment>,
    /// Angle in radians by which the environment is turned about +y, counter-clockwise seen from above: what was at −z
    /// comes to −x at π/2.
    pub environment_rotation: f32,
    /// Lights without extent.
    pub punctual_lights: Vec<PunctualLight>,
    /// Holes in triangles.
    pub opacity: OpacityData,
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
            opacity: self.opacity.view(),
        }
    }

    /// Whether a triangle's material emits, as [`Material::emits`] says.
    ///
    /// # Panics
    /// When the scene does not have the triangle, or the triangle's material.
    pub fn emits(&self, triangle: usize) -> bool {
        self.materials[self.triangle_shading[triangle].material as usize].emits()
    }

    /// How many of a mesh's triangles emit.
    ///
    /// # Panics
    /// When the scene does not have the mesh's triangles, or their materials.
    ///
    /// ```
    /// use hashcache_core::geometry::Mesh;
    /// use pt_integrator::scene::{Material, SceneData, TriangleShading};
    /// let scene = SceneData {
    ///     triangle_shading: vec![TriangleShading::flat(0), TriangleShading::flat(1)],
    ///     materials: vec![Material::lambert([0.5; 3]), Material::emissive([0.0; 3], [1.0; 3])],
    ///     ..SceneData::default()
    /// };
    /// assert_eq!(scene.emitting_triangles(Mesh { first_triangle: 0, triangle_count: 2 }), 1);
    /// ```
    pub fn emitting_triangles(&self, mesh: Mesh) -> u64 {
        let first = mesh.first_triangle as usize;
        (first..first + mesh.triangle_count as usize).filter(|&triangle| self.emits(triangle)).count() as u64
    }

    /// Checks every index, length and number that later code relies on.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn validate(&self) -> Result<(), SceneError> {
        validate::scene(self)
    }
}
