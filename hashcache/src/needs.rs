//! What a scene requires to be rendered; nothing else is modelled.

use pt_integrator::scene::{Environment, Material, NONE, SceneData};
use serde::Serialize;

/// What a scene holds that a frame must model.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Needs {
    /// Triangles of all meshes, each counted once.
    pub triangles: u64,
    /// Placed meshes; above 1, rays go through two levels.
    pub instances: u64,
    /// Scattering lobes of the materials.
    pub lobes: Vec<&'static str>,
    /// Whether a material has a base colour texture.
    pub textures: bool,
    /// Whether normals are interpolated between vertices.
    pub vertex_normals: bool,
    /// Placed triangles that emit.
    pub emissive_triangles: u64,
    /// `none`, `constant` or `image`.
    pub environment: &'static str,
}

/// Looks at everything once.
pub fn needs(scene: &SceneData) -> Needs {
    let emissive_in = |mesh: u32| -> u64 {
        let mesh = &scene.meshes[mesh as usize];
        let run = mesh.first_triangle as usize..(mesh.first_triangle + mesh.triangle_count) as usize;
        scene.triangle_shading[run].iter().filter(|triangle| triangle.emitter != NONE).count() as u64
    };
    Needs {
        triangles: scene.indices.len() as u64,
        instances: scene.instances.len() as u64,
        lobes: vec!["diffuse"],
        textures: scene.materials.iter().any(|material| material.textures[Material::BASE_COLOR] != NONE),
        vertex_normals: scene.triangle_shading.iter().any(|triangle| triangle.normals != [NONE; 3]),
        emissive_triangles: scene.instances.iter().map(|instance| emissive_in(instance.mesh)).sum(),
        environment: match scene.environment {
            None => "none",
            Some(Environment::Constant(_)) => "constant",
            Some(Environment::Image(_)) => "image",
        },
    }
}

impl Needs {
    /// Whether anything gives light.
    pub fn has_light(&self) -> bool {
        self.emissive_triangles > 0 || self.environment != "none"
    }
}
