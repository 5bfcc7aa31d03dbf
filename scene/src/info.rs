//! What a scene holds, in numbers.

use pt_integrator::scene::{NONE, SceneData};

use crate::builder::Builder;

/// Figures of a loaded scene.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Info {
    /// Triangles as seen: those of a mesh count once for each of its instances.
    pub triangles: u64,
    /// Triangles as stored.
    pub stored_triangles: u64,
    /// Stored triangles whose corners lie on a line (in f32). They are kept and never hit.
    pub degenerate: u64,
    /// Smallest and largest coordinates, metres, in the file's own coordinates. Of instances, and of meshes under a
    /// rotation, the box around their transformed box.
    pub extent: [[f64; 3]; 2],
    /// Runs of triangles that are placed as one. All meshes placed once are together in the first.
    pub meshes: usize,
    /// Placed meshes.
    pub instances: usize,
    /// Materials in use.
    pub materials: usize,
    /// Textures in use.
    pub textures: usize,
    /// Images decoded for them.
    pub images: usize,
    /// Triangles that emit, as seen.
    pub emissive_triangles: u64,
    /// Lights without extent that give light.
    pub punctual_lights: usize,
    /// Perspective cameras.
    pub cameras: usize,
    /// Extensions that the file says it uses, by name.
    pub extensions: Vec<Extension>,
}

/// A glTF extension that a file uses.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Extension {
    /// Its name.
    pub name: String,
    /// Whether all that it says is respected.
    pub respected: bool,
}

impl Info {
    /// Counts what is in the scene's lists.
    pub(crate) fn count(&mut self, builder: &Builder) {
        let data: &SceneData = &builder.data;
        self.stored_triangles = data.indices.len() as u64;
        self.degenerate = builder.degenerate;
        (self.meshes, self.instances) = (data.meshes.len(), data.instances.len());
        (self.materials, self.textures) = (data.materials.len(), data.textures.len());
        self.punctual_lights = data.punctual_lights.len();
        let emissive: Vec<u64> = data
            .meshes
            .iter()
            .map(|m| {
                let range = m.first_triangle as usize..(m.first_triangle + m.triangle_count) as usize;
                data.triangle_shading[range].iter().filter(|s| s.emitter != NONE).count() as u64
            })
            .collect();
        for instance in &data.instances {
            self.triangles += u64::from(data.meshes[instance.mesh as usize].triangle_count);
            self.emissive_triangles += emissive[instance.mesh as usize];
        }
    }
}
