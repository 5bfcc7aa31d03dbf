//! How samples are shared out among kinds of emitters.

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
        let is_outside = |i: usize| i >= triangles && punctual[i - triangles].position[3] == PunctualLight::DIRECTIONAL;
        for outside in [false, true] {
            let members = || (0..weights.len()).filter(|&i| is_outside(i) == outside);
            let least = members().map(|i| weights[i]).sum::<f64>() / members().count().max(1) as f64 * LEAST_SHARE;
            for i in triangles..weights.len() {
                if is_outside(i) == outside && weights[i] > 0.0 {
                    weights[i] = weights[i].max(least);
                }
            }
        }
        let sum = |outside: bool| -> f64 {
            (0..weights.len()).filter(|&i| is_outside(i) == outside).map(|i| weights[i]).sum()
        };
        let (inside, suns) = (sum(false), sum(true));
        let outside = suns + sky;
        if outside <= 0.0 {
            return Self { environment: 0.0, density_per_power: if inside > 0.0 { 1.0 / inside } else { 0.0 } };
        }
        let share =
            if inside > 0.0 { (outside / (outside + inside)).clamp(OUTSIDE_SHARE.0, OUTSIDE_SHARE.1) } else { 1.0 };
        if inside > 0.0 && suns > 0.0 {
            // Weights inside add up to `inside`, which stands for a chance of 1 − share.
            let factor = share / (1.0 - share) * inside / outside;
            for i in triangles..weights.len() {
                if is_outside(i) {
                    weights[i] *= factor;
                }
            }
        }
        let density_per_power = if inside > 0.0 { (1.0 - share) / inside } else { 0.0 };
        Self { environment: share * (sky / outside), density_per_power }
    }
}
