//! What a scene requires to be rendered; nothing else is modelled.

use pt_integrator::packed::PackedScene;
use pt_integrator::scene::{Environment, Lobes, Material, NONE, Needs as Bits, SceneData};
use serde::Serialize;

/// Roughness from which on a lobe is so wide that light through it is filtered once more.
pub(crate) const LEAST_ROUGHNESS: f32 = layered_filter::front::LEAST_ROUGHNESS;

/// What a scene holds that a frame must model.
#[expect(clippy::struct_excessive_bools, reason = "features are there or not, and stats name each by its key")]
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Needs {
    /// Triangles of all meshes, each counted once.
    pub triangles: u64,
    /// Placed meshes; above 1, rays go through two levels.
    pub instances: u64,
    /// Scattering lobes of the materials: `diffuse`, `reflection`, `transmission`, `coat`.
    pub lobes: Vec<&'static str>,
    /// Whether a lobe that is not diffuse may be so wide that neighbours see the same through it.
    pub rough_lobes: bool,
    /// Whether a material has a texture for what it scatters.
    pub textures: bool,
    /// Whether a material has a normal map.
    pub normal_maps: bool,
    /// Whether an emission has a texture.
    pub emissive_textures: bool,
    /// Whether a triangle has holes by its texture's opacity.
    pub alpha_masks: bool,
    /// Whether a texture reads second coordinates.
    pub second_uv: bool,
    /// Whether normals are interpolated between vertices.
    pub vertex_normals: bool,
    /// Placed triangles that emit.
    pub emissive_triangles: u64,
    /// Lights without extent.
    pub punctual_lights: u64,
    /// `none`, `constant` or `image`.
    pub environment: &'static str,
    /// Vertices one behind another that a sample of a pixel keeps for all its light to be told apart: 1, one more for
    /// what reflects or lets light through, one for the lobe that comes second, and one for the far side of a solid.
    /// What is behind those is seen through the last one.
    pub layers: u32,
}

/// Looks at everything once.
pub fn needs(scene: &SceneData, packed: &PackedScene) -> Needs {
    let bits = packed.needs();
    let emissive_in = |mesh: u32| scene.emitting_triangles(scene.meshes[mesh as usize]);
    let used = used_materials(scene);
    let lobes = used.iter().fold(Lobes::NONE, |lobes, material| lobes | material.lobes());
    let named = [
        (Lobes::DIFFUSE, "diffuse"),
        (Lobes::REFLECTION, "reflection"),
        (Lobes::TRANSMISSION, "transmission"),
        (Lobes::COAT, "coat"),
    ];
    let solid = used.iter().any(|m| m.flags & Material::VOLUME != 0 && m.lobes().contains(Lobes::TRANSMISSION));
    let several = used.iter().any(|m| (m.lobes().bits() & !Lobes::DIFFUSE.bits()).count_ones() > 1);
    let glossy = lobes.bits() & !Lobes::DIFFUSE.bits() != 0;
    Needs {
        triangles: scene.indices.len() as u64,
        instances: scene.instances.len() as u64,
        lobes: named.iter().filter(|(lobe, _)| lobes.contains(*lobe)).map(|(_, name)| *name).collect(),
        rough_lobes: used.iter().any(|material| may_be_rough(material)),
        textures: bits.contains(Bits::TEXTURES),
        normal_maps: bits.contains(Bits::NORMAL_MAPS),
        emissive_textures: bits.contains(Bits::EMISSIVE_TEXTURES),
        alpha_masks: !scene.opacity.masks.is_empty(),
        second_uv: !scene.uv2.is_empty(),
        vertex_normals: scene.triangle_shading.iter().any(|triangle| triangle.normals != [NONE; 3]),
        emissive_triangles: scene.instances.iter().map(|instance| emissive_in(instance.mesh)).sum(),
        punctual_lights: scene.punctual_lights.len() as u64,
        environment: environment(scene),
        layers: 1 + u32::from(glossy) + u32::from(several) + u32::from(solid),
    }
}

/// `none`, `constant` or `image`: what surrounds a scene.
pub fn environment(scene: &SceneData) -> &'static str {
    match scene.environment {
        None => "none",
        Some(Environment::Constant(_)) => "constant",
        Some(Environment::Image(_)) => "image",
    }
}

/// The materials of the triangles.
fn used_materials(scene: &SceneData) -> Vec<&Material> {
    let mut used = vec![false; scene.materials.len()];
    for triangle in &scene.triangle_shading {
        used[triangle.material as usize] = true;
    }
    scene.materials.iter().zip(used).filter_map(|(material, used)| used.then_some(material)).collect()
}

/// Whether one of the material's lobes that are not diffuse may be rough; textures only lower a factor.
fn may_be_rough(material: &Material) -> bool {
    let lobes = material.lobes();
    let base = lobes.contains(Lobes::REFLECTION) || lobes.contains(Lobes::TRANSMISSION);
    base && material.surface[1] >= LEAST_ROUGHNESS || lobes.contains(Lobes::COAT) && material.coat[1] >= LEAST_ROUGHNESS
}

impl Needs {
    /// Whether anything gives light.
    pub fn has_light(&self) -> bool {
        self.emissive_triangles > 0 || self.punctual_lights > 0 || self.environment != "none"
    }

    /// Whether surfaces scatter by more than a diffuse lobe.
    pub fn is_glossy(&self) -> bool {
        self.lobes.iter().any(|lobe| *lobe != "diffuse")
    }
}
