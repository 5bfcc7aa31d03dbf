//! Directions in proportion to a lobe.

use glam::{Vec2, Vec3};

use super::microfacet::refracted;
use super::resolve::Passage;
use super::{Bsdf, BsdfSample, Lobe, SMALLEST_ALPHA};
use crate::sampling::{cosine_pdf, sample_cosine};

impl Bsdf {
    /// Draws a direction from a lobe. `None`: this point of the unit square belongs to light that is lost, or the lobe
    /// sends none to the viewer.
    #[inline]
    pub fn sample(&self, lobe: Lobe, u: Vec2) -> Option<BsdfSample> {
        match lobe {
            Lobe::Diffuse => Some(self.sample_diffuse(u)),
            Lobe::Reflection => self.sample_reflection(u),
            Lobe::Transmission => self.sample_transmission(u),
            Lobe::Coat => self.sample_coat(u),
        }
    }

    #[inline]
    fn sample_diffuse(&self, u: Vec2) -> BsdfSample {
        let local = sample_cosine(u);
        let incoming = self.frame.to_scene(local.truncate(), local.z);
        scattered(incoming, Vec3::splat(self.diffuse_weight(incoming)), cosine_pdf(local.z))
    }

    #[inline]
    fn sample_reflection(&self, u: Vec2) -> Option<BsdfSample> {
        if self.reflects == 0.0 {
            return None;
        }
        if self.is_smooth {
            let cosine = self.ggx.view.z;
            let incoming = mirrored(self.outgoing, self.frame.normal, cosine);
            let fresnel = self.fresnel.reflected(self.fresnel.at(cosine.min(1.0)));
            return Some(delta(incoming, fresnel * (self.reflects * self.coat.passed(incoming))));
        }
        let (light, cosine, weight, pdf) = self.ggx.sample_reflection(u)?;
        let incoming = self.frame.to_scene(light.truncate(), light.z);
        let fresnel = self.fresnel.reflected(self.fresnel.at(cosine));
        Some(scattered(incoming, fresnel * (weight * self.reflects * self.coat.passed(incoming)), pdf))
    }

    #[inline]
    fn sample_transmission(&self, u: Vec2) -> Option<BsdfSample> {
        if self.passes == Vec3::ZERO {
            return None;
        }
        let eta = self.fresnel.eta;
        let view = self.ggx.view;
        let transmit = |sample: BsdfSample, cosine: f32| {
            let passed = self.fresnel.entered(self.fresnel.at(cosine)) * self.coat.passed_beyond(sample.incoming);
            BsdfSample { weight: self.passes * (sample.weight * passed), transmitted: true, ..sample }
        };
        let to_scene = |light: Vec3| self.frame.to_scene(light.truncate(), light.z);
        match self.passage {
            Passage::Straight => Some(transmit(delta(-self.outgoing, Vec3::ONE), view.z.min(1.0))),
            Passage::ThinRough => {
                let (light, cosine, weight, pdf) = self.ggx.sample_reflection(u)?;
                Some(transmit(scattered(to_scene(light.with_z(-light.z)), Vec3::splat(weight), pdf), cosine))
            }
            Passage::Refracted => {
                let cosine = view.z.min(1.0);
                let (incoming, _) = refracted(self.outgoing, self.frame.normal, cosine, eta)?;
                let sample = delta(incoming, Vec3::splat(1.0 / (eta * eta)));
                Some(BsdfSample { eta, ..transmit(sample, cosine) })
            }
            Passage::RefractedRough => {
                let (light, cosine, weight, pdf) = self.ggx.sample_refraction(u, eta)?;
                let sample = scattered(to_scene(light), Vec3::splat(weight), pdf);
                Some(BsdfSample { eta, ..transmit(sample, cosine) })
            }
        }
    }

    #[inline]
    fn sample_coat(&self, u: Vec2) -> Option<BsdfSample> {
        let (frame, ggx) = self.coat_facets()?;
        if self.coat.alpha < SMALLEST_ALPHA {
            let incoming = mirrored(self.outgoing, frame.normal, ggx.view.z);
            return Some(delta(incoming, Vec3::splat(self.coat.reflected(ggx.view.z))));
        }
        let (light, cosine, weight, pdf) = ggx.sample_reflection(u)?;
        let incoming = frame.to_scene(light.truncate(), light.z);
        Some(scattered(incoming, Vec3::splat(weight * self.coat.reflected(cosine)), pdf))
    }
}

/// The direction that a mirror shows.
#[inline]
fn mirrored(outgoing: Vec3, normal: Vec3, cosine: f32) -> Vec3 {
    normal * (2.0 * cosine) - outgoing
}

#[inline]
fn scattered(incoming: Vec3, weight: Vec3, pdf: f32) -> BsdfSample {
    BsdfSample { incoming, weight, pdf, is_delta: false, transmitted: false, eta: 1.0 }
}

#[inline]
fn delta(incoming: Vec3, weight: Vec3) -> BsdfSample {
    BsdfSample { incoming, weight, pdf: f32::INFINITY, is_delta: true, transmitted: false, eta: 1.0 }
}
