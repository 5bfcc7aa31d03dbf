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

    /// Chooses a lobe with its [probability](Self::lobes), which is exactly 1 when there is no choice; the diffuse one
    /// when the surface is black. `u` is uniform in `[0, 1)`.
    #[inline]
    pub fn pick(&self, u: f32) -> LobePick {
        let mut chosen = LobePick { lobe: Lobe::Diffuse, probability: 1.0 };
        let mut rest = u;
        for lobe in Lobe::ALL {
            let probability = self.probabilities[lobe as usize];
            if probability > 0.0 {
                // The last lobe that weighs anything takes what rounding leaves over.
                chosen = LobePick { lobe, probability };
                if rest < probability {
                    break;
                }
                rest -= probability;
            }
        }
        chosen
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
