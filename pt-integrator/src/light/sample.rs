//! A direction towards an emitter.

use glam::Vec3;
use hashcache_core::traits::Sampler;

use super::pick_alias;
use crate::scene::Needs;
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
/// Draws the same numbers whatever it finds. `NEEDS` holds the [`Needs`] of the scene; it must have
/// [`Needs::SAMPLED_LIGHTS`] in it.
#[inline]
pub fn sample_light<const NEEDS: u32>(
    scene: &SceneView<'_>,
    sampler: &mut impl Sampler,
    from: Vec3,
) -> Option<LightSample> {
    let triangles = NEEDS & Needs::TRIANGLE_LIGHTS != 0;
    let environment = NEEDS & Needs::ENVIRONMENT_IMAGE != 0;
    if environment && !triangles {
        return scene.environment.sample(sampler.next_2d(), 1.0);
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
    scene.lights[pick_alias(scene.alias, choice) as usize].sample(from, u)
}
