//! Estimates against what they estimate, on pictures that are made up.

use super::*;

const PIXELS: u32 = 2000;

/// An even number in [0, 1).
fn draw(words: [u32; 3]) -> f64 {
    f64::from(hash::pcg3d(words)[0]) / 2.0_f64.powi(32)
}

/// A fixed picture with errors that neighbours share, and the truth.
fn picture(pixel: u32) -> [f64; 2] {
    let truth = 0.2 + draw([pixel, 1, 2]);
    [truth + 0.1 * draw([pixel / 40, 3, 4]) - 0.02, truth]
}

/// What a check with this seed sees: skewed noise, eight times the light in one path of eight.
fn check(seed: u32, fraction: f64) -> Vec<Compared> {
    let luminances: Vec<_> = (0..PIXELS).map(|pixel| picture(pixel)[0]).collect();
    let chances = (0..PIXELS).zip(probabilities(&luminances, fraction));
    chances
        .filter(|&(pixel, probability)| is_chosen(pixel, seed, probability))
        .map(|(pixel, probability)| {
            let [picture, truth] = picture(pixel);
            let truths = [5, 6].map(|half| if draw([pixel, seed, half]) < 0.125 { 8.0 * truth } else { 0.0 });
            Compared { picture, truths, probability }
        })
        .collect()
}

fn truths() -> [f64; 2] {
    let off = |pixel| picture(pixel)[0] - picture(pixel)[1];
    let n = f64::from(PIXELS);
    [(0..PIXELS).map(off).sum::<f64>() / n, (0..PIXELS).map(|p| off(p).powi(2)).sum::<f64>() / n]
}

/// Both intervals hold the truth in about 95 of 100 checks (that of squares, which are more skewed, in 90 at least), for a few
/// pixels and for all of them; and that of the bias is no wider than it must be.
#[test]
fn intervals_cover() {
    const SEEDS: u32 = 1000;
    let [bias_is, square_is] = truths();
    for fraction in [0.1, 0.5, 1.0] {
        let (mut held, mut held_square, mut squares, mut width) = (0, 0, 0.0, 0.0);
        for seed in 0..SEEDS {
            let compared = check(seed, fraction);
            let of_bias = bias(&compared, PIXELS.into()).unwrap();
            let of_square = mean_square(&compared, PIXELS.into()).unwrap();
            held += u32::from(of_bias.low <= bias_is && bias_is <= of_bias.high);
            held_square += u32::from(of_square.low <= square_is && square_is <= of_square.high);
            squares += (of_bias.value - bias_is).powi(2);
            width += of_bias.high - of_bias.low;
        }
        let (held, held_square) = (f64::from(held) / f64::from(SEEDS), f64::from(held_square) / f64::from(SEEDS));
        // 1000 seeds know 95 % to ±0.7 %.
        assert!((0.93..=0.98).contains(&held), "{fraction}: bias in {held}");
        assert!(held_square >= 0.9, "{fraction}: square in {held_square}");
        let (width, scatter) = (width / f64::from(SEEDS), (squares / f64::from(SEEDS)).sqrt());
        let needed = 2.0 * 1.96 * scatter;
        assert!((width / needed - 1.0).abs() < 0.1, "{fraction}: {width} wide, {needed} would do");
    }
}

#[test]
fn a_check_of_all_pixels_without_noise_is_exact() {
    let of = |pixel| {
        let [picture, truth] = picture(pixel);
        Compared { picture, truths: [truth; 2], probability: 1.0 }
    };
    let all: Vec<_> = (0..PIXELS).map(of).collect();
    let Interval { value, low, high } = bias(&all, PIXELS.into()).unwrap();
    let [bias_is, square_is] = truths();
    assert!((value - bias_is).abs() < 1e-12 && high - low < 1e-9, "{low} to {high}");
    assert!((mean_square(&all, PIXELS.into()).unwrap().value - square_is).abs() < 1e-12);
}

#[test]
fn choices_have_the_share_asked_for() {
    let share = |seed, fraction| (0..100_000).filter(|&pixel| is_chosen(pixel, seed, fraction)).count();
    for seed in [0, 1, u32::MAX] {
        assert_eq!((share(seed, 0.0), share(seed, 1.0)), (0, 100_000));
        // Five standard deviations of a binomial.
        for fraction in [0.001, 0.1, 0.5, 0.999] {
            let (count, expected) = (share(seed, fraction) as f64, 1e5 * fraction);
            assert!(
                (count - expected).abs() < 5.0 * (expected * (1.0 - fraction)).sqrt(),
                "{seed} {fraction}: {count}"
            );
        }
    }
    for fraction in [1e-4, 0.1, 0.5, 0.999, 1.0] {
        // A lamp, a dark wall, and what is no light at all.
        let picture: Vec<f64> = (0..1000).map(|i| if i < 10 { 1e12 } else { f64::from(i % 7) }).collect();
        for luminances in [picture, vec![0.0; 1000], vec![f64::NAN, f64::INFINITY, -1.0, 2.0]] {
            let chances = probabilities(&luminances, fraction);
            let mean = chances.iter().sum::<f64>() / chances.len() as f64;
            assert!(chances.iter().all(|p| *p > 0.0 && *p <= 1.0) && (mean - fraction).abs() < 1e-9, "{mean}");
            assert!(chances.len() < 1000 || chances[0] >= chances[500], "bright ones first");
        }
    }
    let differ = (0..1000).filter(|&pixel| is_chosen(pixel, 0, 0.5) != is_chosen(pixel, 1, 0.5)).count();
    assert!((400..600).contains(&differ), "{differ} of 1000 differ between seeds");
    assert_ne!(path_seed(0), path_seed(1));
}

#[test]
fn few_pixels_give_no_interval_and_extremes_stay_finite() {
    let one = Compared { picture: 1.0, truths: [1.0, 0.5], probability: 0.3 };
    assert!(bias(&[], 10).is_none() && mean_square(&[one; LEAST_PIXELS - 1], 100).is_none());
    assert!(bias(&[one; LEAST_PIXELS], 100).is_some());
    for scale in [0.0, 1e-12, 1e12, 1e30] {
        let all = [Compared { picture: scale, truths: [0.0, scale], probability: 1e-6 }; LEAST_PIXELS];
        for Interval { value, low, high } in [bias(&all, 30).unwrap(), mean_square(&all, 30).unwrap()] {
            assert!(low <= value && value <= high && low.is_finite() && high.is_finite(), "{low} {value} {high}");
        }
    }
    let none = standard_errors(&[]);
    assert_eq!((none.pixels, none.unknown, none.relative), (0, 0, None));
    let pixels = [(1.0, 0.04), (3.0, f32::INFINITY), (2.0, 0.16)];
    let pixels = pixels.map(|(radiance, variance)| NoisePixel { radiance, variance });
    let some = standard_errors(&pixels);
    assert_eq!((some.pixels, some.unknown), (2, 1));
    assert!((some.mean - 0.3).abs() < 1e-6 && (some.rms - 0.1_f64.sqrt()).abs() < 1e-6);
    assert!((some.relative.unwrap() - some.rms / 2.0).abs() < 1e-6);
}
