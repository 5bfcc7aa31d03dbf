//! The loop.

use core::array;
use core::ops::Range;

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::kept::Kept;
use super::scatters::{Lambert, Scatters};
use super::step::Tracer;
use super::{PathOutcome, PathSettings, RayCounts, VertexSettings};
use crate::bsdf::{Bsdf, Lobe};
use crate::scene::Needs;
use crate::view::SceneView;

/// The instance of `$function::<NEEDS, M, …>` for a scene's needs: one for each set of what Lambertian scenes may need,
/// and one for all others, which asks the scene.
macro_rules! for_needs {
    ($scene:expr, $function:ident, $($generics:ty),+) => {{
        const T: u32 = Needs::TEXTURES;
        const L: u32 = Needs::TRIANGLE_LIGHTS;
        const E: u32 = Needs::ENVIRONMENT_IMAGE;
        match $scene.needs().bits() {
            0 => $function::<0, Lambert, $($generics),+>,
            T => $function::<T, Lambert, $($generics),+>,
            L => $function::<L, Lambert, $($generics),+>,
            E => $function::<E, Lambert, $($generics),+>,
            x if x == T | L => $function::<{ T | L }, Lambert, $($generics),+>,
            x if x == T | E => $function::<{ T | E }, Lambert, $($generics),+>,
            x if x == L | E => $function::<{ L | E }, Lambert, $($generics),+>,
            x if x == T | L | E => $function::<{ T | L | E }, Lambert, $($generics),+>,
            _ => $function::<{ Needs::ALL }, Bsdf, $($generics),+>,
        }
    }};
}
pub(super) use for_needs;

/// Traces one path from a camera ray of unit direction and returns its light, split at the first vertex that scatters
/// by its diffuse lobe.
///
/// At a vertex with several lobes one is chosen, and the path is that lobe's alone. `emitted` holds light that comes to
/// the camera without a diffuse scattering: emitters seen directly, in mirrors, through glass, and by glossy lobes.
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
    let trace = for_needs!(scene, path_for, C, S);
    trace(scene, caster, sampler, ray, *settings, counts)
}

fn path_for<const NEEDS: u32, M: Scatters, C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    sampler: &mut S,
    ray: &Ray,
    settings: PathSettings,
    counts: &mut RayCounts,
) -> PathOutcome {
    let settings = VertexSettings::new(settings);
    let mut outcome = PathOutcome::NONE;
    let tracer = Tracer::<NEEDS, C> { scene, caster, counts };
    let mut path = Path { tracer, sampler, settings: &settings, limits: Limits::OfPixel };
    path.trace::<1, M>(ray, array::from_mut(&mut outcome));
    finish(array::from_mut(&mut outcome), counts);
    outcome
}

/// Most vertices of a path that are kept.
pub const MAX_STORED: usize = 8;

/// Traces one path from a camera ray of unit direction and keeps its first `vertices.len()` vertices that scatter by
/// their diffuse lobe, at most [`MAX_STORED`], each with the light that the rest of the path brought to it. Entries
/// behind the path's end become [`PathOutcome::NONE`]; the first holds `emitted` in any case.
///
/// Light that vertex j finds comes to an earlier vertex i through the scatterings at i + 1 … j, so with their albedos;
/// what vertex i finds itself enters its illumination without any albedo.
///
/// Without roulette and with one vertex this is [`trace_path`], bit for bit, as long as all surfaces are Lambertian:
/// scatterings by other lobes come on top of those that a kept vertex is granted. Light that is NaN or infinite is
/// dropped with the whole path and counted. Adds to `counts`.
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

fn vertices_for<const NEEDS: u32, M: Scatters, C: RayCaster, S: Sampler>(
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
    let tracer = Tracer::<NEEDS, C> { scene, caster, counts };
    let mut path = Path { tracer, sampler, settings, limits: Limits::OfVertex };
    match vertices.len() {
        0 => {}
        1 => path.trace::<1, M>(ray, vertices),
        _ => path.trace::<MAX_STORED, M>(ray, vertices),
    }
    finish(vertices, counts);
}

/// Counts the path, and drops light that is no number.
#[inline]
pub(super) fn finish(vertices: &mut [PathOutcome], counts: &mut RayCounts) {
    counts.paths += 1;
    if vertices.iter().all(PathOutcome::is_finite) {
        return;
    }
    counts.non_finite += 1;
    for vertex in vertices {
        *vertex = vertex.without_light();
    }
}

/// What scatterings and throughput are counted from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Limits {
    /// From the camera: each path is one pixel's.
    OfPixel,
    /// From the last kept vertex.
    OfVertex,
}

struct Path<'a, 'b, const NEEDS: u32, C, S> {
    tracer: Tracer<'a, 'b, NEEDS, C>,
    sampler: &'a mut S,
    settings: &'a VertexSettings,
    limits: Limits,
}

impl<const NEEDS: u32, C: RayCaster, S: Sampler> Path<'_, '_, NEEDS, C, S> {
    /// `STORE`: most vertices that are kept.
    // Two copies, so that a single vertex lives in registers.
    #[inline(always)]
    fn trace<const STORE: usize, M: Scatters>(&mut self, ray: &Ray, vertices: &mut [PathOutcome]) {
        let arrival = self.tracer.look(ray);
        vertices[0] = PathOutcome::seen(ray.direction, arrival.emitted);
        let path = self.settings.path;
        let Some(mut next) = arrival.next else { return };
        if path.max_bounces == 0 {
            return;
        }
        let store = if STORE == 1 { 1 } else { vertices.len() };
        let length = self.settings.further() as usize;
        let mut kept = Kept::<STORE>::new(arrival.weight);
        let mut end = path.max_bounces as usize;
        let mut distance = next.distance;
        let mut eta = 1.0;
        let mut depth: usize = 1;
        loop {
            let surface = &next.surface;
            let material = M::at::<NEEDS>(self.tracer.scene, surface);
            let (lobe, probability) = material.pick(self.sampler);
            let is_diffuse = lobe == Lobe::Diffuse;
            kept.scale(if is_diffuse { material.diffuse_throughput() } else { Vec3::ONE } / probability);
            if is_diffuse && kept.count() < store {
                let (place, throughput) = kept.keep(depth);
                vertices[place].is_secondary = place > 0;
                vertices[place].arrive(surface, distance, (depth - 1 - place) as u32, throughput);
                if self.limits == Limits::OfVertex {
                    // Each holds all that its settings grant, and one scattering more leads to the next one.
                    end = depth.saturating_add(length).saturating_add(store - kept.count());
                }
            } else if kept.last().max_element() <= 0.0 {
                return;
            }
            let reached = kept.reached(depth, length);
            let met = self.tracer.next_event(self.sampler, surface, &material, lobe, next.medium);
            receive(vertices, &kept, reached.clone(), depth, met);
            if depth >= path.roulette_depth as usize {
                let mut carried = match self.limits {
                    Limits::OfPixel => kept.at_camera(),
                    Limits::OfVertex => kept.last(),
                };
                if M::MIXED {
                    // A lobe brings about what its choice cost, and leaving a solid what entering it did.
                    carried *= if is_diffuse { eta * eta } else { eta * eta * probability };
                }
                let survival = carried.max_element().min(PathSettings::LARGEST_SURVIVAL);
                if self.sampler.next_1d() >= survival {
                    return;
                }
                kept.divide(survival);
            }
            let last = depth >= end;
            let arrival = self.tracer.scatter(self.sampler, surface, &material, lobe, next.medium, last);
            receive(vertices, &kept, reached, depth, arrival.emitted);
            let Some(further) = arrival.next else { return };
            if M::MIXED {
                kept.scale(arrival.weight);
                eta *= arrival.eta;
            }
            distance += further.distance;
            next = further;
            depth += 1;
        }
    }
}

/// Light found at scattering `depth`, for the camera or for the kept vertices that it reaches.
#[inline(always)]
fn receive<const STORE: usize>(
    vertices: &mut [PathOutcome],
    kept: &Kept<STORE>,
    reached: Range<usize>,
    depth: usize,
    light: Vec3,
) {
    if kept.count() == 0 {
        vertices[0].emitted += kept.last() * light;
    }
    for place in reached {
        let (weight, own) = kept.of(place, depth);
        vertices[place].receive(own, weight * light);
    }
}
