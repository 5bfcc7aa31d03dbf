//! Light from a given direction.

use glam::Vec3;
use hashcache_core::float;

use super::microfacet::Ggx;
use super::resolve::Passage;
use super::{Bsdf, Lobe, SMALLEST_ALPHA};
use crate::sampling::{Basis, cosine_pdf};

impl Bsdf {
    /// What the diffuse lobe multiplies its illumination with. Exactly the base color for a Lambertian material.
    #[inline]
    pub fn diffuse_throughput(&self) -> Vec3 {
        self.diffuse
    }

    /// Share of light from a direction that reaches the diffuse lobe: the factor on cos θ / π in its illumination.
    /// Exactly 1 for a Lambertian material.
    #[inline]
    pub fn diffuse_weight(&self, incoming: Vec3) -> f32 {
        if self.is_bare { 1.0 } else { self.covered_weight(incoming) }
    }

    #[inline]
    fn covered_weight(&self, incoming: Vec3) -> f32 {
        let angle = self.fresnel.at(self.frame.normal.dot(incoming).max(0.0));
        self.fresnel.entered(angle) * self.coat.passed(incoming)
    }

    /// Perceptual roughness of a lobe, `[0, 1]`: 1 for the diffuse one, 0 for delta lobes.
    #[inline]
    pub fn roughness(&self, lobe: Lobe) -> f32 {
        match lobe {
            Lobe::Diffuse => 1.0,
            _ if self.is_delta(lobe) => 0.0,
            Lobe::Coat => float::sqrt(self.coat.alpha),
            Lobe::Reflection | Lobe::Transmission => float::sqrt(self.ggx.alpha()),
        }
    }

    /// Whether a lobe reflects in one direction only.
    #[inline]
    pub fn is_delta(&self, lobe: Lobe) -> bool {
        match lobe {
            Lobe::Diffuse => false,
            Lobe::Reflection => self.is_smooth,
            Lobe::Transmission => matches!(self.passage, Passage::Straight | Passage::Refracted),
            Lobe::Coat => self.coat.alpha < SMALLEST_ALPHA,
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

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) together, for half the price.
    #[inline]
    pub fn eval_pdf(&self, lobe: Lobe, incoming: Vec3) -> (Vec3, f32) {
        match lobe {
            Lobe::Diffuse => {
                let pdf = cosine_pdf(self.frame.normal.dot(incoming));
                // Also for NaN.
                if pdf > 0.0 { (Vec3::splat(pdf * self.diffuse_weight(incoming)), pdf) } else { NONE }
            }
            Lobe::Reflection => self.eval_reflection(incoming),
            Lobe::Transmission => self.eval_transmission(incoming),
            Lobe::Coat => self.eval_coat(incoming),
        }
    }

    #[inline]
    fn eval_reflection(&self, incoming: Vec3) -> (Vec3, f32) {
        if self.is_smooth || self.reflects == 0.0 {
            return NONE;
        }
        let Some(light) = above(self.frame.to_local(incoming)) else { return NONE };
        let met = self.ggx.reflect(light);
        let fresnel = self.fresnel.reflected(self.fresnel.at(met.cosine));
        (fresnel * (met.value * self.reflects * self.coat.passed(incoming)), met.pdf)
    }

    #[inline]
    fn eval_transmission(&self, incoming: Vec3) -> (Vec3, f32) {
        if self.passes == Vec3::ZERO {
            return NONE;
        }
        let beyond = self.frame.to_local(incoming);
        let Some(light) = above(beyond.with_z(-beyond.z)) else { return NONE };
        let met = match self.passage {
            Passage::ThinRough => Some(self.ggx.reflect(light)),
            Passage::RefractedRough => self.ggx.refract(beyond, self.fresnel.eta),
            Passage::Straight | Passage::Refracted => None,
        };
        let Some(met) = met else { return NONE };
        let passed = self.fresnel.entered(self.fresnel.at(met.cosine)) * self.coat.passed_beyond(incoming);
        (self.passes * (met.value * passed), met.pdf)
    }

    #[inline]
    fn eval_coat(&self, incoming: Vec3) -> (Vec3, f32) {
        if self.coat.alpha < SMALLEST_ALPHA {
            return NONE;
        }
        let Some((frame, ggx)) = self.coat_facets() else { return NONE };
        let Some(light) = above(frame.to_local(incoming)) else { return NONE };
        let met = ggx.reflect(light);
        (Vec3::splat(met.value * self.coat.reflected(met.cosine)), met.pdf)
    }

    /// The coat's frame, and its microfacets as seen from the viewer. `None`: the viewer sees no coat.
    #[inline]
    pub(super) fn coat_facets(&self) -> Option<(Basis, Ggx)> {
        if self.albedos[Lobe::Coat as usize] == Vec3::ZERO {
            return None;
        }
        let frame = Basis::new(self.coat.normal);
        Some((frame, Ggx::new(self.coat.alpha, frame.to_local(self.outgoing))))
    }
}

/// A vector with z above 0; none is NaN.
#[inline]
fn above(v: Vec3) -> Option<Vec3> {
    (v.z > 0.0).then_some(v)
}

const NONE: (Vec3, f32) = (Vec3::ZERO, 0.0);
