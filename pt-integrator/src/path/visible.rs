//! First vertices with direct light and nothing else.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::trace::{for_needs, shadow_ray};
use super::{PathOutcome, RayCounts};
use crate::light::{LightSample, MAX_TRIED, luminance, may_meet_emitter, sample_light};
use crate::ray::{offset_origin, ray_towards};
use crate::sampling::{Basis, cosine_pdf, power_heuristic, sample_cosine};
use crate::scene::Needs;
use crate::surface::Surface;
use crate::view::SceneView;

/// How direct light is found: by next event and by scattering, weighted against each other.
///
/// # Source
/// Veach 1997, 9.2 (several samples of each strategy, power heuristic). Talbot et al. 2005 (resampled importance
/// sampling): of many candidates, chosen by the emitters' power, some are picked in proportion to the light that they
/// would bring without obstacles, and only these cast a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectSettings {
    /// Shadow rays a vertex. At most [`DirectSettings::MAX_CANDIDATES`].
    pub samples: u32,
    /// Candidates for each shadow ray, at least 1 (the emitters' power alone decides). Their number in all is at most
    /// [`DirectSettings::MAX_CANDIDATES`].
    pub candidates: u32,
    /// Rays in proportion to the cosine. Without any, noise near emitters has no bound.
    pub scattered: u32,
}

/// What a sampler's numbers are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// Candidates for shadow rays.
    NextEvent,
    /// Rays in proportion to the cosine.
    Scattering,
}

impl DirectSettings {
    /// Most candidates of a vertex, `samples · candidates`; what is asked beyond is left out.
    pub const MAX_CANDIDATES: u32 = 64;

    /// No direct light.
    pub const NONE: Self = Self { samples: 0, candidates: 1, scattered: 0 };

    /// What was found to give the least error for its time with `samples` shadow rays: two candidates where there are
    /// more emitters than [`MAX_TRIED`]; under an environment image, of which indoors a window shows a part, as many
    /// scattered rays as shadow rays, else half as many.
    pub fn new(samples: u32, scene: &SceneView<'_>) -> Self {
        let candidates = if scene.lights.len() > MAX_TRIED { 2 } else { 1 };
        let image = scene.needs().contains(Needs::ENVIRONMENT_IMAGE);
        Self { samples, candidates, scattered: if image { samples } else { samples.div_ceil(2) } }.for_scene(scene)
    }

    /// Candidates of a vertex in all, in their bounds.
    ///
    /// ```
    /// use pt_integrator::path::DirectSettings;
    /// let three = DirectSettings { samples: 3, ..DirectSettings::NONE };
    /// assert_eq!(DirectSettings { candidates: 4, ..three }.all(), 12);
    /// assert_eq!(DirectSettings { candidates: 1000, ..three }.all(), 63);
    /// ```
    #[inline]
    pub const fn all(&self) -> u32 {
        match self.shadow_rays() {
            0 => 0,
            samples => {
                let most = Self::MAX_CANDIDATES / samples;
                samples
                    * if self.candidates == 0 {
                        1
                    } else if self.candidates < most {
                        self.candidates
                    } else {
                        most
                    }
            }
        }
    }

    /// The settings by which this scene's emitters are all found: next event finds no constant environment, so at least
    /// one ray scatters there, and where there is nothing else, all do. [`DirectSettings::NONE`] stays.
    #[must_use]
    pub fn for_scene(self, scene: &SceneView<'_>) -> Self {
        let sky = scene.header.has_constant_environment();
        let (samples, scattered) = (self.shadow_rays(), self.scattered.min(Self::MAX_CANDIDATES));
        if !scene.has_sampled_lights() {
            return Self { samples: 0, scattered: if sky { samples + scattered } else { 0 }, ..self };
        }
        let least = u32::from(sky && samples > 0);
        Self { samples, scattered: scattered.max(least), ..self }
    }

    #[inline]
    const fn shadow_rays(&self) -> u32 {
        if self.samples < Self::MAX_CANDIDATES { self.samples } else { Self::MAX_CANDIDATES }
    }
}

/// Traces a camera ray of unit direction to its first vertex and finds the light that comes there straight from
/// emitters: an estimate of [`PathOutcome::direct`] of the same mean as [`super::trace_path`]'s. `further` is 0. The
/// settings are taken as they are: see [`DirectSettings::for_scene`].
///
/// `numbers(strategy, i)` makes the sampler of candidate or ray i. Consecutive indices are stratified together, so a
/// caller passes on indices that go on from sample to sample of a pixel: `Sobol::new(sample · n + i, seed)`, n being
/// [`DirectSettings::all`] or [`DirectSettings::scattered`], with a seed for each strategy. Adds to `counts`. Light
/// that is NaN or infinite is dropped and counted.
///
/// # Panics
/// As [`super::trace_path`].
pub fn trace_visible<C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &DirectSettings,
    numbers: impl FnMut(Strategy, u32) -> S,
    counts: &mut RayCounts,
) -> PathOutcome {
    let trace = for_needs!(scene, visible_for, C, S, _);
    trace(scene, caster, ray, settings, numbers, counts)
}

fn visible_for<const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32) -> S>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &DirectSettings,
    mut numbers: N,
    counts: &mut RayCounts,
) -> PathOutcome {
    counts.paths += 1;
    counts.closest += 1;
    let Some(hit) = caster.closest(ray) else {
        return PathOutcome::seen(ray.direction, scene.outside::<NEEDS>(ray.direction).radiance);
    };
    let surface = Surface::at::<NEEDS>(scene, &hit, ray.direction);
    let mut outcome = PathOutcome::seen(ray.direction, surface.emission::<NEEDS>(scene));
    outcome.arrive(&surface, hit.t, surface.albedo::<NEEDS>(scene));
    let mut direct = Direct::<NEEDS, C> { scene, caster, surface: &surface, settings, counts };
    outcome.direct = direct.next_event(|i| numbers(Strategy::NextEvent, i));
    for i in 0..settings.scattered {
        let seen = direct.scattered(&mut numbers(Strategy::Scattering, i));
        outcome.direct += seen / settings.scattered as f32;
    }
    if outcome.is_finite() {
        return outcome;
    }
    counts.non_finite += 1;
    outcome.without_light()
}

/// A candidate: the light it brings if nothing stands between, divided by its density, and where it comes from.
#[derive(Clone, Copy)]
struct Candidate {
    light: LightSample,
    weight: f32,
}

/// Illumination by emitters.
struct Direct<'a, 'b, const NEEDS: u32, C> {
    scene: &'a SceneView<'b>,
    caster: &'a C,
    surface: &'a Surface<'b>,
    settings: &'a DirectSettings,
    counts: &'a mut RayCounts,
}

impl<const NEEDS: u32, C: RayCaster> Direct<'_, '_, NEEDS, C> {
    fn next_event<S: Sampler>(&mut self, mut numbers: impl FnMut(u32) -> S) -> Vec3 {
        let (samples, all) = (self.settings.shadow_rays(), self.settings.all());
        if samples == 0 || NEEDS & Needs::SAMPLED_LIGHTS == 0 {
            return Vec3::ZERO;
        }
        let nothing =
            LightSample { direction: Vec3::ZERO, target: None, radiance: Vec3::ZERO, pdf: 1.0, is_delta: false };
        let mut candidates = [Candidate { light: nothing, weight: 0.0 }; DirectSettings::MAX_CANDIDATES as usize];
        let candidates = &mut candidates[..all as usize];
        let mut total = 0.0;
        let mut start = 0.0;
        for (i, candidate) in (0..).zip(candidates.iter_mut()) {
            let mut sampler = numbers(i);
            if let Some(light) = sample_light::<NEEDS>(self.scene, &mut sampler, self.surface.position) {
                let cosine = self.surface.normal.dot(light.direction).max(0.0);
                let mis = self.weight_of_next_event(light.pdf, cosine_pdf(cosine));
                let mis = if light.is_delta { 1.0 } else { mis };
                let weight = luminance(light.radiance) * (FRAC_1_PI * cosine * mis / light.pdf);
                *candidate = Candidate { light, weight };
                total += weight;
            }
            if i == 0 {
                start = sampler.next_1d();
            }
        }
        if !(total > 0.0 && total <= f32::MAX) {
            // No light, or no number: the sum says which.
            return Vec3::splat(total);
        }
        // Systematic resampling: steps of equal length through the weights from a random start.
        let step = total / samples as f32;
        let mut next = start * step;
        let mut sum = Vec3::ZERO;
        let mut passed = 0.0;
        for candidate in candidates.iter() {
            passed += candidate.weight;
            let mut picked = 0.0;
            while next < passed {
                picked += 1.0;
                next += step;
            }
            if picked > 0.0 {
                let Candidate { light, .. } = candidate;
                self.counts.shadow_asked += 1;
                self.counts.shadow_traced += 1;
                if !self.caster.occluded(&shadow_ray(self.surface, light)) {
                    sum += light.radiance * (picked / luminance(light.radiance));
                }
            }
        }
        // Mean weight of the candidates, by the mean over what was picked.
        sum * (total / (all * samples) as f32)
    }

    /// What a ray in proportion to the cosine meets.
    fn scattered(&mut self, sampler: &mut impl Sampler) -> Vec3 {
        let surface = self.surface;
        let local = sample_cosine(sampler.next_2d());
        let pdf = cosine_pdf(local.z);
        let direction = Basis::new(surface.normal).to_scene(local.truncate(), local.z);
        let origin = offset_origin(surface.position, surface.face, direction, surface.offset);
        let ray = ray_towards(origin, direction);
        if NEEDS & Needs::TRIANGLE_LIGHTS == 0 || !may_meet_emitter(self.scene.lights, &ray) {
            // Only what is outside can be seen, and whether something stands before it is a cheaper question.
            let seen = self.scene.outside::<NEEDS>(direction);
            if seen.radiance == Vec3::ZERO {
                return Vec3::ZERO;
            }
            self.counts.shadow_asked += 1;
            self.counts.shadow_traced += 1;
            if self.caster.occluded(&ray) {
                return Vec3::ZERO;
            }
            return seen.radiance * (1.0 - self.weight_of_next_event(seen.pdf, pdf));
        }
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(&ray) else {
            let seen = self.scene.outside::<NEEDS>(direction);
            return seen.radiance * (1.0 - self.weight_of_next_event(seen.pdf, pdf));
        };
        let next = Surface::at::<NEEDS>(self.scene, &hit, direction);
        let emitted = next.emission::<NEEDS>(self.scene);
        if emitted == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let density = next.light_density::<NEEDS>(self.scene, emitted);
        let other = density * (hit.t * hit.t) / next.face.dot(direction).abs();
        emitted * (1.0 - self.weight_of_next_event(other, pdf))
    }

    /// The share of next event in light from a direction that both strategies find, with these densities.
    #[inline]
    fn weight_of_next_event(&self, next_event: f32, scattering: f32) -> f32 {
        let (n, m) = (self.settings.shadow_rays() as f32, self.settings.scattered as f32);
        power_heuristic(next_event * n, scattering * m)
    }
}
