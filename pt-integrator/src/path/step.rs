//! From one vertex to emitters and to the next vertex.

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::RayCounts;
use super::medium::{Crossing, Medium};
use super::scatters::Scatters;
use crate::bsdf::{BsdfSample, Lobe};
use crate::light::{LightSample, may_meet_emitter, sample_light};
use crate::ray::{offset_origin, ray_towards, segment};
use crate::sampling::power_heuristic;
use crate::scene::Needs;
use crate::surface::Surface;
use crate::view::SceneView;

/// What tracing needs at every step. `NEEDS` as in [`sample_light`].
pub(super) struct Tracer<'a, 'b, const NEEDS: u32, C> {
    pub scene: &'a SceneView<'b>,
    pub caster: &'a C,
    pub counts: &'a mut RayCounts,
}

/// Where a path's ray ended.
pub(super) struct Arrival<'b> {
    /// Light seen there: weighted against next-event estimation, by how it was scattered, and by what absorbed it.
    pub emitted: Vec3,
    /// By how much light from further on is weighted.
    pub weight: Vec3,
    /// Refractive index of what the path is in over that of what it was in.
    pub eta: f32,
    /// The surface; `None` where the path ends.
    pub next: Option<Next<'b>>,
}

/// A further vertex.
#[derive(Clone, Copy)]
pub(super) struct Next<'b> {
    pub surface: Surface<'b>,
    pub distance: f32,
    /// What the ray came through.
    pub medium: Medium,
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

impl Arrival<'_> {
    /// The end of a path that brings nothing.
    const NOTHING: Self = Self::seen(Vec3::ZERO);

    const fn seen(emitted: Vec3) -> Self {
        Self { emitted, weight: Vec3::ZERO, eta: 1.0, next: None }
    }
}

impl<'b, const NEEDS: u32, C: RayCaster> Tracer<'_, 'b, NEEDS, C> {
    /// Follows a ray of the camera.
    #[inline(always)]
    pub fn look(&mut self, ray: &Ray) -> Arrival<'b> {
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(ray) else {
            return Arrival::seen(self.scene.outside::<NEEDS>(ray.direction).radiance);
        };
        let surface = Surface::at::<NEEDS>(self.scene, &hit, ray.direction);
        let mut emitted = surface.emission::<NEEDS>(self.scene);
        let (mut medium, mut weight) = (Medium::NONE, Vec3::ONE);
        if NEEDS & Needs::TRANSMISSION != 0 {
            medium = medium.before(&surface);
            weight = medium.passed(hit.t);
            emitted *= weight;
        }
        let next = Next { surface, distance: hit.t, medium };
        Arrival { emitted, weight, eta: 1.0, next: Some(next) }
    }

    /// What one sampled emitter brings through a lobe.
    #[inline]
    pub fn next_event<M: Scatters>(
        &mut self,
        sampler: &mut impl Sampler,
        surface: &Surface<'_>,
        material: &M,
        lobe: Lobe,
        medium: Medium,
    ) -> Vec3 {
        if NEEDS & Needs::SAMPLED_LIGHTS == 0 || material.is_delta(lobe) {
            return Vec3::ZERO;
        }
        let Some(light) = sample_light::<NEEDS>(self.scene, sampler, surface.position) else {
            return Vec3::ZERO;
        };
        let (value, pdf) = material.eval_pdf(lobe, light.direction);
        let transmitted = lobe == Lobe::Transmission;
        if pdf <= 0.0 || !surface.shows::<NEEDS>(light.direction, transmitted) {
            return Vec3::ZERO;
        }
        let shadow = shadow_ray(surface, &light);
        self.counts.shadow_asked += 1;
        self.counts.shadow_traced += 1;
        if self.caster.occluded(&shadow) {
            return Vec3::ZERO;
        }
        let mis = next_event_weight::<NEEDS>(&light, power_heuristic(light.pdf, pdf));
        let met = light.radiance * (value * mis / light.pdf);
        if !M::MIXED {
            return met;
        }
        let Crossing { crosses, scale, .. } = Crossing::new(surface, light.direction, transmitted);
        met * scale * medium.after(surface, crosses).passed_from(surface.position, &light)
    }

    /// Goes on by a lobe. The `last` ray only looks for emitters.
    #[inline]
    pub fn scatter<M: Scatters>(
        &mut self,
        sampler: &mut impl Sampler,
        surface: &Surface<'_>,
        material: &M,
        lobe: Lobe,
        medium: Medium,
        last: bool,
    ) -> Arrival<'b> {
        let Some(mut scattered) = material.sample(lobe, sampler.next_2d()) else { return Arrival::NOTHING };
        let direction = scattered.incoming;
        if !surface.shows::<NEEDS>(direction, scattered.transmitted) {
            return Arrival::NOTHING;
        }
        let mut crosses = false;
        if M::MIXED {
            let crossing = Crossing::new(surface, direction, scattered.transmitted);
            (crosses, scattered.eta) = (crossing.crosses, crossing.eta);
            scattered.weight *= crossing.scale;
        }
        let origin = offset_origin(surface.position, surface.face, direction, surface.offset);
        let ray = ray_towards(origin, direction);
        if last && self.sees_no_light(&ray) {
            return Arrival::NOTHING;
        }
        self.counts.closest += 1;
        let Some(hit) = self.caster.closest(&ray) else {
            let seen = self.scene.outside::<NEEDS>(direction);
            let weight = scattered.weight * scattering_weight::<M>(&scattered, seen.pdf);
            return Arrival::seen(seen.radiance * weight);
        };
        if last && NEEDS & Needs::TRIANGLE_LIGHTS == 0 {
            return Arrival::NOTHING;
        }
        let surface_met = Surface::at::<NEEDS>(self.scene, &hit, direction);
        let mut weight = scattered.weight;
        let mut through = Medium::NONE;
        if M::MIXED {
            through = medium.after(surface, crosses).before(&surface_met);
            weight *= through.passed(hit.t);
        }
        let mut emitted = Vec3::ZERO;
        if NEEDS & Needs::TRIANGLE_LIGHTS != 0 {
            emitted = surface_met.emission::<NEEDS>(self.scene);
            if emitted != Vec3::ZERO {
                let other = self.light_density(&surface_met, emitted, hit.t);
                emitted *= scattering_weight::<M>(&scattered, other);
                emitted *= weight;
            }
        }
        let next = (!last).then_some(Next { surface: surface_met, distance: hit.t, medium: through });
        Arrival { emitted, weight, eta: scattered.eta, next }
    }

    /// Density by solid angle with which next event would have drawn the direction in which an emitter was met at
    /// `distance`.
    #[inline]
    pub fn light_density(&self, met: &Surface<'_>, emitted: Vec3, distance: f32) -> f32 {
        // By area, times distance² over cosine.
        met.light_density::<NEEDS>(self.scene, emitted) * (distance * distance) / met.face.dot(met.direction).abs()
    }

    /// Whether nothing that a ray may meet gives light.
    #[inline]
    fn sees_no_light(&self, ray: &Ray) -> bool {
        (NEEDS & Needs::ENVIRONMENT_IMAGE == 0 || self.scene.environment.width == 0)
            && !self.scene.header.has_constant_environment()
            && (NEEDS & Needs::TRIANGLE_LIGHTS == 0 || !may_meet_emitter(self.scene.lights, ray))
    }
}

/// The share of next event in a light that it chose: `shared` unless scattering cannot meet it.
#[inline]
pub(super) fn next_event_weight<const NEEDS: u32>(light: &LightSample, shared: f32) -> f32 {
    if NEEDS & Needs::PUNCTUAL != 0 && light.is_delta { 1.0 } else { shared }
}

/// The share of scattering in light that it met.
#[inline]
fn scattering_weight<M: Scatters>(scattered: &BsdfSample, next_event: f32) -> f32 {
    if M::MIXED && scattered.is_delta { 1.0 } else { power_heuristic(scattered.pdf, next_event) }
}
