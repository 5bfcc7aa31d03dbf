//! How noisy a lookup's answer is.

use glam::Vec3;

use crate::float;

/// Variance of a sample over its squared mean where a layout does not keep it, and before samples tell: path traced light
/// is mostly dark, now and then bright.
const ASSUMED: f32 = 4.0;

/// Samples that the assumption counts for beside those that were measured: a few samples that are alike by luck are
/// not taken for light without noise.
const ASSUMED_SAMPLES: f32 = 8.0;

/// Luminance of linear Rec. 709 light.
#[inline]
pub(super) fn luminance(rgb: Vec3) -> f32 {
    0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z
}

/// The variance of a mean over levels, each of which holds the samples of all finer ones, or nearly: every level has its own jitter.
#[derive(Clone, Copy)]
pub(super) struct Scatter {
    /// `Σ w_l·w_m / max(n_l, n_m)` over pairs of settled levels: the share of a sample's variance that the mean has, as the
    /// covariance of two means, one of whose samples are among the other's, is the variance of a sample over the larger number.
    share: f32,
    /// `Σ w_l` of the settled levels.
    weight: f32,
    /// Samples of the settled level that has most.
    most: f32,
    /// Share in the mean, number of samples and a sample's standard deviation of the coarsest level, which is not settled.
    own: f32,
    count: f32,
    deviation: f32,
}

impl Scatter {
    /// Of no level yet.
    pub(super) const NONE: Self = Self { share: 0.0, weight: 0.0, most: 0.0, own: 0.0, count: 1.0, deviation: 0.0 };

    /// Variance of a sample over the squared mean, from `count` samples of mean luminance `mean` and root mean square
    /// `scatter`.
    #[inline]
    pub(super) fn relative(mean: f32, scatter: Option<f32>, count: u32) -> f32 {
        match scatter {
            // At most `count` samples, one of which has all the light; rounding may end below 0.
            Some(scatter) if mean > 0.0 => {
                let ratio = scatter / mean;
                let (n, measured) = (count as f32, (ratio * ratio - 1.0).clamp(0.0, count as f32));
                (n * measured + ASSUMED_SAMPLES * ASSUMED) / (n + ASSUMED_SAMPLES)
            }
            _ => ASSUMED,
        }
    }

    /// Adds a level coarser than those before, of the share `weight`.
    #[inline]
    pub(super) fn add(&mut self, weight: f32, mean: f32, relative: f32, count: u32) {
        self.settle();
        self.own = weight;
        self.count = count as f32;
        self.deviation = mean * float::sqrt(relative);
    }

    #[inline]
    fn settle(&mut self) {
        self.most = self.most.max(self.count);
        self.share += self.own * (self.own / self.count + 2.0 * self.weight / self.most);
        self.weight += self.own;
    }

    /// The variance, when the coarsest level has the share `left` beside what it was added with: above 0, and at most
    /// [`f32::MAX`].
    #[inline]
    pub(super) fn variance(mut self, left: f32) -> f32 {
        self.own += left;
        self.settle();
        let deviation = self.deviation * float::sqrt(self.share);
        (deviation * deviation).clamp(f32::MIN_POSITIVE, f32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One level of n samples: the variance of a sample over n.
    #[test]
    fn one_level_is_a_mean() {
        let mut scatter = Scatter::NONE;
        // 1000 samples, half of them 0 and half 2: mean 1, mean square 2, variance 1.
        let relative = Scatter::relative(1.0, Some(2.0_f32.sqrt()), 1000);
        scatter.add(0.25, 1.0, relative, 1000);
        let expected = (1000.0 + 32.0) / 1008.0 / 1000.0;
        assert!((scatter.variance(0.75) / expected - 1.0).abs() < 1e-5);
    }

    /// Two levels: Var(w·a + (1 − w)·b) where b's samples hold a's, by sampling variances of their disjoint parts.
    #[test]
    fn levels_share_their_samples() {
        let (n, m, w) = (10.0_f32, 40.0_f32, 0.3_f32);
        let mut scatter = Scatter::NONE;
        scatter.add(w, 2.0, ASSUMED, n as u32);
        scatter.add(0.1, 2.0, ASSUMED, m as u32);
        // b = (n·a + (m − n)·rest)/m: a has the weight w + (1 − w)·n/m, the rest what is left.
        let first = w + (1.0 - w) * n / m;
        let expected = 4.0 * ASSUMED * (first * first / n + (1.0 - first) * (1.0 - first) / (m - n));
        assert!((scatter.variance(0.6) / expected - 1.0).abs() < 1e-5);
    }

    /// Jitter may find fewer samples in a coarser level: the mean gains nothing from them, but is no noisier than they are.
    #[test]
    fn a_sparse_coarser_level_adds_what_it_weighs() {
        let mut scatter = Scatter::NONE;
        scatter.add(0.9, 2.0, ASSUMED, 100);
        scatter.add(0.05, 2.0, ASSUMED, 1);
        let share = 0.9 * 0.9 / 100.0 + 0.1 * 0.1 / 1.0 + 2.0 * 0.9 * 0.1 / 100.0;
        assert!((scatter.variance(0.05) / (4.0 * ASSUMED * share) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn extremes_are_finite_and_above_zero() {
        for mean in [0.0, f32::MIN_POSITIVE, 1e-12, 1e12, f32::MAX] {
            for scatter in [None, Some(0.0), Some(f32::MAX), Some(mean)] {
                for count in [1, u32::MAX] {
                    let mut of = Scatter::NONE;
                    of.add(0.5, mean, Scatter::relative(mean, scatter, count), count);
                    let variance = of.variance(0.5);
                    assert!(variance > 0.0 && variance <= f32::MAX, "{mean:e}, {scatter:?}, {count}: {variance:e}");
                }
            }
        }
    }
}
