//! Which lobe is estimated.

use glam::Vec3;

use super::{Bsdf, Lobe, LobePick};

impl Bsdf {
    /// Probability of each lobe, by [`Lobe`]'s number: about its share of the light that the surface sends to the
    /// viewer. 0 for lobes that send none.
    #[inline]
    pub fn lobes(&self) -> [f32; 4] {
        self.probabilities
    }

    /// Chooses a lobe with its [probability](Self::lobes); the diffuse one when the surface is black.
    #[inline]
    pub fn pick(&self, u: f32) -> LobePick {
        pick(&self.probabilities, 1.0, u).unwrap_or(LobePick { lobe: Lobe::Diffuse, probability: 1.0, u })
    }

    /// Chooses among all lobes but the diffuse one. `None` when there is no other.
    #[inline]
    pub fn pick_specular(&self, u: f32) -> Option<LobePick> {
        let [_, reflection, transmission, coat] = self.probabilities;
        pick(&[0.0, reflection, transmission, coat], reflection + transmission + coat, u)
    }

    /// Expected share of light that all lobes but the diffuse one bring to the viewer, by channel, at most 1.
    #[inline]
    pub fn specular_throughput(&self) -> Vec3 {
        let [_, reflection, transmission, coat] = self.albedos;
        (reflection + transmission + coat).min(Vec3::ONE)
    }

    /// Chances by expected share of light, all channels alike: none is left to luck.
    #[inline]
    pub(super) fn choose(&mut self) {
        let weights = self.albedos.map(Vec3::element_sum);
        let sum: f32 = weights[0] + weights[1] + weights[2] + weights[3];
        self.probabilities = if sum > 0.0 { weights.map(|w| w / sum) } else { [0.0; 4] };
    }
}

/// Largest number below 1.
const BELOW_1: f32 = 1.0 - f32::EPSILON / 2.0;

#[inline]
fn pick(weights: &[f32; 4], sum: f32, u: f32) -> Option<LobePick> {
    let mut rest = u * sum;
    let mut chosen = None;
    for lobe in Lobe::ALL {
        let weight = weights[lobe as usize];
        if weight > 0.0 {
            // The last lobe that weighs anything takes what rounding leaves over.
            chosen = Some(LobePick { lobe, probability: weight / sum, u: (rest / weight).min(BELOW_1) });
            if rest < weight {
                break;
            }
            rest -= weight;
        }
    }
    chosen
}
