//! What a scene's lights emit, scaled and at most.

use std::f32::consts::FRAC_1_PI;

use pt_integrator::scene::{Environment, Material, SceneData};

/// Distance from a light without extent at which surfaces still count in full, in radii of the scene. Sums hold sixteen
/// times that radiance, so light is clamped from a quarter of this on.
const NEAR: f32 = 1.0 / 32.0;

/// The scene with all light multiplied by `factor`.
pub(crate) fn scaled(data: &SceneData, factor: f32) -> SceneData {
    let mut data = data.clone();
    for material in &mut data.materials {
        let unlit = material.flags & Material::UNLIT != 0;
        let emitted = if unlit { &mut material.base_color } else { &mut material.emission };
        emitted[..3].iter_mut().for_each(|x| *x *= factor);
    }
    for light in &mut data.punctual_lights {
        light.intensity[..3].iter_mut().for_each(|x| *x *= factor);
    }
    if let Some(environment) = &mut data.environment {
        scale_environment(environment, factor);
    }
    data
}

/// All of an environment multiplied by `scale`.
pub(crate) fn scale_environment(environment: &mut Environment, scale: f32) {
    match environment {
        Environment::Constant(color) => color.iter_mut().for_each(|x| *x *= scale),
        Environment::Image(image) => image.texels.iter_mut().flatten().for_each(|x| *x *= scale),
    }
}

/// The largest radiance that anything emits, in a scene of this radius. A light without extent counts by what a white
/// surface near it shows: one facing it at a distance of [`NEAR`] radii.
pub(crate) fn largest(data: &SceneData, radius: f32) -> f32 {
    let emitted = |material: &Material| {
        if material.flags & Material::UNLIT == 0 { material.emission } else { material.base_color }
    };
    let materials = data.materials.iter().map(emitted);
    let near = NEAR * radius;
    let punctual = data.punctual_lights.iter().map(|light| {
        let factor = FRAC_1_PI / if light.is_directional() { 1.0 } else { near * near };
        light.intensity.map(|x| x * factor)
    });
    let environment: Box<dyn Iterator<Item = &f32>> = match &data.environment {
        None => Box::new(std::iter::empty()),
        Some(Environment::Constant(color)) => Box::new(color.iter()),
        Some(Environment::Image(image)) => Box::new(image.texels.iter().flat_map(|texel| texel[..3].iter())),
    };
    let lights = materials.chain(punctual).flat_map(|[r, g, b, _]| [r, g, b]);
    lights.chain(environment.copied()).fold(0.0, f32::max)
}
