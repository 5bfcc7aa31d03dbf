//! Lights of `KHR_lights_punctual`.

use std::f32::consts::FRAC_PI_2;

use glam::{DAffine3, DVec3, Vec3};
use gltf::json;
use hashcache_core::float;
use json::extensions::scene::khr_lights_punctual::{Light, Type};
use json::validation::Checked;
use pt_integrator::scene::PunctualLight;

use super::document::Document;
use crate::error::SceneError;
use crate::view::unit;
use crate::warning::Warnings;

/// A light and where it stands.
pub(crate) struct PlacedLight {
    /// Index of the light.
    pub light: usize,
    /// From its node's space to the world's.
    pub world: DAffine3,
}

/// The light relative to `origin`. `None` when it gives no light.
pub(crate) fn punctual(
    document: &Document,
    placed: &PlacedLight,
    origin: DVec3,
    warnings: &mut Warnings,
) -> Result<Option<PunctualLight>, SceneError> {
    let at = document.at();
    let place = |rest: &str| format!("/extensions/KHR_lights_punctual/lights/{}{rest}", placed.light);
    let lights: &[Light] = document.root.as_ref();
    let light = lights.get(placed.light).ok_or_else(|| at.malformed(place(""), "does not exist"))?;
    let intensity = light.color.map(|c| c * light.intensity);
    if !intensity.iter().all(|&c| c.is_finite() && c >= 0.0) {
        return Err(at.malformed(place("/intensity"), format!("gives the intensity {intensity:?}")));
    }
    if !intensity.iter().any(|&c| c > 0.0) {
        return Ok(None);
    }
    let Checked::Valid(kind) = light.type_ else { return Err(at.malformed(place("/type"), "is not known")) };
    let position = (placed.world.translation - origin).as_vec3();
    if !position.is_finite() {
        return Err(at.unsupported(place(""), "stands too far from the scene", "scale the scene down"));
    }
    let direction = || -> Result<Vec3, SceneError> {
        let along = unit(-placed.world.matrix3.z_axis);
        let along = along.ok_or_else(|| at.malformed(place(""), "its node's transform does not span space"))?;
        Ok(along.as_vec3().normalize())
    };
    let mut result = match kind {
        Type::Point => PunctualLight::point(position, intensity),
        Type::Directional => PunctualLight::directional(direction()?, intensity),
        Type::Spot => {
            let cone = light.spot.as_ref().ok_or_else(|| at.malformed(place("/spot"), "is missing"))?;
            let (inner, outer) = (cone.inner_cone_angle, cone.outer_cone_angle);
            if !(inner.is_finite() && outer.is_finite()) {
                return Err(at.malformed(place("/spot"), "has an angle that is not finite"));
            }
            let (wide, narrow) = (outer.clamp(0.0, FRAC_PI_2), inner.clamp(0.0, outer.clamp(0.0, FRAC_PI_2)));
            if [wide, narrow].map(f32::to_bits) != [outer, inner].map(f32::to_bits) {
                let what = "cone angles of spot lights are clamped to 0 <= inner <= outer <= 90 degrees";
                warnings.add(what, || place("/spot"));
            }
            let cosines = [narrow, wide].map(float::cos);
            PunctualLight::spot(position, direction()?, intensity, cosines)
        }
    };
    if let Some(range) = light.range.filter(|_| kind != Type::Directional) {
        if range.is_nan() || range <= 0.0 {
            return Err(at.malformed(place("/range"), format!("{range} is not above 0")));
        }
        // An infinite range is none.
        result.range[0] = if range.is_finite() { range } else { 0.0 };
    }
    Ok(Some(result))
}
