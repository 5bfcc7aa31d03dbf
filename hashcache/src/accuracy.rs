//! How wrong a picture is: what its own samples tell, and what paths without a cache tell of some of its pixels.

use hashcache_core::hash;
use layered_filter::NoisePixel;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

use crate::stats::Rays;

/// Salt of the draws that choose pixels, unlike those of paths.
const SALT_CHOICE: u32 = 0x9d2c_5680;

/// Salt of the seed of the paths that check.
const SALT_PATHS: u32 = 0xefc6_0000;

/// Share of the intervals that hold what they are about.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// Pixels below which no interval is given: means of fewer that are as skewed as path traced light are not yet normal.
pub(crate) const LEAST_PIXELS: usize = 30;

/// Standard errors of a picture's pixels, before the filter: what the scatter of samples and of a cache's answers tells.
/// Luminances, in units of radiance. What emitters, edges and textures inside a pixel scatter is not in it, nor is bias.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StderrStats {
    /// Pixels whose error is known.
    pub pixels: u64,
    /// Pixels whose error is not known: of too few samples, or without any light of their own.
    pub unknown: u64,
    /// Mean of the known ones.
    pub mean: f64,
    /// Root mean square of the known ones.
    pub rms: f64,
    /// `rms` over the mean luminance of all pixels; `None` for a black picture.
    pub relative: Option<f64>,
}

/// A number and the interval that holds it in 95 of 100 cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What unbiased paths at some pixels tell of a picture's error.
///
/// The intervals are about *this* picture: it is fixed, with all its noise and blur; random are the choice of pixels and
/// the paths through them. So noise that the picture's pixels share through a cache does not make an interval too
/// narrow: it is part of the error that is told. Another seed's picture has another bias.
///
/// Intervals rest on a mean over independent differences being nearly normal. Light that one path in a thousand finds
/// (caustics) is not seen by fewer paths than that, and then an interval is too narrow: the more paths, the better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CheckStats {
    /// Pixels that were traced.
    pub pixels: u64,
    /// Paths through each, those of earlier frames at rest included.
    pub samples_per_pixel: u32,
    /// Mean luminance of the picture.
    pub mean_radiance: f64,
    /// Mean luminance of picture − truth over all pixels; `None` with fewer than 30 checked.
    pub bias: Option<Interval>,
    /// `bias` over `mean_radiance`; `None` for a black picture, too.
    pub relative_bias: Option<Interval>,
    /// Mean square of the luminance of picture − truth over all pixels, free of the paths' own noise; so it may come out
    /// below 0 where that is larger. Squares are more skewed than differences: its interval holds in 90 to 95 cases of 100.
    /// `None` with fewer than 30 checked.
    pub mse: Option<Interval>,
    /// Rays of all frames' checks; they are not among those of the pictures.
    pub rays: Rays,
    /// Contributions of those paths that were NaN or infinite and were left out.
    pub non_finite: u64,
}

/// A checked pixel's luminance in the picture, two independent unbiased estimates of the truth, and how likely its
/// choice was.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared {
    pub picture: f64,
    pub truths: [f64; 2],
    pub probability: f64,
}

/// How likely each pixel's choice is, for luminances of a picture: in proportion to luminance and a share of its mean,
/// at most 1, and `fraction` on average. The paths' noise follows the light, so that each chosen pixel says about as much
/// as any other, and the few at the edges of lamps, which differ most, are hardly ever missed.
///
/// # Source
/// Cochran 1977, 9A.3 (choice in proportion to size).
pub(crate) fn probabilities(luminances: &[f64], fraction: f64) -> Vec<f64> {
    let count = luminances.len() as f64;
    let known = |y: f64| if y > 0.0 && y.is_finite() { y } else { 0.0 };
    let mean = luminances.iter().map(|&y| known(y)).sum::<f64>() / count.max(1.0);
    let size = |y: f64| if mean > 0.0 { known(y) / mean + DARK_SHARE } else { 1.0 };
    let sizes: Vec<f64> = luminances.iter().map(|&y| size(y)).collect();
    let of = |scale: f64| sizes.iter().map(move |size| (scale * size).min(1.0));
    // The least size is at least `DARK_SHARE`: this scale chooses all.
    let (mut low, mut high) = (0.0, 1.0 / DARK_SHARE);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if of(middle).sum::<f64>() < fraction * count { low = middle } else { high = middle }
    }
    if fraction >= 1.0 { vec![1.0; sizes.len()] } else { of(high).collect() }
}

/// What a black pixel's chance has of a pixel's of mean luminance: bias in the dark is not to be missed either.
const DARK_SHARE: f64 = 0.25;

/// Halvings of the range of a scale: to the last bit.
const BISECTIONS: u32 = 60;

/// Whether a pixel is among those that are checked.
pub(crate) fn is_chosen(pixel: u32, seed: u32, probability: f64) -> bool {
    let draw = hash::finish(hash::mix(hash::mix(SALT_CHOICE, seed), pixel));
    // Exact: 32 bits times a double.
    f64::from(draw) < probability * 2.0_f64.powi(32)
}

/// The seed of the paths that check: their numbers are independent of the picture's.
pub(crate) const fn path_seed(seed: u32) -> u32 {
    hash::finish(hash::mix(SALT_PATHS, seed))
}

/// Linear Rec. 709 luminance.
pub(crate) fn luminance(rgb: [f32; 3]) -> f64 {
    let [r, g, b] = rgb.map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Sums up the pixels' errors.
pub(crate) fn standard_errors(pixels: &[NoisePixel]) -> StderrStats {
    let (mut known, mut sum, mut squares, mut radiance) = (0_u64, 0.0, 0.0, 0.0);
    for pixel in pixels {
        radiance += f64::from(pixel.radiance);
        if pixel.variance.is_finite() {
            let variance = f64::from(pixel.variance);
            known += 1;
            sum += variance.sqrt();
            squares += variance;
        }
    }
    let count = known.max(1) as f64;
    let (mean, rms) = (sum / count, (squares / count).sqrt());
    let of_all = radiance / pixels.len().max(1) as f64;
    let relative = (of_all > 0.0 && known > 0).then(|| rms / of_all);
    StderrStats { pixels: known, unknown: pixels.len() as u64 - known, mean, rms, relative }
}

/// The mean over all `pixels` of picture − truth, from those that were chosen.
///
/// # Source
/// Horvitz & Thompson 1952: a sum in which each chosen value D is divided by its chance π. Chosen independently, and D of
/// variance V by the paths, its variance is Σ (1 − π)·D²/π² + V/π over the chosen. Half the difference of a pixel's two
/// truths, squared, is V.
pub(crate) fn bias(compared: &[Compared], pixels: u64) -> Option<Interval> {
    let terms = compared.iter().map(|c| {
        let difference = c.picture - 0.5 * (c.truths[0] + c.truths[1]);
        let paths = (0.5 * (c.truths[0] - c.truths[1])).powi(2);
        let p = c.probability;
        [difference / p, (1.0 - p) * (difference / p).powi(2) + paths / p]
    });
    interval(terms, pixels)
}

/// The mean over all `pixels` of (picture − truth)², from those that were chosen.
///
/// A product of two differences, each with paths of its own, has the square of the truth's as its mean. What such a product
/// scatters by is not known apart, so that all of it is taken for scatter: too much rather than too little.
pub(crate) fn mean_square(compared: &[Compared], pixels: u64) -> Option<Interval> {
    let terms = compared.iter().map(|c| {
        let product = (c.picture - c.truths[0]) * (c.picture - c.truths[1]) / c.probability;
        [product, product.powi(2)]
    });
    interval(terms, pixels)
}

/// Student's interval about a mean over `pixels` of which some have a term and a variance of it. The fewer terms most of the
/// variance comes from, the less it is known: it has (Σ v)²/Σ v² degrees of freedom.
///
/// # Source
/// Satterthwaite 1946.
fn interval(terms: impl ExactSizeIterator<Item = [f64; 2]>, pixels: u64) -> Option<Interval> {
    if terms.len() < LEAST_PIXELS {
        return None;
    }
    let (mut sum, mut variance, mut squares) = (0.0, 0.0, 0.0);
    for [term, of_term] in terms {
        sum += term;
        variance += of_term;
        squares += of_term.powi(2);
    }
    let all = pixels as f64;
    let freedom = if squares > 0.0 { (variance * (variance / squares)).max(LEAST_FREEDOM) } else { LEAST_FREEDOM };
    // Always made: scale and freedom are above 0.
    let student = StudentsT::new(0.0, 1.0, freedom);
    let quantile = student.map_or(f64::INFINITY, |student| student.inverse_cdf(0.5 + 0.5 * CONFIDENCE));
    let (value, half) = (sum / all, quantile * variance.sqrt() / all);
    Some(Interval { value, low: value - half, high: value + half })
}

/// The least degrees of freedom: with fewer, Student's distribution has no variance.
const LEAST_FREEDOM: f64 = 2.0;

impl Interval {
    /// The same in other units.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { value: self.value * factor, low: self.low * factor, high: self.high * factor }
    }
}

#[cfg(test)]
mod tests;
