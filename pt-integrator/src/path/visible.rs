//! First vertices with direct light and nothing else.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::trace::{for_needs, shadow_ray};
use super::{PathOutcome, RayCounts};
use crate::light::{LightSample, luminance, sample_light};
use crate::sampling::{Basis, cosine_pdf, sample_cosine};
use crate::scene::Needs;
use crate::surface::Surface;
use crate::view::SceneView;

/// How direct light is found.
///
/// # Source
/// Talbot et al. 2005 (resampled importance sampling): of many candidates, chosen by the emitters' power, some are
/// picked in proportion to the light that they would bring without obstacles, and only these cast a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectSettings {
    /// Shadow rays a vertex; 0: no direct light. At most [`DirectSettings::MAX_CANDIDATES`].
    pub samples: u32,
    /// Candidates for each shadow ray, at least 1 (the emitters' power alone decides). Their number in all is at most
    /// [`DirectSettings::MAX_CANDIDATES`].
    pub candidates: u32,
}

impl DirectSettings {
    /// Most candidates of a vertex, `samples · candidates`; what is asked beyond is left out.
    pub const MAX_CANDIDATES: u32 = 64;

    /// Direct light by `samples` shadow rays a vertex.
    pub const fn new(samples: u32) -> Self {
        Self { samples, candidates: 4 }
    }

    /// Candidates of a vertex in all, in their bounds.
    ///
    /// ```
    /// use pt_integrator::path::DirectSettings;
    /// assert_eq!(DirectSettings { samples: 3, candidates: 4 }.all(), 12);
    /// assert_eq!(DirectSettings { samples: 3, candidates: 1000 }.all(), 63);
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

    #[inline]
    const fn shadow_rays(&self) -> u32 {
        if self.samples < Self::MAX_CANDIDATES { self.samples } else { Self::MAX_CANDIDATES }
    }
}

/// Traces a camera ray of unit direction to its first vertex and finds the light that comes there straight from
/// emitters: an estimate of [`PathOutcome::direct`] of the same mean as [`super::trace_path`]'s. `further` is 0.
///
/// `numbers(i)` makes the sampler of candidate i; consecutive indices are stratified together, so a caller passes on
/// indices that go on from sample to sample of a pixel: `numbers = |i| Sobol::new(sample · n + i, seed)` with n
/// candidates a vertex. Adds to `counts`. Light that is NaN or infinite is dropped and counted.
///
/// # Panics
/// As [`super::trace_path`].
pub fn trace_visible<C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &DirectSettings,
    numbers: impl FnMut(u32) -> S,
    counts: &mut RayCounts,
) -> PathOutcome {
    let trace = for_needs!(scene, visible_for, C, S, _);
    trace(scene, caster, ray, settings, numbers, counts)
}

fn visible_for<const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(u32) -> S>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &DirectSettings,
    numbers: N,
    counts: &mut RayCounts,
) -> PathOutcome {
    counts.paths += 1;
    counts.closest += 1;
    let Some(hit) = caster.closest(ray) else {
        return PathOutcome::seen(ray.direction, scene.outside::<NEEDS>(ray.direction).radiance);
    };
    let surface = Surface::at(scene, &hit, ray.direction);
    let mut outcome = PathOutcome::seen(ray.direction, surface.emission());
    outcome.arrive(&surface, hit.t, surface.albedo::<NEEDS>(scene));
    outcome.direct = direct_for::<NEEDS, C, S>(scene, caster, &surface, settings, numbers, counts);
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
fn direct_for<const NEEDS: u32, C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    surface: &Surface<'_>,
    settings: &DirectSettings,
    mut numbers: impl FnMut(u32) -> S,
    counts: &mut RayCounts,
) -> Vec3 {
    let (samples, all) = (settings.shadow_rays(), settings.all());
    let sky = NEEDS & Needs::ENVIRONMENT_IMAGE == 0 && scene.header.constant_environment != [0.0; 4];
    if samples == 0 || (NEEDS & Needs::SAMPLED_LIGHTS == 0 && !sky) {
        return Vec3::ZERO;
    }
    let nothing = LightSample { direction: Vec3::ZERO, target: None, radiance: Vec3::ZERO, pdf: 1.0 };
    let mut candidates = [Candidate { light: nothing, weight: 0.0 }; DirectSettings::MAX_CANDIDATES as usize];
    let candidates = &mut candidates[..all as usize];
    let mut total = 0.0;
    let mut start = 0.0;
    for (i, candidate) in (0..).zip(candidates.iter_mut()) {
        let mut sampler = numbers(i);
        if let Some(light) = emitter::<NEEDS>(scene, &mut sampler, surface, sky) {
            let cosine = surface.normal.dot(light.direction);
            let weight = luminance(light.radiance) * (FRAC_1_PI * cosine.max(0.0) / light.pdf);
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
            counts.shadow_asked += 1;
            counts.shadow_traced += 1;
            if !caster.occluded(&shadow_ray(surface, light)) {
                sum += light.radiance * (picked / luminance(light.radiance));
            }
        }
    }
    // Mean weight of the candidates, by the mean over what was picked.
    sum * (total / (all * samples) as f32)
}

/// A sample of any emitter: as path tracing's, and of a constant environment by the cosine.
#[inline]
fn emitter<const NEEDS: u32>(
    scene: &SceneView<'_>,
    sampler: &mut impl Sampler,
    surface: &Surface<'_>,
    sky: bool,
) -> Option<LightSample> {
    if NEEDS & Needs::ENVIRONMENT_IMAGE != 0 || !sky {
        return sample_light::<NEEDS>(scene, sampler, surface.position);
    }
    // An even chance: which of the two is brighter here depends on the place.
    let share = if NEEDS & Needs::TRIANGLE_LIGHTS == 0 { 1.0 } else { 0.5 };
    if share < 1.0 && sampler.next_1d() >= share {
        let light = sample_light::<NEEDS>(scene, sampler, surface.position)?;
        return Some(LightSample { pdf: light.pdf * (1.0 - share), ..light });
    }
    let local = sample_cosine(sampler.next_2d());
    let direction = Basis::new(surface.normal).to_scene(local.truncate(), local.z);
    let [r, g, b, _] = scene.header.constant_environment;
    Some(LightSample { direction, target: None, radiance: Vec3::new(r, g, b), pdf: share * cosine_pdf(local.z) })
}
