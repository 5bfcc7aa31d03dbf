//! Direct light of one vertex, by many samples.

use glam::Vec3;
use hashcache_core::traits::{RayCaster, Sampler};

use super::medium::{Crossing, Medium};
use super::scatters::Scatters;
use super::step::{Tracer, next_event_weight, shadow_ray};
use crate::bsdf::Lobe;
use crate::light::{LightSample, MAX_TRIED, luminance, may_meet_emitter, sample_light};
use crate::ray::{offset_origin, ray_towards};
use crate::sampling::power_heuristic;
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
    /// By which lobes and in which directions a chain goes on; index 0 only.
    Chain,
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
        let candidates = if scene.alias.len() > MAX_TRIED { 2 } else { 1 };
        let image = scene.environment.width != 0;
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

/// A candidate: the light it brings if nothing stands between, divided by its density, and where it comes from.
#[derive(Clone, Copy)]
struct Candidate {
    light: LightSample,
    weight: f32,
}

/// Illumination of one vertex's diffuse lobe by emitters.
pub(super) struct Direct<'a, 'b, 'c, const NEEDS: u32, C, M> {
    pub tracer: &'a mut Tracer<'c, 'b, NEEDS, C>,
    pub surface: &'a Surface<'b>,
    pub material: &'a M,
    pub medium: Medium,
    pub settings: &'a DirectSettings,
}

impl<const NEEDS: u32, C: RayCaster, M: Scatters> Direct<'_, '_, '_, NEEDS, C, M> {
    /// All samples of both strategies; `numbers` as in [`super::trace_visible`].
    #[inline]
    pub fn all<S: Sampler>(&mut self, mut numbers: impl FnMut(Strategy, u32) -> S) -> Vec3 {
        let mut direct = self.next_event(|i| numbers(Strategy::NextEvent, i));
        for i in 0..self.settings.scattered {
            let seen = self.scattered(&mut numbers(Strategy::Scattering, i));
            direct += seen / self.settings.scattered as f32;
        }
        direct
    }

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
            if let Some(mut light) = sample_light::<NEEDS>(self.tracer.scene, &mut sampler, self.surface.position) {
                if M::MIXED {
                    let (scale, medium) = self.side(light.direction);
                    light.radiance *= scale * medium.passed_from(self.surface.position, &light);
                }
                let (value, pdf) = self.material.eval_pdf(Lobe::Diffuse, light.direction);
                let mis = next_event_weight::<NEEDS>(&light, self.weight_of_next_event(light.pdf, pdf));
                let weight = luminance(light.radiance) * (value.x * mis / light.pdf);
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
                self.tracer.counts.shadow_asked += 1;
                self.tracer.counts.shadow_traced += 1;
                if !self.tracer.caster.occluded(&shadow_ray(self.surface, light)) {
                    sum += light.radiance * (picked / luminance(light.radiance));
                }
            }
        }
        // Mean weight of the candidates, by the mean over what was picked.
        sum * (total / (all * samples) as f32)
    }

    /// What a ray in proportion to the cosine meets.
    fn scattered(&mut self, sampler: &mut impl Sampler) -> Vec3 {
        let (surface, scene) = (self.surface, self.tracer.scene);
        let Some(scattered) = self.material.sample(Lobe::Diffuse, sampler.next_2d()) else { return Vec3::ZERO };
        let (direction, pdf) = (scattered.incoming, scattered.pdf);
        let (scale, medium) = if M::MIXED { self.side(direction) } else { (1.0, self.medium) };
        if scale == 0.0 {
            return Vec3::ZERO;
        }
        let weight = scattered.weight * scale;
        let origin = offset_origin(surface.position, surface.face, direction, surface.offset);
        let ray = ray_towards(origin, direction);
        if NEEDS & Needs::TRIANGLE_LIGHTS == 0 || !may_meet_emitter(scene.lights, &ray) {
            // Only what is outside can be seen, and whether something stands before it is a cheaper question.
            let seen = scene.outside::<NEEDS>(direction);
            if seen.radiance == Vec3::ZERO {
                return Vec3::ZERO;
            }
            self.tracer.counts.shadow_asked += 1;
            self.tracer.counts.shadow_traced += 1;
            if self.tracer.caster.occluded(&ray) {
                return Vec3::ZERO;
            }
            return seen.radiance * weight * (1.0 - self.weight_of_next_event(seen.pdf, pdf));
        }
        self.tracer.counts.closest += 1;
        let Some(hit) = self.tracer.caster.closest(&ray) else {
            let seen = scene.outside::<NEEDS>(direction);
            return seen.radiance * weight * (1.0 - self.weight_of_next_event(seen.pdf, pdf));
        };
        let next = Surface::at::<NEEDS>(scene, &hit, direction);
        let emitted = next.emission::<NEEDS>(scene);
        if emitted == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let other = self.tracer.light_density(&next, emitted, hit.t);
        let met = emitted * weight * (1.0 - self.weight_of_next_event(other, pdf));
        if M::MIXED { met * medium.before(&next).passed(hit.t) } else { met }
    }

    /// What the side from which light comes multiplies it with, 0 where it is not shown, and what it came through.
    #[inline]
    fn side(&self, direction: Vec3) -> (f32, Medium) {
        if !self.surface.shows::<NEEDS>(direction, false) {
            return (0.0, self.medium);
        }
        let Crossing { crosses, scale, .. } = Crossing::new(self.surface, direction, false);
        (scale, self.medium.after(self.surface, crosses))
    }

    /// The share of next event in light from a direction that both strategies find, with these densities.
    #[inline]
    fn weight_of_next_event(&self, next_event: f32, scattering: f32) -> f32 {
        let (n, m) = (self.settings.shadow_rays() as f32, self.settings.scattered as f32);
        power_heuristic(next_event * n, scattering * m)
    }
}
