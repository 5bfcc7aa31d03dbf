//! A direction towards an emitter.

use glam::{Vec2, Vec3};
use hashcache_core::traits::Sampler;

use super::pick_alias;
use crate::sampling::sample_triangle;
use crate::scene::{Material, NONE, Needs};
use crate::texture::sample_texture;
use crate::view::SceneView;

/// A direction in which an emitter may be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction to the emitter.
    pub direction: Vec3,
    /// Where the shadow ray ends; `None`: it leaves the scene.
    pub target: Option<Vec3>,
    /// Radiance that arrives if nothing stands between.
    pub radiance: Vec3,
    /// Density by solid angle, the choice of the emitter included; above 0 and finite.
    pub pdf: f32,
    /// The emitter has no extent: no direction that scattering draws meets it. `pdf` is the probability of its choice
    /// then, and `radiance` the irradiance on a plane that faces it.
    pub is_delta: bool,
}

/// Chooses an emitter of the scene and a point on it, as seen from `from`. `None` when it cannot be seen from there.
///
/// Draws the same numbers whatever it finds, and none in a scene without emitters to sample. `NEEDS` holds the
/// [`Needs`] of the scene, and may hold more; it must have one of [`Needs::SAMPLED_LIGHTS`] in it.
#[inline]
pub fn sample_light<const NEEDS: u32>(
    scene: &SceneView<'_>,
    sampler: &mut impl Sampler,
    from: Vec3,
) -> Option<LightSample> {
    let listed = NEEDS & (Needs::TRIANGLE_LIGHTS | Needs::PUNCTUAL) != 0 && !scene.alias.is_empty();
    let environment = NEEDS & Needs::ENVIRONMENT_IMAGE != 0 && scene.environment.width != 0;
    if !listed {
        return if environment { scene.environment.sample(sampler.next_2d(), 1.0) } else { None };
    }
    let mut choice = sampler.next_2d();
    let u = sampler.next_2d();
    if environment {
        let share = scene.header.environment_probability;
        if choice.x < share {
            return scene.environment.sample(u, share);
        }
        choice.x = (choice.x - share) / (1.0 - share);
    }
    let index = pick_alias(scene.alias, choice) as usize;
    if NEEDS & Needs::PUNCTUAL != 0 && index >= scene.lights.len() {
        return scene.punctual_lights[index - scene.lights.len()].sample(from);
    }
    let sample = scene.lights[index].sample(from, u);
    if NEEDS & Needs::EMISSIVE_TEXTURES == 0 || scene.emitters.is_empty() {
        return sample;
    }
    textured(scene, index, u, sample?)
}

/// The sample with what the triangle's texture shows at its point; `None` where that is black.
#[inline]
fn textured(scene: &SceneView<'_>, light: usize, u: Vec2, sample: LightSample) -> Option<LightSample> {
    let triangle = &scene.triangles[scene.emitters[light] as usize];
    let texture = scene.materials[triangle.material as usize].textures[Material::EMISSION];
    if texture == NONE {
        return Some(sample);
    }
    let texture = &scene.textures[texture as usize];
    let [a, b, c] = scene.coordinates(texture, scene.emitters[light]);
    let weights = sample_triangle(u);
    let uv = a * (1.0 - weights.x - weights.y) + b * weights.x + c * weights.y;
    let radiance = sample.radiance * sample_texture(texture, scene.texels, uv);
    (radiance != Vec3::ZERO).then_some(LightSample { radiance, ..sample })
}
