//! The emitters of a scene and the chance of each to be sampled.

use alloc::vec::Vec;

use hashcache_core::float;
use hashcache_core::geometry::Mesh;

use super::candidate::{Candidate, candidate, mean_emissions};
use super::shares::Shares;
use super::{AliasEntry, EnvironmentTables, TriangleLight, build_alias, triangle_density};
use crate::packed::{SceneInstance, SceneTriangle};
use crate::scene::{Environment, Material, NONE, PunctualLight, SceneData};

/// Emissive triangles and lights without extent by power, and the environment beside them.
#[derive(Clone, Debug, Default)]
pub struct LightList {
    /// Every (instance, triangle) that emits and has an area; in a scene with emission textures those without one too,
    /// so that a hit finds its light.
    pub triangles: Vec<TriangleLight>,
    /// Lights without extent, each with the probability of its choice in `range[1]`.
    pub punctual: Vec<PunctualLight>,
    /// Chooses one of `triangles` and, behind them, `punctual` by power.
    pub alias: Vec<AliasEntry>,
    /// What a radiance's luminance is multiplied by to give the density of its triangles' points by area.
    pub density_per_luminance: f32,
    /// Chance that a sample goes to the environment image.
    pub environment_probability: f32,
    /// Tables of the environment image, if there is one that is not black.
    pub environment: Option<EnvironmentTables>,
    /// Cosine and sine of the angle by which the environment is turned.
    pub rotation: [f32; 2],
    /// For each of `triangles` its index in the scene, when one of them has an emission texture; else empty.
    pub emitters: Vec<u32>,
}

impl LightList {
    /// The emitters of a scene; `radius` is that of a sphere about it, for the power of what shines from outside.
    /// Writes each triangle's [`SceneTriangle::emitter`] and each instance's [`SceneInstance::first_light`].
    pub(crate) fn new(
        scene: &SceneData,
        triangles: &mut [SceneTriangle],
        instances: &mut [SceneInstance],
        materials: &[Material],
        radius: f32,
    ) -> Self {
        let textured = materials.iter().any(|m| m.emits() && m.textures[Material::EMISSION] != NONE);
        let means = if textured { mean_emissions(scene, triangles, materials) } else { Vec::new() };
        number_emitters(&scene.meshes, triangles, materials, &means);
        let found = candidates(&scene.meshes, triangles, instances, materials, &means);
        let (environment, rotation) = environment(scene);
        let list = Self { environment, rotation, ..Self::default() };

        // All powers over π: π·area·radiance of a triangle, and flux through the scene's cross-section π·radius².
        let squared = f64::from(radius) * f64::from(radius);
        let mut weights: Vec<f64> = found.iter().map(Candidate::weight).collect();
        weights.extend(scene.punctual_lights.iter().map(|light| light.power_over_pi(squared)));
        let sky = list.environment.as_ref().map_or(0.0, |tables| tables.flux * squared);
        let shares = Shares::new(&mut weights, found.len(), &scene.punctual_lights, sky);
        let scale = shares.density_per_power as f32;
        let power: f64 = weights.iter().sum();
        if !(power > 0.0 && scale >= 0.0 && scale.is_finite()) {
            let environment_probability = if list.environment.is_some() { 1.0 } else { 0.0 };
            return Self { environment_probability, ..list };
        }
        let lights = found.iter().map(|c| {
            let mut light = c.light;
            light.edge1[3] = triangle_density(c.radiance, c.sides > 1.0, scale);
            light
        });
        let listed = 1.0 - shares.environment;
        let chosen = weights[found.len()..].iter().map(|weight| (weight / power * listed) as f32);
        let punctual = scene.punctual_lights.iter().zip(chosen).map(|(light, chosen)| {
            let mut light = *light;
            light.range[1] = chosen;
            light
        });
        Self {
            triangles: lights.collect(),
            punctual: punctual.collect(),
            alias: build_alias(&weights),
            density_per_luminance: scale,
            environment_probability: shares.environment as f32,
            emitters: if textured { found.iter().map(|c| c.triangle).collect() } else { Vec::new() },
            ..list
        }
    }
}

/// Tables of the scene's environment image, and cosine and sine of its angle.
fn environment(scene: &SceneData) -> (Option<EnvironmentTables>, [f32; 2]) {
    let (sine, cosine) = float::sin_cos(scene.environment_rotation);
    let tables = match &scene.environment {
        Some(Environment::Image(image)) => EnvironmentTables::new(image),
        _ => None,
    };
    (tables, [cosine, sine])
}

/// Whether a triangle emits anywhere; `means` as of [`mean_emissions`].
fn emits(triangle: usize, material: &Material, means: &[f32]) -> bool {
    material.emits() && (material.textures[Material::EMISSION] == NONE || means[triangle] > 0.0)
}

fn run(mesh: Mesh) -> core::ops::Range<usize> {
    mesh.first_triangle as usize..(mesh.first_triangle + mesh.triangle_count) as usize
}

fn number_emitters(meshes: &[Mesh], triangles: &mut [SceneTriangle], materials: &[Material], means: &[f32]) {
    for mesh in meshes {
        let mut next = 0;
        for index in run(*mesh) {
            let triangle = &mut triangles[index];
            triangle.emitter = NONE;
            if emits(index, &materials[triangle.material as usize], means) {
                triangle.emitter = next;
                next += 1;
            }
        }
    }
}

fn candidates(
    meshes: &[Mesh],
    triangles: &[SceneTriangle],
    instances: &mut [SceneInstance],
    materials: &[Material],
    means: &[f32],
) -> Vec<Candidate> {
    let mut found = Vec::new();
    for instance in instances {
        instance.first_light = found.len() as u32;
        for index in run(meshes[instance.mesh as usize]) {
            let triangle = &triangles[index];
            let material = &materials[triangle.material as usize];
            if triangle.emitter == NONE {
                continue;
            }
            // With textures, hits count on every emitter having its place.
            let mean = means.get(index).copied();
            found.extend(candidate(index as u32, triangle, instance, material, mean));
        }
    }
    found
}
