//! What a scene holds, in numbers.

use pt_integrator::scene::{Lobes, Material, NONE, PunctualLight, SceneData};

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
    /// What the materials ask for.
    pub surfaces: Surfaces,
    /// Triangles that emit, as seen.
    pub emissive_triangles: u64,
    /// Lights without extent that give light: points, spots, directions.
    pub punctual_lights: [usize; 3],
    /// Perspective cameras.
    pub cameras: usize,
    /// Extensions that the file says it uses, by name.
    pub extensions: Vec<Extension>,
}

/// How many materials have what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Surfaces {
    /// Lambertian reflection.
    pub diffuse: usize,
    /// Reflection by microfacets or a mirror.
    pub reflection: usize,
    /// Refraction, or transmission through a thin sheet.
    pub transmission: usize,
    /// A clear coat.
    pub coat: usize,
    /// An inside that refracts and absorbs.
    pub solid: usize,
    /// Emission.
    pub emission: usize,
    /// A normal map.
    pub normal_map: usize,
    /// Holes where opacity is low.
    pub mask: usize,
    /// A colour of their own, whatever the light.
    pub unlit: usize,
}

impl Surfaces {
    fn of(materials: &[Material]) -> Self {
        let count = |what: &dyn Fn(&Material) -> bool| materials.iter().filter(|m| what(m)).count();
        let lobe = |lobe: Lobes| count(&|m| m.lobes().contains(lobe));
        let flag = |flag: u32| count(&|m| m.flags & flag != 0);
        let maps = [Material::NORMAL, Material::CLEARCOAT_NORMAL];
        Self {
            diffuse: lobe(Lobes::DIFFUSE),
            reflection: lobe(Lobes::REFLECTION),
            transmission: lobe(Lobes::TRANSMISSION),
            coat: lobe(Lobes::COAT),
            solid: flag(Material::VOLUME),
            emission: count(&|m| m.emits() && m.flags & Material::UNLIT == 0),
            normal_map: count(&|m| maps.iter().any(|&map| m.textures[map] != NONE)),
            mask: flag(Material::ALPHA_MASK),
            unlit: flag(Material::UNLIT),
        }
    }
}

/// A glTF extension that a file uses.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Extension {
    /// Its name.
    pub name: String,
    /// Whether it is read, as far as the crate's page says. What is not shown of it is named in a warning.
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
        self.surfaces = Surfaces::of(&data.materials);
        let kinds = [PunctualLight::POINT, PunctualLight::SPOT, PunctualLight::DIRECTIONAL].map(f32::to_bits);
        self.punctual_lights =
            kinds.map(|kind| data.punctual_lights.iter().filter(|light| light.position[3].to_bits() == kind).count());
        let emissive: Vec<u64> = data.meshes.iter().map(|&mesh| data.emitting_triangles(mesh)).collect();
        for instance in &data.instances {
            self.triangles += u64::from(data.meshes[instance.mesh as usize].triangle_count);
            self.emissive_triangles += emissive[instance.mesh as usize];
        }
    }
}
