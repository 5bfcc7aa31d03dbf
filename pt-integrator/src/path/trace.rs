//! The loop.

use core::array;
use core::f32::consts::FRAC_1_PI;

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::{PathOutcome, PathSettings, RayCounts, VertexSettings};
use crate::light::{LightSample, may_meet_emitter, sample_light};
use crate::ray::{offset_origin, ray_towards, segment};
use crate::sampling::{Basis, cosine_pdf, power_heuristic, sample_cosine};
use crate::scene::Needs;
use crate::surface::Surface;
use crate::view::SceneView;

/// The instance of `$function::<NEEDS, …>` for a scene's needs.
macro_rules! for_needs {
    ($scene:expr, $function:ident, $($generics:ty),+) => {{
        const T: u32 = Needs::TEXTURES;
        const L: u32 = Needs::TRIANGLE_LIGHTS;
        const E: u32 = Needs::ENVIRONMENT_IMAGE;
        const G: u32 = Needs::GENERAL;
        match $scene.needs().of_loop() {
            0 => $function::<0, $($generics),+>,
            T => $function::<T, $($generics),+>,
            L => $function::<L, $($generics),+>,
            E => $function::<E, $($generics),+>,
            x if x == T | L => $function::<{ T | L }, $($generics),+>,
            x if x == T | E => $function::<{ T | E }, $($generics),+>,
            x if x == L | E => $function::<{ L | E }, $($generics),+>,
            x if x == T | L | E => $function::<{ T | L | E }, $($generics),+>,
            G => $function::<G, $($generics),+>,
            x if x == G | T => $function::<{ G | T }, $($generics),+>,
            x if x == G | L => $function::<{ G | L }, $($generics),+>,
            x if x == G | E => $function::<{ G | E }, $($generics),+>,
            x if x == G | T | L => $function::<{ G | T | L }, $($generics),+>,
            x if x == G | T | E => $function::<{ G | T | E }, $($generics),+>,
            x if x == G | L | E => $function::<{ G | L | E }, $($generics),+>,
            _ => $function::<{ G | T | L | E }, $($generics),+>,
        }
    }};
}
pub(super) use for_needs;

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
    let trace = for_needs!(scene, trace_path_for, C, S);
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
    let settings = VertexSettings::new(*settings);
    let mut outcome = PathOutcome::NONE;
    let mut path = Path::<NEEDS, C, S> { scene, caster, sampler, settings: &settings, counts };
    path.trace::<true>(ray, array::from_mut(&mut outcome), Roulette::ByPixel);
    finish(array::from_mut(&mut outcome), counts);
    outcome
}

/// Most vertices of a path that are kept.
pub const MAX_STORED: usize = 8;

/// Traces one path from a camera ray of unit direction and keeps its first `vertices.len()` vertices, at most
/// [`MAX_STORED`], each with the light that the rest of the path brought to it. Entries behind the path's end become
/// [`PathOutcome::NONE`]; the first holds `emitted` in any case.
///
/// Light that vertex j finds comes to an earlier vertex i through the scatterings at i + 1 … j, so with their albedos;
/// what vertex i finds itself enters its illumination without any albedo.
///
/// Without roulette and with one vertex this is [`trace_path`], bit for bit. Light that is NaN or infinite is dropped
/// with the whole path and counted. Adds to `counts`.
///
/// # Source
/// Roth et al. 2020, eq. 1.
///
/// # Deviation
/// Their equation scatters next-event light once too often, at the vertex that finds it.
///
/// # Panics
/// As [`trace_path`].
pub fn trace_path_vertices<C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    sampler: &mut S,
    ray: &Ray,
    settings: &VertexSettings,
    vertices: &mut [PathOutcome],
    counts: &mut RayCounts,
) {
    let trace = for_needs!(scene, vertices_for, C, S);
    trace(scene, caster, sampler, ray, settings, vertices, counts);
}

fn vertices_for<const NEEDS: u32, C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    sampler: &mut S,
    ray: &Ray,
    settings: &VertexSettings,
    vertices: &mut [PathOutcome],
    counts: &mut RayCounts,
) {
    vertices.fill(PathOutcome::NONE);
    let stored = vertices.len().min(MAX_STORED);
    let vertices = &mut vertices[..stored];
    let mut path = Path::<NEEDS, C, S> { scene, caster, sampler, settings, counts };
    match vertices.len() {
        0 => {}
        1 => path.trace::<true>(ray, vertices, Roulette::ByVertex),
        _ => path.trace::<false>(ray, vertices, Roulette::ByVertex),
    }
    finish(vertices, counts);
}

/// Counts the path, and drops light that is no number.
#[inline]
fn finish(vertices: &mut [PathOutcome], counts: &mut RayCounts) {
    counts.paths += 1;
    if vertices.iter().all(PathOutcome::is_finite) {
        return;
    }
    counts.non_finite += 1;
    for vertex in vertices {
        *vertex = vertex.without_light();
    }
}

/// Which throughput decides whether a path goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Roulette {
    /// From the camera: each path is one pixel's.
    ByPixel,
    /// Behind the last kept vertex.
    ByVertex,
}

/// The ray from a surface to a sampled emitter.
#[inline]
pub(super) fn shadow_ray(surface: &Surface<'_>, light: &LightSample) -> Ray {
    let origin = offset_origin(surface.position, surface.face, light.direction, surface.offset);
    match light.target {
        Some(target) => segment(origin, target),
        None => ray_towards(origin, light.direction),
    }
}

struct Path<'a, 'b, const NEEDS: u32, C, S> {
    scene: &'a SceneView<'b>,
    caster: &'a C,
    sampler: &'a mut S,
    settings: &'a VertexSettings,
    counts: &'a mut RayCounts,
}

/// Where a path's ray ended: the light seen there, weighted against next-event estimation, and the surface.
struct Arrival<'b> {
    emitted: Vec3,
    next: Option<Next<'b>>,
}

/// A further vertex.
struct Next<'b> {
    surface: Surface<'b>,
    distance: f32,
    direction: Vec3,
}

impl<'b, const NEEDS: u32, C: RayCaster, S: Sampler> Path<'_, 'b, NEEDS, C, S> {
    /// `ONE`: only one vertex is kept.
    // Two copies, so that a single vertex lives in registers.
    #[inline(always)]
    fn trace<const ONE: bool>(&mut self, ray: &Ray, vertices: &mut [PathOutcome], roulette: Roulette) {
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(ray) else {
            vertices[0] = PathOutcome::seen(ray.direction, self.scene.outside::<NEEDS>(ray.direction).radiance);
            return;
        };
        let mut surface = Surface::at::<NEEDS>(self.scene, &hit, ray.direction);
        vertices[0] = PathOutcome::seen(ray.direction, surface.emission::<NEEDS>(self.scene));
        let path = self.settings.path;
        if path.max_bounces == 0 {
            return;
        }
        let store = if ONE { 1 } else { vertices.len() };
        let length = self.settings.further() as usize;
        let throughput = surface.albedo::<NEEDS>(self.scene);
        let mut distance = hit.t;
        vertices[0].arrive(&surface, distance, throughput);

        // For each kept vertex, the product of the albedos behind it over the survival probabilities.
        let mut weights = [Vec3::ONE; MAX_STORED];
        let mut depth: usize = 1;
        loop {
            // The kept vertices that light found here may still reach; the last of them has the largest weight.
            let reached = if ONE { 0..1 } else { depth.saturating_sub(length.saturating_add(1))..depth.min(store) };
            let last_kept = reached.end - 1;
            let met = self.next_event(&surface);
            for k in reached.clone() {
                vertices[k].receive(depth == k + 1, weights[k] * met);
            }
            if depth >= path.roulette_depth as usize {
                let weight = weights[last_kept];
                let throughput = match roulette {
                    Roulette::ByPixel => throughput * weight,
                    Roulette::ByVertex => weight,
                };
                let survival = throughput.max_element().min(PathSettings::LARGEST_SURVIVAL);
                if self.sampler.next_1d() >= survival {
                    return;
                }
                for weight in &mut weights[..=last_kept] {
                    *weight /= survival;
                }
            }
            let last = depth == store.saturating_add(length);
            let arrival = self.scatter(&surface, last);
            for k in reached {
                vertices[k].receive(depth == k + 1, weights[k] * arrival.emitted);
            }
            let Some(next) = arrival.next else { return };
            surface = next.surface;
            let albedo = surface.albedo::<NEEDS>(self.scene);
            for weight in &mut weights[..=last_kept] {
                *weight *= albedo;
            }
            if !ONE && depth < store {
                distance += next.distance;
                vertices[depth] = PathOutcome::seen(next.direction, Vec3::ZERO);
                vertices[depth].is_secondary = true;
                vertices[depth].arrive(&surface, distance, throughput * weights[0]);
            } else if weights[last_kept].max_element() <= 0.0 {
                return;
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
        let shadow = shadow_ray(surface, &light);
        self.counts.shadow_asked += 1;
        self.counts.shadow_traced += 1;
        if self.caster.occluded(&shadow) {
            return Vec3::ZERO;
        }
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, cosine_pdf(cosine)) };
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
        if last && self.sees_no_light(&ray) {
            return Arrival { emitted: Vec3::ZERO, next: None };
        }
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(&ray) else {
            let seen = self.scene.outside::<NEEDS>(direction);
            return Arrival { emitted: seen.radiance * power_heuristic(pdf, seen.pdf), next: None };
        };
        if last && NEEDS & Needs::TRIANGLE_LIGHTS == 0 {
            return Arrival { emitted: Vec3::ZERO, next: None };
        }
        let next = Surface::at::<NEEDS>(self.scene, &hit, direction);
        let mut emitted = Vec3::ZERO;
        if NEEDS & Needs::TRIANGLE_LIGHTS != 0 {
            emitted = next.emission::<NEEDS>(self.scene);
            if emitted != Vec3::ZERO {
                // Density of the same direction by next event: by area, times distance² over cosine.
                let density = next.light_density::<NEEDS>(self.scene, emitted);
                let other = density * (hit.t * hit.t) / next.face.dot(direction).abs();
                emitted *= power_heuristic(pdf, other);
            }
        }
        Arrival { emitted, next: (!last).then_some(Next { surface: next, distance: hit.t, direction }) }
    }

    /// Whether nothing that a ray may meet gives light.
    #[inline]
    fn sees_no_light(&self, ray: &Ray) -> bool {
        NEEDS & Needs::ENVIRONMENT_IMAGE == 0
            && !self.scene.header.has_constant_environment()
            && (NEEDS & Needs::TRIANGLE_LIGHTS == 0 || !may_meet_emitter(self.scene.lights, ray))
    }
}
