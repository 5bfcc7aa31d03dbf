//! A test for bias: several runs against a reference of known variance, block by block.

use statrs::function::beta::beta_reg;

use crate::{Error, ImageView};

/// Side of a block in pixels.
///
/// 16: 256 pixels pull a block's noise down sixteenfold and make its mean nearly normal, while a bias that fills a
/// corner or a shadow's edge is not diluted by the rest of the image.
pub const BLOCK: usize = 16;

/// A block counts as beyond when its p-value is below this: 5 % of the blocks of an unbiased image are.
pub const BEYOND: f64 = 0.05;

/// The difference of a block's mean that is not held against an image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margin {
    /// As a share of the larger of both means: 1e-5 covers the rounding of `f32` sums.
    pub relative: f64,
    /// In radiance, for what rounds absolutely, such as 8-bit textures that two programs decode differently.
    pub absolute: f64,
}

/// How one channel of one block compares with the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockScore {
    /// Mean of the runs minus the reference, averaged over the block, in radiance.
    pub difference: f64,
    /// Standard deviation of `difference` under noise alone: runs' and reference's variance together, in radiance.
    pub sigma: f64,
    /// `difference / sigma` after the margin is taken off the difference; ±∞ when there is a difference and no noise.
    pub z: f64,
    /// Degrees of freedom of `sigma` (Welch–Satterthwaite), infinite when the runs have no variance.
    pub degrees: f64,
    /// Probability that noise alone gives a |z| as large (Student's t, two-sided).
    pub p: f64,
}

/// What [`block_test`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockTest {
    /// Blocks across and down; the last ones may be cut by the border.
    pub blocks: [usize; 2],
    /// A score for each block (row by row) and channel.
    pub scores: Vec<[BlockScore; 3]>,
    /// The largest |z|.
    pub max_abs_z: f64,
    /// Where the smallest p-value is: block across, block down, channel.
    pub worst: [usize; 3],
    /// Share of the blocks with a p-value below [`BEYOND`], for each channel; about [`BEYOND`] without bias.
    pub share_beyond: [f64; 3],
    /// Probability that an unbiased image looks at least this bad, at most 1.
    pub p_value: f64,
}

impl BlockTest {
    /// Whether noise explains the differences, when one unbiased image in `1 / false_alarm` may be called biased.
    ///
    /// 1e-4 is a good choice for a test suite: a hundred tests fail by chance once in a hundred runs.
    pub fn passes(&self, false_alarm: f64) -> bool {
        self.p_value >= false_alarm
    }
}

/// Compares the mean of independent runs with a reference on 16×16 blocks ([`BLOCK`]), by how much noise allows.
///
/// `runs` are images of the same view with different seeds; their spread gives the variance of their mean, pixel by pixel.
/// `reference_variance` is the variance *of the reference's mean*. Pixels must be independent of each other (no filter,
/// no cache), as they are for plain path tracing. `margin` is what is not held against the image, see [`Margin`].
///
/// # The test
/// For each block and channel z = (|mean difference| − margin)⁺ / σ, where σ² sums the variances of the block's
/// pixels. σ is itself estimated from few runs, so z follows Student's t, with the degrees of freedom of Welch and
/// Satterthwaite: near pixels × (runs − 1) for even noise, near runs − 1 when one pixel rules. Two things are judged:
/// the smallest p-value of all blocks and channels (one region is wrong), by Bonferroni's bound over all of them; and for
/// each channel how many blocks fall below [`BEYOND`] (everything is a little wrong), by the binomial distribution.
/// [`BlockTest::p_value`] is Bonferroni's bound over both, so the probability of a false alarm is at most what is
/// handed to [`BlockTest::passes`], whatever the correlation between channels.
///
/// The bound holds as far as block means are normal. Light that most runs never see (a caustic of one path in a million)
/// is missing in mean *and* variance: give such images more samples or leave their blocks out.
///
/// # Errors
/// [`Error::TooFewRuns`] below two runs, [`Error::SizesDiffer`], [`Error::NegativeVariance`], [`Error::Margin`].
///
/// # Source
/// Welch 1947.
///
/// ```
/// use image_metrics::{ImageView, Margin, block_test};
///
/// // Four runs of a grey wall whose noise is ±0.1, and an exact reference.
/// let run = |seed: u32| -> Vec<[f32; 3]> {
///     let noise = |i: u32| f64::from((i + 977 * seed).wrapping_mul(2_654_435_761)) / 4_294_967_296.0 - 0.5;
///     (0..64 * 64).map(|i| [(0.5 + 0.2 * noise(i)) as f32; 3]).collect()
/// };
/// let runs: Vec<_> = (1..=4).map(run).collect();
/// let views: Vec<_> = runs.iter().map(|r| ImageView::new(64, 64, r)).collect::<Result<_, _>>()?;
/// let (grey, brighter, none) = ([[0.5; 3]; 64 * 64], [[0.52; 3]; 64 * 64], [[0.0; 3]; 64 * 64]);
/// let none = ImageView::new(64, 64, &none)?;
/// let margin = Margin { relative: 1e-5, absolute: 0.0 };
/// let view = |pixels| ImageView::new(64, 64, pixels);
/// assert!(block_test(&views, view(&grey)?, none, margin)?.passes(1e-4));
/// assert!(!block_test(&views, view(&brighter)?, none, margin)?.passes(1e-4));
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn block_test(
    runs: &[ImageView],
    reference: ImageView,
    reference_variance: ImageView,
    margin: Margin,
) -> Result<BlockTest, Error> {
    if runs.len() < 2 {
        return Err(Error::TooFewRuns { runs: runs.len() });
    }
    for image in runs.iter().chain([&reference_variance]) {
        image.same_size(&reference)?;
    }
    let negative = reference_variance.pixels().iter().filter(|p| p.iter().any(|&v| v < 0.0)).count();
    if negative > 0 {
        return Err(Error::NegativeVariance { count: negative });
    }
    if !(margin.relative >= 0.0 && margin.absolute >= 0.0) {
        return Err(Error::Margin);
    }
    let blocks = [reference.width().div_ceil(BLOCK), reference.height().div_ceil(BLOCK)];
    let sums = block_sums(runs, reference, reference_variance, blocks[0]);
    let scores = sums.iter().map(|block| block.map(|sum| sum.score(margin))).collect();
    Ok(judge(blocks, scores))
}

/// Sums over the pixels of a block, one channel.
#[derive(Clone, Copy, Default)]
struct BlockSums {
    pixels: f64,
    mean: f64,
    reference: f64,
    /// Variance of the runs' mean, and the sum of its squares over (runs − 1).
    run_variance: f64,
    run_variance_squares: f64,
    reference_variance: f64,
}

fn block_sums(
    runs: &[ImageView],
    reference: ImageView,
    reference_variance: ImageView,
    across: usize,
) -> Vec<[BlockSums; 3]> {
    let count = runs.len() as f64;
    let (width, height) = (reference.width(), reference.height());
    let mut sums = vec![[BlockSums::default(); 3]; across * height.div_ceil(BLOCK)];
    for i in 0..width * height {
        let block = &mut sums[i / width / BLOCK * across + i % width / BLOCK];
        for (c, sum) in block.iter_mut().enumerate() {
            let values = || runs.iter().map(|run| f64::from(run.pixels()[i][c]));
            let mean = values().sum::<f64>() / count;
            let spread: f64 = values().map(|v| (v - mean) * (v - mean)).sum();
            let variance = spread / (count - 1.0) / count;
            sum.pixels += 1.0;
            sum.mean += mean;
            sum.reference += f64::from(reference.pixels()[i][c]);
            sum.run_variance += variance;
            sum.run_variance_squares += variance * variance / (count - 1.0);
            sum.reference_variance += f64::from(reference_variance.pixels()[i][c]);
        }
    }
    sums
}

impl BlockSums {
    fn score(self, margin: Margin) -> BlockScore {
        let difference = self.mean - self.reference;
        let forgiven = margin.relative * self.mean.abs().max(self.reference.abs()) + margin.absolute * self.pixels;
        let excess = (difference.abs() - forgiven).max(0.0);
        let variance = self.run_variance + self.reference_variance;
        let degrees = if self.run_variance_squares > 0.0 {
            variance * variance / self.run_variance_squares
        } else {
            f64::INFINITY
        };
        let z = if excess > 0.0 { excess.copysign(difference) / variance.sqrt() } else { 0.0 };
        BlockScore {
            difference: difference / self.pixels,
            sigma: variance.sqrt() / self.pixels,
            z,
            degrees,
            p: two_sided_p(z, degrees),
        }
    }
}

/// Student's t: the probability of a larger |t|. Beyond a million degrees of freedom it is the normal distribution's.
fn two_sided_p(t: f64, degrees: f64) -> f64 {
    const MANY: f64 = 1e6;
    let degrees = degrees.clamp(1.0, MANY);
    if t.is_infinite() {
        return 0.0;
    }
    beta_reg(0.5 * degrees, 0.5, degrees / (degrees + t * t))
}

/// Probability of `beyond` blocks or more out of `blocks` when each is beyond with probability [`BEYOND`].
fn at_least(beyond: usize, blocks: usize) -> f64 {
    if beyond == 0 { 1.0 } else { beta_reg(beyond as f64, (blocks - beyond) as f64 + 1.0, BEYOND) }
}

fn judge(blocks: [usize; 2], scores: Vec<[BlockScore; 3]>) -> BlockTest {
    let mut worst = [0; 3];
    let mut smallest = f64::INFINITY;
    let mut max_abs_z = 0.0_f64;
    let mut beyond = [0_usize; 3];
    for (b, block) in scores.iter().enumerate() {
        for (c, score) in block.iter().enumerate() {
            max_abs_z = max_abs_z.max(score.z.abs());
            beyond[c] += usize::from(score.p < BEYOND);
            if score.p < smallest {
                smallest = score.p;
                worst = [b % blocks[0], b / blocks[0], c];
            }
        }
    }
    let one_region = smallest * (3 * scores.len()) as f64;
    let everywhere = 3.0 * beyond.map(|n| at_least(n, scores.len())).into_iter().fold(1.0, f64::min);
    BlockTest {
        blocks,
        max_abs_z,
        worst,
        share_beyond: beyond.map(|n| n as f64 / scores.len() as f64),
        p_value: (2.0 * one_region.min(everywhere)).min(1.0),
        scores,
    }
}
