//! How samples are shared out among kinds of emitters.

use alloc::vec::Vec;

use crate::scene::PunctualLight;

/// Bounds of the part of samples that goes to what shines from outside (the environment image, directional lights) when
/// other emitters exist too. Power alone would starve the lamps of a room on a wide ground plane, or the window of a
/// hall full of lamps. Triangles and the image would then be found by scattering only, the rest not at all.
const OUTSIDE_SHARE: (f64, f64) = (0.25, 0.75);

/// A light without extent gets at least this part of what the mean emitter of its kind gets: nothing else finds it, and
/// the numbers that choose have 24 bits.
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Probabilities of a light list.
pub(super) struct Shares {
    /// Chance that a sample goes to the environment image.
    pub environment: f64,
    /// Chance that a sample goes to a triangle, over the triangle's power.
    pub density_per_power: f64,
}

impl Shares {
    /// Turns the power of each emitter into its weight among all but the environment image, whose power is `sky`. The
    /// first `triangles` weights are those of triangles, which change by a common factor only, `punctual` follow.
    pub(super) fn new(weights: &mut [f64], triangles: usize, punctual: &[PunctualLight], sky: f64) -> Self {
        let (of_triangles, of_punctual) = weights.split_at_mut(triangles);
        let is_sun = |light: &PunctualLight| light.is_directional();
        let raise = |of_punctual: &mut [f64], suns: bool, others: &[f64]| -> f64 {
            let of_kind = || punctual.iter().zip(0..).filter(|(light, _)| is_sun(light) == suns).map(|(_, i)| i);
            let sum = others.iter().sum::<f64>() + of_kind().map(|i: usize| of_punctual[i]).sum::<f64>();
            let least = sum / (others.len() + of_kind().count()).max(1) as f64 * LEAST_SHARE;
            for i in of_kind().filter(|&i| of_punctual[i] > 0.0).collect::<Vec<_>>() {
                of_punctual[i] = of_punctual[i].max(least);
            }
            others.iter().sum::<f64>() + of_kind().map(|i| of_punctual[i]).sum::<f64>()
        };
        let inside = raise(of_punctual, false, of_triangles);
        let suns = raise(of_punctual, true, &[]);
        let outside = suns + sky;
        if outside <= 0.0 {
            return Self { environment: 0.0, density_per_power: if inside > 0.0 { 1.0 / inside } else { 0.0 } };
        }
        if inside <= 0.0 {
            return Self { environment: sky / outside, density_per_power: 0.0 };
        }
        let share = (outside / (outside + inside)).clamp(OUTSIDE_SHARE.0, OUTSIDE_SHARE.1);
        // Weights inside add up to `inside`, which stands for a chance of 1 − share.
        let factor = share / (1.0 - share) * inside / outside;
        for (_, weight) in punctual.iter().zip(of_punctual).filter(|(light, _)| is_sun(light)) {
            *weight *= factor;
        }
        Self { environment: share * (sky / outside), density_per_power: (1.0 - share) / inside }
    }
}
