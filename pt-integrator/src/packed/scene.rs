//! Packing.

use alloc::vec::Vec;

use bytemuck::Pod;
use glam::Vec3;

use super::{PackedVertex, SceneHeader, SceneInstance, SceneTriangle, Section};
use crate::light::{EnvironmentTables, LightList};
use crate::scene::{Environment, EnvironmentImage, Material, NONE, Needs, SceneData, SceneError};
use crate::view::SceneView;

/// The three buffers of a scene.
///
/// # Memory
/// 80 bytes a triangle (24 more with second texture coordinates), 112 an instance, 160 a material, 48 a texture, 4 a
/// texel, 88 an emitting triangle (92 in a scene with emission textures), 72 a punctual light, 21 a texel of the
/// environment image. A million triangles: 80 MB.
///
/// ```
/// use pt_integrator::packed::PackedScene;
/// use pt_integrator::scene::{Environment, SceneData};
/// let scene = SceneData { environment: Some(Environment::Constant([1.0; 3])), ..SceneData::default() };
/// let packed = PackedScene::new(&scene)?;
/// assert_eq!(packed.view().header.constant_environment[0], 1.0);
/// # Ok::<(), pt_integrator::scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PackedScene {
    triangles: Vec<SceneTriangle>,
    words: Vec<u32>,
    texels: Vec<u32>,
}

impl PackedScene {
    /// Packs a scene and builds the tables of its emitters.
    ///
    /// # Errors
    /// Those of [`SceneData::validate`], and [`SceneError::TooLarge`] when the scene buffer's words cannot be
    /// counted in 32 bits.
    pub fn new(scene: &SceneData) -> Result<Self, SceneError> {
        scene.validate()?;
        let mut triangles: Vec<SceneTriangle> = (0..scene.indices.len()).map(|i| triangle(scene, i)).collect();
        if triangles.is_empty() {
            // Bindings cannot be empty. No hit points here.
            triangles.push(bytemuck::Zeroable::zeroed());
        }
        let mut instances: Vec<SceneInstance> = scene.instances.iter().map(SceneInstance::new).collect();
        let materials: Vec<Material> = scene.materials.iter().map(|m| m.resolved()).collect();
        let sphere = bounding_sphere(scene);
        let lights = LightList::new(scene, &mut triangles, &mut instances, &materials, sphere[3]);
        let words = Words::default().scene(scene, &materials, &instances, &lights, sphere)?;
        let texels = if scene.texels.is_empty() { alloc::vec![0] } else { scene.texels.clone() };
        Ok(Self { triangles, words, texels })
    }

    /// What a host program traces.
    ///
    /// # Panics
    /// Never: the sections were laid out by [`PackedScene::new`].
    pub fn view(&self) -> SceneView<'_> {
        SceneView::new(&self.triangles, &self.words, &self.texels).expect("packed here, so every section is inside")
    }

    /// Bytes of the triangle buffer.
    pub fn triangle_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.triangles)
    }

    /// Bytes of the scene buffer.
    pub fn scene_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.words)
    }

    /// Bytes of the texel buffer.
    pub fn texel_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.texels)
    }

    /// What the scene needs of a path tracer.
    pub fn needs(&self) -> Needs {
        self.view().needs()
    }

    /// Adds these bits of [`Needs`] to the scene's: features are then looked for in vain, and the picture stays the
    /// same. To measure what leaving them out saves.
    pub fn force_needs(&mut self, bits: u32) {
        self.words[0] = self.forced_needs(bits);
    }

    /// The first word of [`scene_bytes`](Self::scene_bytes) as [`force_needs`](Self::force_needs) would make it; the other
    /// words stay as they are.
    pub fn forced_needs(&self, bits: u32) -> u32 {
        self.needs().with(bits).bits()
    }
}

fn needs(materials: &[Material], lights: &LightList) -> Needs {
    let bit = |on: bool, bit: u32| if on { bit } else { 0 };
    Needs::of_materials(materials)
        .with(bit(!lights.triangles.is_empty(), Needs::TRIANGLE_LIGHTS))
        .with(bit(lights.environment.is_some(), Needs::ENVIRONMENT_IMAGE))
        .with(bit(!lights.punctual.is_empty(), Needs::PUNCTUAL))
}

fn triangle(scene: &SceneData, index: usize) -> SceneTriangle {
    let shading = &scene.triangle_shading[index];
    let flat = scene.materials[shading.material as usize].shades_flat();
    let normals = if flat { [NONE; 3] } else { shading.normals };
    let vertex =
        |k: usize| PackedVertex { position: scene.positions[scene.indices[index][k] as usize], normal: normals[k] };
    SceneTriangle {
        vertices: [vertex(0), vertex(1), vertex(2)],
        uv: shading.uv,
        material: shading.material,
        emitter: NONE,
    }
}

/// A sphere about the corners of all placed triangles: about their box, so at most √3 too large.
fn bounding_sphere(scene: &SceneData) -> [f32; 4] {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for instance in &scene.instances {
        let mesh = scene.meshes[instance.mesh as usize];
        let run = mesh.first_triangle as usize..(mesh.first_triangle + mesh.triangle_count) as usize;
        for &vertex in scene.indices[run].as_flattened() {
            let p = instance.point(Vec3::from_array(scene.positions[vertex as usize]));
            (low, high) = (low.min(p), high.max(p));
        }
    }
    if low.cmple(high).all() {
        let centre = low * 0.5 + high * 0.5;
        centre.extend((high - centre).length()).to_array()
    } else {
        [0.0; 4]
    }
}

/// The scene buffer while it grows.
#[derive(Default)]
struct Words(Vec<u32>);

impl Words {
    fn section<T: Pod>(&mut self, records: &[T]) -> Section {
        let first_word = self.0.len() as u32;
        if !records.is_empty() {
            self.0.extend_from_slice(bytemuck::cast_slice(records));
        }
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        Section { first_word, count: records.len() as u32 }
    }

    fn scene(
        mut self,
        scene: &SceneData,
        materials: &[Material],
        instances: &[SceneInstance],
        lights: &LightList,
        bounding_sphere: [f32; 4],
    ) -> Result<Vec<u32>, SceneError> {
        const HEADER_WORDS: usize = size_of::<SceneHeader>() / 4;
        self.0.resize(HEADER_WORDS, 0);
        let no_image = EnvironmentImage { width: 0, height: 0, texels: Vec::new() };
        let no_tables = EnvironmentTables { flux: 0.0, ..EnvironmentTables::default() };
        let constant_environment = match &scene.environment {
            Some(Environment::Constant([r, g, b])) => [*r, *g, *b, 0.0],
            _ => [0.0; 4],
        };
        let (image, tables) = match (&scene.environment, &lights.environment) {
            (Some(Environment::Image(image)), Some(tables)) => (image, tables),
            _ => (&no_image, &no_tables),
        };
        let header = SceneHeader {
            needs: needs(materials, lights).bits(),
            environment_probability: lights.environment_probability,
            density_per_luminance: lights.density_per_luminance,
            reserved: 0,
            constant_environment,
            bounding_sphere,
            environment_size: [image.width, image.height],
            instances: self.section(instances),
            materials: self.section(materials),
            textures: self.section(&scene.textures),
            lights: self.section(&lights.triangles),
            alias: self.section(&lights.alias),
            environment_texels: self.section(&image.texels),
            environment_row_density: self.section(&tables.row_density),
            environment_rows: self.section(&tables.rows),
            environment_columns: self.section(&tables.columns),
            environment_guides: self.section(&tables.guides),
            environment_rotation: lights.rotation,
            punctual_lights: self.section(&lights.punctual),
            second_uv: self.section(&scene.uv2),
            emitters: self.section(&lights.emitters),
            padding: [0; 2],
        };
        let limit = u64::from(u32::MAX);
        if self.0.len() as u64 > limit {
            return Err(SceneError::TooLarge { list: "scene buffer", found: self.0.len() as u64, limit });
        }
        self.0[..HEADER_WORDS].copy_from_slice(bytemuck::cast_slice(&[header]));
        Ok(self.0)
    }
}
