//! The block test: it may call unbiased images biased as rarely as it says, and must find bias that matters.

use image_metrics::{BLOCK, BlockTest, Error, ImageView, Margin, block_test};

const W: usize = 96;
const H: usize = 80;

/// A counter-based random number in (0, 1): PCG's output permutation, twice.
fn uniform(a: u32, b: u32) -> f64 {
    let pcg = |x: u32| {
        let s = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let w = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277_803_737);
        (w >> 22) ^ w
    };
    (f64::from(pcg(pcg(a) ^ b.wrapping_mul(0x9E37_79B9))) + 0.5) / 4_294_967_296.0
}

/// Noise of mean 0 and variance 1 with the long tail of Monte Carlo light: the mean of 16 exponential draws, scaled.
fn noise(index: usize, seed: u32) -> f64 {
    let draw = |k: u32| -uniform((index as u32) * 16 + k, seed).ln() - 1.0;
    (0..16).map(draw).sum::<f64>() / 4.0
}

/// What a pixel should be: from black to bright.
fn truth(i: usize) -> f64 {
    (i % W) as f64 * 0.1
}

/// A picture of `truth` with noise of a tenth of it, plus `bias`.
fn picture(seed: u32, deviation: f64, bias: impl Fn(usize) -> f64) -> Vec<[f32; 3]> {
    let channel = |i: usize, c: usize| truth(i) * (1.0 + deviation * noise(3 * i + c, seed)) + bias(i);
    (0..W * H).map(|i| core::array::from_fn(|c| channel(i, c) as f32)).collect()
}

fn test(runs: u32, experiment: u32, bias: impl Fn(usize) -> f64 + Copy) -> BlockTest {
    let seed = experiment * 64;
    let runs: Vec<_> = (1..=runs).map(|run| picture(seed + run, 0.1, bias)).collect();
    let reference = picture(seed, 0.02, |_| 0.0);
    let variance: Vec<[f32; 3]> = (0..W * H).map(|i| [(0.02 * truth(i)).powi(2) as f32; 3]).collect();
    let views: Vec<_> = runs.iter().map(|r| ImageView::new(W, H, r).unwrap()).collect();
    let view = |pixels| ImageView::new(W, H, pixels).unwrap();
    block_test(&views, view(&reference), view(&variance), relative(1e-5)).unwrap()
}

/// 100 unbiased experiments at a false-alarm probability of 0.05: 5 alarms at most are expected. More than 16 have a
/// probability of 1e-5 if the bound holds; the seeds are fixed, so the count is too.
fn relative(relative: f64) -> Margin {
    Margin { relative, absolute: 0.0 }
}

#[test]
fn false_alarms_are_as_rare_as_said() {
    let results: Vec<_> = (1..=100).map(|e| test(4, e, |_| 0.0)).collect();
    let alarms = results.iter().filter(|r| !r.passes(0.05)).count();
    assert!(alarms <= 16, "{alarms} alarms in 100 unbiased experiments");
    let share = results.iter().flat_map(|r| r.share_beyond).sum::<f64>() / 300.0;
    assert!((0.03..0.07).contains(&share), "{share} of the blocks are beyond");
}

#[test]
fn bias_in_one_block_is_found_and_located() {
    // Noise of a block's mean at x = 48…63: 5.5·0.1/√(256·8) = 0.012.
    let bias = |i: usize| if (i % W) / BLOCK == 3 && i / W / BLOCK == 2 { 0.15 } else { 0.0 };
    let result = test(8, 1, bias);
    assert!(!result.passes(1e-4), "p = {}", result.p_value);
    assert_eq!(result.worst[..2], [3, 2]);
    assert!(result.scores[2 * 6 + 3].iter().all(|s| s.z > 5.0 && (s.difference - 0.15).abs() < 0.05));
}

#[test]
fn slight_bias_everywhere_is_found() {
    // One and a half standard deviations of a block's mean: too little for any single block.
    let bias = |i: usize| 1.5 * truth(i) * 0.1 / (256.0 * 8.0_f64).sqrt();
    let result = test(8, 1, bias);
    assert!(result.share_beyond.iter().all(|&s| s > 0.15), "{:?}", result.share_beyond);
    assert!(!result.passes(1e-4), "p = {}", result.p_value);
    assert!(test(8, 1, |_| 0.0).passes(1e-4));
}

#[test]
fn a_margin_forgives_what_it_says() {
    let (same, brighter) = (vec![[1.0; 3]; 40 * 20], vec![[1.001; 3]; 40 * 20]);
    let none = vec![[0.0; 3]; 40 * 20];
    let view = |pixels| ImageView::new(40, 20, pixels).unwrap();
    let runs = [view(&brighter); 2];
    let strict = block_test(&runs, view(&same), view(&none), relative(1e-5)).unwrap();
    assert_eq!((strict.p_value, strict.max_abs_z), (0.0, f64::INFINITY));
    assert_eq!(strict.blocks, [3, 2]);
    let lenient = block_test(&runs, view(&same), view(&none), relative(0.002)).unwrap();
    assert_eq!((lenient.p_value, lenient.max_abs_z), (1.0, 0.0));
    let absolute = |absolute| Margin { relative: 0.0, absolute };
    assert!(!block_test(&runs, view(&same), view(&none), absolute(0.0009)).unwrap().passes(0.5));
    assert!(block_test(&runs, view(&same), view(&none), absolute(0.0011)).unwrap().passes(0.5));
}

#[test]
fn few_runs_are_judged_by_their_degrees_of_freedom() {
    // One noisy pixel in a quiet block: two runs give one degree of freedom.
    let none = vec![[0.0; 3]; 256];
    let (mut a, mut b) = (none.clone(), none.clone());
    (a[7], b[7]) = ([1.0; 3], [3.0; 3]);
    let view = |pixels| ImageView::new(16, 16, pixels).unwrap();
    let result = block_test(&[view(&a), view(&b)], view(&none), view(&none), relative(0.0)).unwrap();
    let score = result.scores[0][0];
    assert_eq!((score.degrees, score.z, score.difference), (1.0, 2.0, 2.0 / 256.0));
    // Student's t with one degree of freedom is Cauchy's distribution: 2/π·atan(1/2).
    assert!((score.p - (0.5_f64).atan() * core::f64::consts::FRAC_2_PI).abs() < 1e-12);
}

#[test]
fn extremes_stay_numbers() {
    let (huge, tiny) = (vec![[f32::MAX; 3]; 300], vec![[1e-45; 3]; 300]);
    let view = |pixels| ImageView::new(20, 15, pixels).unwrap();
    for (a, b) in [(&huge, &tiny), (&tiny, &huge), (&huge, &huge), (&tiny, &tiny)] {
        let result = block_test(&[view(a), view(b)], view(a), view(b), relative(0.0)).unwrap();
        assert!((0.0..=1.0).contains(&result.p_value));
        assert!(result.scores.iter().flatten().all(|s| !s.z.is_nan() && (0.0..=1.0).contains(&s.p)));
    }
}

#[test]
fn wrong_input_is_refused() {
    let (pixels, negative) = (vec![[1.0; 3]; 4], vec![[-1.0; 3]; 4]);
    let (a, wide) = (ImageView::new(2, 2, &pixels).unwrap(), ImageView::new(4, 1, &pixels).unwrap());
    let bad = ImageView::new(2, 2, &negative).unwrap();
    assert_eq!(block_test(&[a], a, a, relative(0.0)), Err(Error::TooFewRuns { runs: 1 }));
    assert_eq!(block_test(&[a, a], a, bad, relative(0.0)), Err(Error::NegativeVariance { count: 4 }));
    assert_eq!(block_test(&[a, a], a, a, relative(f64::NAN)), Err(Error::Margin));
    assert!(matches!(block_test(&[a, wide], a, a, relative(0.0)), Err(Error::SizesDiffer { .. })));
}
