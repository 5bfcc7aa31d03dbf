//! The one-dimensional kernels of the eye's blur and of the feature detectors.

use core::f64::consts::PI;

use super::FLIP_PIXELS_PER_DEGREE;

/// Pixels to each side of the blur kernels: three standard deviations of the widest Gaussian.
pub(super) const BLUR_RADIUS: usize = 10;
/// Pixels to each side of the feature kernels: three standard deviations.
pub(super) const FEATURE_RADIUS: usize = 9;

/// A kernel of odd length.
pub(super) type Blur = [f64; 2 * BLUR_RADIUS + 1];
/// A kernel of odd length.
pub(super) type Feature = [f64; 2 * FEATURE_RADIUS + 1];

/// The scales b of the contrast sensitivity's Gaussians a·√(π/b)·exp(−π²x²/b), in square degrees, for Y, Cx and the
/// two of Cz; amplitudes are 1 but for the last two.
const SCALES: [f64; 4] = [0.0047, 0.0053, 0.04, 0.025];
const BLUE_YELLOW_AMPLITUDES: [f64; 2] = [34.1, 13.5];

/// Width in degrees of the features that the eye is drawn to.
const FEATURE_WIDTH: f64 = 0.082;

/// All kernels.
pub(super) struct Kernels {
    /// Gaussians of sum 1 for Y, Cx, Cz and Cz.
    pub blurs: [Blur; 4],
    /// The shares of the two that Cz is blurred with, which sum to 1.
    pub blue_yellow: [f64; 2],
    /// A Gaussian of sum 1, its first and its second derivative: positive weights sum to 1, negative ones to −1.
    pub features: [Feature; 3],
}

impl Kernels {
    /// The kernels at [`FLIP_PIXELS_PER_DEGREE`].
    pub fn new() -> Self {
        let raw = SCALES.map(|scale| {
            kernel::<{ 2 * BLUR_RADIUS + 1 }>(|x| {
                let degrees = x / FLIP_PIXELS_PER_DEGREE;
                (-PI * PI * degrees * degrees / scale).exp()
            })
        });
        // In two dimensions each Gaussian weighs its amplitude times the square of its sum.
        let weight = |i: usize| {
            let sum: f64 = raw[2 + i].iter().sum();
            BLUE_YELLOW_AMPLITUDES[i] * (PI / SCALES[2 + i]).sqrt() * sum * sum
        };
        let total = weight(0) + weight(1);
        let deviation = 0.5 * FEATURE_WIDTH * FLIP_PIXELS_PER_DEGREE;
        let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        Self {
            blurs: raw.map(normalized),
            blue_yellow: [weight(0) / total, weight(1) / total],
            features: [
                normalized(kernel(gaussian)),
                normalized(kernel(|x| -x * gaussian(x))),
                normalized(kernel(|x| (x * x / (deviation * deviation) - 1.0) * gaussian(x))),
            ],
        }
    }
}

/// `f` at whole distances from the middle.
fn kernel<const N: usize>(f: impl Fn(f64) -> f64) -> [f64; N] {
    core::array::from_fn(|i| f(i as f64 - (N / 2) as f64))
}

/// Scales positive and negative weights, each to a sum of 1 and −1.
fn normalized<const N: usize>(kernel: [f64; N]) -> [f64; N] {
    let positive: f64 = kernel.iter().filter(|&&k| k > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|&&k| k < 0.0).sum::<f64>();
    kernel.map(|k| {
        if k > 0.0 {
            k / positive
        } else if k < 0.0 {
            k / negative
        } else {
            0.0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_three_deviations() {
        let widest = SCALES.into_iter().fold(0.0, f64::max);
        let blur = 3.0 * (widest / (2.0 * PI * PI)).sqrt() * FLIP_PIXELS_PER_DEGREE;
        assert_eq!(blur.ceil() as usize, BLUR_RADIUS);
        assert_eq!((1.5 * FEATURE_WIDTH * FLIP_PIXELS_PER_DEGREE).ceil() as usize, FEATURE_RADIUS);
    }

    #[test]
    fn kernels_are_normalized() {
        let Kernels { blurs, blue_yellow, features } = Kernels::new();
        let one = |sum: f64| assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        for blur in &blurs {
            one(blur.iter().sum());
        }
        one(blue_yellow.iter().sum());
        one(features[0].iter().sum());
        for derivative in &features[1..] {
            one(derivative.iter().map(|k| k.max(0.0)).sum());
            one(derivative.iter().map(|k| -k.min(0.0)).sum());
        }
    }
}
