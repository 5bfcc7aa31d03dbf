//! The emitters of a scene and the chance of each to be sampled.

use alloc::vec::Vec;

use glam::Vec3;
use hashcache_core::float;
use hashcache_core::geometry::Mesh;

use super::{AliasEntry, EnvironmentTables, TriangleLight, build_alias, luminance, triangle_density};
use crate::packed::{SceneInstance, SceneTriangle};
use crate::scene::{Environment, Material, SceneData};
use crate::surface::{place, triangle_offset};

/// Emissive triangles by power, and the environment beside them.
#[derive(Clone, Debug, Default)]
pub struct LightList {
    /// Every (instance, triangle) that emits and has an area.
    pub triangles: Vec<TriangleLight>,
    /// Chooses one of `triangles` by power.
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

/// Bounds of [`LightList::environment_probability`] when both kinds of emitters exist. Power alone would starve the
/// lamps of a room on a wide ground plane, or the window of a hall full of lamps; either is then found by scattering
/// only.
const ENVIRONMENT_SHARE: (f64, f64) = (0.25, 0.75);

/// A triangle as an emitter, and how much of the light it gives.
struct Candidate {
    light: TriangleLight,
    area: f64,
    radiance: Vec3,
    sides: f64,
}

impl LightList {
    /// The emitters of a scene; `radius` is that of a sphere about it, for the environment's power.
    pub(crate) fn new(
        scene: &SceneData,
        triangles: &[SceneTriangle],
        instances: &[SceneInstance],
        materials: &[Material],
        radius: f32,
    ) -> Self {
        let candidates = candidates(&scene.meshes, triangles, instances, materials);
        let weight = |c: &Candidate| c.area * f64::from(luminance(c.radiance)) * c.sides;
        let power: f64 = candidates.iter().map(weight).sum();
        let environment = match &scene.environment {
            Some(Environment::Image(image)) => EnvironmentTables::new(image),
            _ => None,
        };
        let (sine, cosine) = float::sin_cos(scene.environment_rotation);
        let rotation = [cosine, sine];
        let share = match &environment {
            None => 0.0,
            Some(_) if candidates.is_empty() => 1.0,
            Some(tables) => {
                // Both powers over π: π·area·radiance, and flux through the scene's cross-section π·radius².
                let outside = tables.flux * f64::from(radius) * f64::from(radius);
                (outside / (outside + power)).clamp(ENVIRONMENT_SHARE.0, ENVIRONMENT_SHARE.1)
            }
        };
        let scale = ((1.0 - share) / power) as f32;
        if candidates.is_empty() || !(scale > 0.0 && scale.is_finite()) {
            let environment_probability = if environment.is_some() { 1.0 } else { 0.0 };
            return Self { environment_probability, environment, rotation, ..Self::default() };
        }
        let weights: Vec<f64> = candidates.iter().map(weight).collect();
        let lights = candidates.iter().map(|c| {
            let mut light = c.light;
            light.edge1[3] = triangle_density(c.radiance, c.sides > 1.0, scale);
            light
        });
        Self {
            triangles: lights.collect(),
            alias: build_alias(&weights),
            density_per_luminance: scale,
            environment_probability: share as f32,
            environment,
            rotation,
            emitters: Vec::new(),
        }
    }
}

fn candidates(
    meshes: &[Mesh],
    triangles: &[SceneTriangle],
    instances: &[SceneInstance],
    materials: &[Material],
) -> Vec<Candidate> {
    let mut found = Vec::new();
    for instance in instances {
        let mesh = meshes[instance.mesh as usize];
        let run = mesh.first_triangle as usize..(mesh.first_triangle + mesh.triangle_count) as usize;
        for triangle in &triangles[run] {
            let material = &materials[triangle.material as usize];
            if material.emits() {
                found.extend(candidate(triangle, instance, material));
            }
        }
    }
    found
}

fn candidate(triangle: &SceneTriangle, instance: &SceneInstance, material: &Material) -> Option<Candidate> {
    let corners = place(triangle, instance);
    let [a, b, c] = corners;
    let (edge1, edge2) = (b - a, c - a);
    // Scaled to about 1 first: the square of a small or large triangle's area leaves the range of f32.
    let scale = edge1.abs().max(edge2.abs()).max_element();
    let normal = (edge1 / scale).cross(edge2 / scale);
    let length = float::sqrt(normal.length_squared());
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let normal = normal * (if instance.is_mirrored() { -1.0 } else { 1.0 } / length);
    let double_sided = material.flags & Material::DOUBLE_SIDED != 0;
    let [r, g, b, _] = material.emission;
    let extend = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
    Some(Candidate {
        light: TriangleLight {
            vertex: extend(a, triangle_offset(&corners)),
            edge1: extend(edge1, 0.0),
            edge2: extend(edge2, 0.0),
            normal: extend(normal, if double_sided { 1.0 } else { 0.0 }),
            radiance: [r, g, b, 0.0],
        },
        area: f64::from(length) * f64::from(scale) * f64::from(scale) / 2.0,
        radiance: Vec3::new(r, g, b),
        sides: if double_sided { 2.0 } else { 1.0 },
    })
}
