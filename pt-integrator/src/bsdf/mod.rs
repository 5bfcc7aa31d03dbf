//! Materials at a point: what they do with light, by lobes.

mod inputs;
mod lobe;

pub use inputs::BsdfInputs;
pub use lobe::{BsdfSample, Lobe, LobePick};

use glam::{Vec2, Vec3};

use crate::sampling::{Basis, cosine_pdf, sample_cosine};

/// A material at a point, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    normal: Vec3,
    diffuse: Vec3,
}

impl Bsdf {
    /// Resolves a material. `normal` is the unit shading normal on the side of `outgoing`, which is the unit direction
    /// towards where the ray came from. `entering`: a ray that is bent here goes from the outside into the solid.
    #[inline]
    pub fn new(inputs: &BsdfInputs, normal: Vec3, outgoing: Vec3, entering: bool) -> Self {
        let _ = (outgoing, entering);
        Self { normal, diffuse: inputs.base_color.clamp(Vec3::ZERO, Vec3::ONE) }
    }

    /// Probability of each lobe, by [`Lobe`]'s number: about its share of the light that the surface reflects towards
    /// the viewer. 0 for lobes that reflect nothing.
    #[inline]
    pub fn lobes(&self) -> [f32; 4] {
        [1.0, 0.0, 0.0, 0.0]
    }

    /// Chooses a lobe with its [probability](Self::lobes); the diffuse one when the surface is black.
    #[inline]
    pub fn pick(&self, u: f32) -> LobePick {
        LobePick { lobe: Lobe::Diffuse, probability: 1.0, u }
    }

    /// Chooses among all lobes but the diffuse one. `None` when there is no other.
    #[inline]
    pub fn pick_specular(&self, u: f32) -> Option<LobePick> {
        let _ = u;
        None
    }

    /// What the diffuse lobe multiplies illumination with. Exactly the base color for a Lambertian material.
    #[inline]
    pub fn diffuse_throughput(&self) -> Vec3 {
        self.diffuse
    }

    /// Share of light from a direction that reaches the diffuse lobe: the factor on cos θ / π in its illumination.
    /// Exactly 1 for a Lambertian material.
    #[inline]
    pub fn diffuse_weight(&self, incoming: Vec3) -> f32 {
        let _ = incoming;
        1.0
    }

    /// Expected share of light that all lobes but the diffuse one bring to the viewer, by channel.
    #[inline]
    pub fn specular_throughput(&self) -> Vec3 {
        Vec3::ZERO
    }

    /// Perceptual roughness of a lobe, `[0, 1]`: 1 for the diffuse one, 0 for delta lobes.
    #[inline]
    pub fn roughness(&self, lobe: Lobe) -> f32 {
        if lobe == Lobe::Diffuse { 1.0 } else { 0.0 }
    }

    /// Whether a lobe reflects in one direction only.
    #[inline]
    pub fn is_delta(&self, lobe: Lobe) -> bool {
        lobe != Lobe::Diffuse
    }

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) together, for half the price.
    #[inline]
    pub fn eval_pdf(&self, lobe: Lobe, incoming: Vec3) -> (Vec3, f32) {
        let cosine = self.normal.dot(incoming);
        if lobe == Lobe::Diffuse && cosine > 0.0 {
            (Vec3::splat(cosine_pdf(cosine) * self.diffuse_weight(incoming)), cosine_pdf(cosine))
        } else {
            (Vec3::ZERO, 0.0)
        }
    }

    /// f·|cos θ| of a lobe for light from a unit direction. 0 for delta lobes. The diffuse lobe's is its illumination's:
    /// without [`diffuse_throughput`](Self::diffuse_throughput).
    #[inline]
    pub fn eval(&self, lobe: Lobe, incoming: Vec3) -> Vec3 {
        self.eval_pdf(lobe, incoming).0
    }

    /// Density by solid angle with which [`sample`](Self::sample) draws a direction. 0 for delta lobes.
    #[inline]
    pub fn pdf(&self, lobe: Lobe, incoming: Vec3) -> f32 {
        self.eval_pdf(lobe, incoming).1
    }

    /// Draws a direction from a lobe. `None` when the point of the unit square belongs to none that reflects.
    #[inline]
    pub fn sample(&self, lobe: Lobe, u: Vec2) -> Option<BsdfSample> {
        if lobe != Lobe::Diffuse {
            return None;
        }
        let local = sample_cosine(u);
        let incoming = Basis::new(self.normal).to_scene(local.truncate(), local.z);
        Some(BsdfSample {
            incoming,
            weight: Vec3::splat(self.diffuse_weight(incoming)),
            pdf: cosine_pdf(local.z),
            is_delta: false,
            transmitted: false,
            eta: 1.0,
        })
    }
}
