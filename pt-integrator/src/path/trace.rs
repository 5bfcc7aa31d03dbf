//! The loop.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::{PathOutcome, PathSettings, RayCounts};
use crate::light::{sample_light, triangle_density};
use crate::ray::{offset_origin, ray_towards, segment};
use crate::sampling::{Basis, cosine_pdf, power_heuristic, sample_cosine};
use crate::scene::Needs;
use crate::surface::Surface;
use crate::view::SceneView;

/// Traces one path from a camera ray of unit direction and returns its light, split at the first vertex.
///
/// Light that is NaN or infinite is dropped with the whole path and counted. Adds to `counts`.
///
/// # Panics
/// When the caster returns a hit on a triangle or instance that the scene does not have.
pub fn trace_path<C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    sampler: &mut S,
    ray: &Ray,
    settings: &PathSettings,
    counts: &mut RayCounts,
) -> PathOutcome {
    const T: u32 = Needs::TEXTURES;
    const L: u32 = Needs::TRIANGLE_LIGHTS;
    const E: u32 = Needs::ENVIRONMENT_IMAGE;
    let trace = match scene.needs().bits() {
        0 => trace_path_for::<0, C, S>,
        T => trace_path_for::<T, C, S>,
        L => trace_path_for::<L, C, S>,
        E => trace_path_for::<E, C, S>,
        x if x == T | L => trace_path_for::<{ T | L }, C, S>,
        x if x == T | E => trace_path_for::<{ T | E }, C, S>,
        x if x == L | E => trace_path_for::<{ L | E }, C, S>,
        _ => trace_path_for::<{ T | L | E }, C, S>,
    };
    trace(scene, caster, sampler, ray, settings, counts)
}

/// [`trace_path`] for scenes whose [`Needs`] are exactly `NEEDS`, decided once for many paths.
///
/// # Panics
/// As [`trace_path`].
pub fn trace_path_for<const NEEDS: u32, C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    sampler: &mut S,
    ray: &Ray,
    settings: &PathSettings,
    counts: &mut RayCounts,
) -> PathOutcome {
    let mut path = Path::<NEEDS, C, S> { scene, caster, sampler, settings, counts };
    let outcome = path.trace(ray);
    path.counts.paths += 1;
    if outcome.is_finite() {
        return outcome;
    }
    path.counts.non_finite += 1;
    outcome.without_light()
}

struct Path<'a, 'b, const NEEDS: u32, C, S> {
    scene: &'a SceneView<'b>,
    caster: &'a C,
    sampler: &'a mut S,
    settings: &'a PathSettings,
    counts: &'a mut RayCounts,
}

/// Where a path's ray ended: the light seen there, weighted against next-event estimation, and the surface.
struct Arrival<'b> {
    emitted: Vec3,
    surface: Option<Surface<'b>>,
}

impl<'b, const NEEDS: u32, C: RayCaster, S: Sampler> Path<'_, 'b, NEEDS, C, S> {
    #[inline]
    fn trace(&mut self, ray: &Ray) -> PathOutcome {
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(ray) else {
            return PathOutcome::seen(ray.direction, self.scene.outside::<NEEDS>(ray.direction).radiance);
        };
        let mut surface = Surface::at(self.scene, &hit, ray.direction);
        let mut outcome = PathOutcome::seen(ray.direction, surface.emission());
        if self.settings.max_bounces == 0 {
            return outcome;
        }
        outcome.has_vertex = true;
        outcome.position = surface.position;
        outcome.distance = hit.t;
        outcome.normal = surface.normal;
        outcome.throughput = surface.albedo::<NEEDS>(self.scene);

        // Product of the albedos behind the first vertex, over the survival probabilities.
        let mut weight = Vec3::ONE;
        let mut depth = 1;
        loop {
            let met = self.next_event(&surface);
            let light = if depth == 1 { &mut outcome.direct } else { &mut outcome.further };
            *light += weight * met;
            if depth >= self.settings.roulette_depth {
                let throughput = (outcome.throughput * weight).max_element();
                let survival = throughput.min(PathSettings::LARGEST_SURVIVAL);
                if self.sampler.next_1d() >= survival {
                    return outcome;
                }
                weight /= survival;
            }
            let last = depth == self.settings.max_bounces;
            let arrival = self.scatter(&surface, last);
            let light = if depth == 1 { &mut outcome.direct } else { &mut outcome.further };
            *light += weight * arrival.emitted;
            let Some(next) = arrival.surface else { return outcome };
            surface = next;
            weight *= surface.albedo::<NEEDS>(self.scene);
            if weight.max_element() <= 0.0 {
                return outcome;
            }
            depth += 1;
        }
    }

    /// Illumination (without the albedo) by one sampled emitter.
    #[inline]
    fn next_event(&mut self, surface: &Surface<'_>) -> Vec3 {
        if NEEDS & Needs::SAMPLED_LIGHTS == 0 {
            return Vec3::ZERO;
        }
        let Some(light) = sample_light::<NEEDS>(self.scene, self.sampler, surface.position) else {
            return Vec3::ZERO;
        };
        let cosine = surface.normal.dot(light.direction);
        if cosine <= 0.0 {
            return Vec3::ZERO;
        }
        let origin = offset_origin(surface.position, surface.face, light.direction, surface.offset);
        let shadow = match light.target {
            Some(target) => segment(origin, target),
            None => ray_towards(origin, light.direction),
        };
        self.counts.shadow_asked += 1;
        self.counts.shadow_traced += 1;
        if self.caster.occluded(&shadow) {
            return Vec3::ZERO;
        }
        let mis = power_heuristic(light.pdf, cosine_pdf(cosine));
        light.radiance * (FRAC_1_PI * cosine * mis / light.pdf)
    }

    /// Goes on by the cosine. The `last` ray only looks for emitters.
    #[inline]
    fn scatter(&mut self, surface: &Surface<'_>, last: bool) -> Arrival<'b> {
        let local = sample_cosine(self.sampler.next_2d());
        let pdf = cosine_pdf(local.z);
        let direction = Basis::new(surface.normal).to_scene(local.truncate(), local.z);
        let origin = offset_origin(surface.position, surface.face, direction, surface.offset);
        let ray = ray_towards(origin, direction);
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(&ray) else {
            let seen = self.scene.outside::<NEEDS>(direction);
            return Arrival { emitted: seen.radiance * power_heuristic(pdf, seen.pdf), surface: None };
        };
        if last && NEEDS & Needs::TRIANGLE_LIGHTS == 0 {
            return Arrival { emitted: Vec3::ZERO, surface: None };
        }
        let next = Surface::at(self.scene, &hit, direction);
        let mut emitted = Vec3::ZERO;
        if NEEDS & Needs::TRIANGLE_LIGHTS != 0 {
            emitted = next.emission();
            if emitted != Vec3::ZERO {
                // Density of the same direction by next event: by area, times distance² over cosine.
                let density =
                    triangle_density(emitted, next.is_double_sided(), self.scene.header.density_per_luminance);
                let other = density * (hit.t * hit.t) / next.face.dot(direction).abs();
                emitted *= power_heuristic(pdf, other);
            }
        }
        Arrival { emitted, surface: (!last).then_some(next) }
    }
}
