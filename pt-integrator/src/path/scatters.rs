//! Materials as the loop sees them: Lambertian ones, which cost what they always did, and all the others.

use glam::{Vec2, Vec3};
use hashcache_core::traits::Sampler;

use crate::bsdf::{Bsdf, BsdfSample, Lobe};
use crate::sampling::{Basis, cosine_pdf, sample_cosine};
use crate::surface::Surface;
use crate::view::SceneView;

/// A material at a vertex, as seen from where the path came from.
pub(super) trait Scatters: Sized {
    /// Whether there may be lobes that are not diffuse, so that one is chosen.
    const MIXED: bool;

    /// The material of a surface.
    fn at<const NEEDS: u32>(scene: &SceneView<'_>, surface: &Surface<'_>) -> Self;

    /// Chooses a lobe; the second number is the probability of the choice. Draws a number only where there is a choice.
    fn pick(&self, sampler: &mut impl Sampler) -> (Lobe, f32);

    /// See [`Bsdf::diffuse_throughput`].
    fn diffuse_throughput(&self) -> Vec3;

    /// See [`Bsdf::is_delta`].
    fn is_delta(&self, lobe: Lobe) -> bool;

    /// See [`Bsdf::eval_pdf`].
    fn eval_pdf(&self, lobe: Lobe, incoming: Vec3) -> (Vec3, f32);

    /// See [`Bsdf::sample`].
    fn sample(&self, lobe: Lobe, u: Vec2) -> Option<BsdfSample>;
}

/// A surface that only reflects, and evenly.
#[derive(Clone, Copy)]
pub(super) struct Lambert {
    normal: Vec3,
    albedo: Vec3,
}

impl Scatters for Lambert {
    const MIXED: bool = false;

    #[inline(always)]
    fn at<const NEEDS: u32>(scene: &SceneView<'_>, surface: &Surface<'_>) -> Self {
        Self { normal: surface.normal, albedo: surface.albedo::<NEEDS>(scene) }
    }

    #[inline(always)]
    fn pick(&self, _: &mut impl Sampler) -> (Lobe, f32) {
        (Lobe::Diffuse, 1.0)
    }

    #[inline(always)]
    fn diffuse_throughput(&self) -> Vec3 {
        self.albedo
    }

    #[inline(always)]
    fn is_delta(&self, _: Lobe) -> bool {
        false
    }

    #[inline(always)]
    fn eval_pdf(&self, _: Lobe, incoming: Vec3) -> (Vec3, f32) {
        let pdf = cosine_pdf(self.normal.dot(incoming));
        (Vec3::splat(pdf), pdf)
    }

    #[inline(always)]
    fn sample(&self, _: Lobe, u: Vec2) -> Option<BsdfSample> {
        let local = sample_cosine(u);
        Some(BsdfSample {
            incoming: Basis::new(self.normal).to_scene(local.truncate(), local.z),
            weight: Vec3::ONE,
            pdf: cosine_pdf(local.z),
            is_delta: false,
            transmitted: false,
            eta: 1.0,
        })
    }
}

impl Scatters for Bsdf {
    const MIXED: bool = true;

    #[inline]
    fn at<const NEEDS: u32>(scene: &SceneView<'_>, surface: &Surface<'_>) -> Self {
        let inputs = surface.bsdf_inputs(scene);
        Self::new(&inputs, surface.normal, -surface.direction, surface.from_front)
    }

    #[inline]
    fn pick(&self, sampler: &mut impl Sampler) -> (Lobe, f32) {
        // A surface with one lobe draws what a Lambertian one draws.
        let choices = self.lobes().iter().filter(|&&probability| probability > 0.0).count();
        let picked = Self::pick(self, if choices > 1 { sampler.next_1d() } else { 0.0 });
        (picked.lobe, picked.probability)
    }

    #[inline]
    fn diffuse_throughput(&self) -> Vec3 {
        Self::diffuse_throughput(self)
    }

    #[inline]
    fn is_delta(&self, lobe: Lobe) -> bool {
        Self::is_delta(self, lobe)
    }

    #[inline]
    fn eval_pdf(&self, lobe: Lobe, incoming: Vec3) -> (Vec3, f32) {
        Self::eval_pdf(self, lobe, incoming)
    }

    #[inline]
    fn sample(&self, lobe: Lobe, u: Vec2) -> Option<BsdfSample> {
        Self::sample(self, lobe, u)
    }
}
