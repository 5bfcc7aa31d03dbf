//! Laws of [`Denoiser`], for every denoiser of the crate.

use layered_filter::{ATrous, CrossBilateral, Denoiser, GuideRecord, HOLE, Light, Taps, View, WeightSettings};
use proptest::prelude::*;

use super::{any_float, denoisers, guides, prepared, run, unit};

fn image(seed: u32, pixels: u32, size: f32) -> Vec<Light> {
    (0..pixels)
        .map(|i| {
            let [r, g, b, v] = unit([i, seed, 5, 5]);
            [r * size, g * size, b * size, v * size * size * 0.1]
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn cuts_do_not_matter(width in 1_u32..40, height in 1_u32..24, seed in any::<u32>()) {
        let guides = prepared(&guides(seed, width * height));
        let view = View::new(width, height, &guides).unwrap();
        let image = image(seed, width * height, 1.0);
        for denoiser in denoisers() {
            let whole = run(&*denoiser, &view, &image, image.len());
            for cut in [1, 7, width as usize] {
                prop_assert!(run(&*denoiser, &view, &image, cut) == whole);
            }
        }
    }

    /// Every result is a mean: between the least and the largest value, whatever the exposure.
    #[test]
    fn results_stay_in_range(width in 1_u32..40, height in 1_u32..24, seed in any::<u32>(), e in -40_i32..=40) {
        let guides = prepared(&guides(seed, width * height));
        let view = View::new(width, height, &guides).unwrap();
        let image = image(seed, width * height, 2.0_f32.powi(e));
        for denoiser in denoisers() {
            let filtered = run(&*denoiser, &view, &image, image.len());
            for channel in 0..3 {
                let values = || image.iter().map(|light| light[channel]);
                let (least, largest) = (values().fold(f32::MAX, f32::min), values().fold(0.0, f32::max));
                for light in &filtered {
                    let value = light[channel];
                    prop_assert!(value >= least * 0.99999 && value <= largest * 1.00001, "{value}");
                    prop_assert!(light[3] >= 0.0 && light[3] <= 2.0_f32.powi(2 * e), "{light:?}");
                }
            }
        }
    }

    #[test]
    fn flat_images_stay_flat(
        width in 1_u32..40, height in 1_u32..24, seed in any::<u32>(),
        r in 1e-12_f32..1e-10, g in 0.0_f32..1.0, b in 1e11_f32..1e12, known in any::<bool>(),
    ) {
        let guides = prepared(&guides(seed, width * height));
        let view = View::new(width, height, &guides).unwrap();
        let flat = vec![[r, g, b, if known { 0.0 } else { f32::INFINITY }]; (width * height) as usize];
        for denoiser in denoisers() {
            for light in run(&*denoiser, &view, &flat, flat.len()) {
                prop_assert_eq!(&light[..3], &[r, g, b][..]);
            }
        }
    }

    /// Any bits in guides and light: no panic, and finite light stays finite.
    #[test]
    fn hostile_pixels_do_not_spread(
        width in 1_u32..9, height in 1_u32..9,
        bits in prop::collection::vec(prop::array::uniform20(any_float()), 81),
    ) {
        let pixels = (width * height) as usize;
        let mut guides = prepared(&guides(1, width * height));
        let mut image = image(2, width * height, 1.0);
        for i in (0..pixels).step_by(2) {
            let [a, b, c, d, light] = bytemuck::cast::<_, [[f32; 4]; 5]>(bits[i]);
            guides[i] = bytemuck::cast([a, b, c, d]);
            image[i] = light;
        }
        let view = View::new(width, height, &guides).unwrap();
        for denoiser in denoisers() {
            let filtered = run(&*denoiser, &view, &image, pixels);
            for (i, light) in filtered.iter().enumerate().skip(1).step_by(2) {
                prop_assert!(light[..3].iter().all(|v| v.is_finite() && *v >= 0.0), "{i}: {light:?}");
                prop_assert!(light[3] >= 0.0, "{i}: {light:?}");
            }
        }
    }
}

/// Two surfaces of unlike normals: no light crosses, and each side's noise shrinks.
#[test]
fn edges_stop_light_and_noise_shrinks() {
    let (width, height) = (40, 40);
    let side = |i: u32| if i % width < 20 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let records: Vec<_> = (0..width * height)
        .map(|i| {
            let [x, y, z] = side(i);
            GuideRecord {
                position_path: [0.0, 0.0, 0.0, 1.0],
                normal_segment: [x, y, z, 1.0],
                albedo_shininess: [0.5, 0.5, 0.5, 0.0],
                ..GuideRecord::NONE
            }
        })
        .collect();
    let guides = prepared(&records);
    let view = View::new(width, height, &guides).unwrap();
    let noisy: Vec<Light> = (0..width * height)
        .map(|i| {
            let noise = 0.2 * (unit([i, 1, 2, 3])[0] - 0.5);
            let light = if i % width < 20 { 1.0 } else { 2.0 } + noise;
            // The variance of a uniform number is its width squared over 12.
            [light, light, light, 0.2 * 0.2 / 12.0]
        })
        .collect();
    let surface = WeightSettings::surface(0.002);
    let all: [&dyn Denoiser; 2] =
        [&CrossBilateral::new(&surface, 8.0, 1, 0).unwrap(), &ATrous::new(&surface, Taps::TwentyFive, 2).unwrap()];
    for denoiser in all {
        let filtered = run(denoiser, &view, &noisy, noisy.len());
        let error = |image: &[Light]| {
            let squares =
                image.iter().zip(0..).map(|(light, i)| (light[0] - if i % width < 20 { 1.0 } else { 2.0 }).powi(2));
            squares.sum::<f32>() / image.len() as f32
        };
        let (before, after) = (error(&noisy), error(&filtered));
        // 25 like pixels leave 1/25 of the variance; borders have fewer.
        assert!(after < before / 15.0, "{before} -> {after}");
        if denoiser.passes() > 1 {
            // Further passes take values for independent that share noise.
            continue;
        }
        let known = filtered.iter().map(|light| light[3]).sum::<f32>() / filtered.len() as f32;
        assert!(known > after * 0.7 && known < after * 1.4, "variance {known}, error squared {after}");
    }
}

#[test]
fn a_single_pixel_keeps_its_value() {
    let guides = prepared(&[super::guide(1, 1)]);
    let view = View::new(1, 1, &guides).unwrap();
    for light in [[0.3, 0.2, 0.1, 0.5], [0.0, 0.0, 0.0, HOLE]] {
        for denoiser in denoisers() {
            assert_eq!(run(&*denoiser, &view, &[light], 1), [light]);
        }
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused() {
    let guides = prepared(&guides(1, 6));
    assert!(View::new(2, 3, &guides).is_some());
    assert!(View::new(3, 3, &guides).is_none());
    assert!(View::new(0, 6, &[]).is_none());
    assert!(View::new(u32::MAX, u32::MAX, &guides).is_none());
    let paper = WeightSettings::PAPER;
    assert!(CrossBilateral::new(&paper, 0.5, 1, 0).is_err() && CrossBilateral::new(&paper, 1e4, 1, 0).is_err());
    assert!(CrossBilateral::new(&paper, 5.0, 0, 0).is_err() && ATrous::new(&paper, Taps::Nine, 9).is_err());
}

/// The pattern: 24 places, none farther than the radius, spread evenly, another turn at most pixels.
#[test]
fn taps_cover_the_disc() {
    let filter = CrossBilateral::new(&WeightSettings::PAPER, 20.0, 1, 5).unwrap();
    let (mut sum, mut squares, mut last, mut changes) = ([0, 0], 0, Vec::new(), 0);
    for x in 0..1000 {
        let taps: Vec<_> = filter.taps(0, x, 3, 20.0).collect();
        assert_eq!(taps.len(), 24);
        for &(dx, dy) in &taps {
            // A tap is rounded by up to √½.
            assert!(dx * dx + dy * dy <= 21 * 21 && (dx, dy) != (0, 0));
            sum = [sum[0] + dx, sum[1] + dy];
            squares += dx * dx + dy * dy;
        }
        changes += u32::from(taps != last);
        last = taps;
    }
    // Over a disc the mean of r² is R²/2.
    assert!((squares as f32 / 24_000.0 - 200.0).abs() < 10.0, "{squares}");
    assert!(sum.map(|s| (s as f32 / 24_000.0).abs() < 0.5) == [true; 2], "{sum:?}");
    // One pixel of sixteen repeats its neighbour's turn.
    assert!(changes > 880, "{changes}");
}

#[test]
fn discs_shrink_as_samples_grow() {
    let fixed = CrossBilateral::new(&WeightSettings::surface(0.002), 8.0, 1, 5).unwrap();
    let filter = fixed.with_radius_by_samples(400.0).unwrap();
    for (support, radius) in [(0.0, 8.0), (f32::NAN, 8.0), (1.0, 8.0), (25.0, 4.0), (400.0, 1.0), (f32::INFINITY, 1.0)]
    {
        assert_eq!(filter.radius(0, support), radius);
        assert_eq!(fixed.radius(0, support), 8.0);
    }
    let farthest = |radius| filter.taps(0, 9, 9, radius).map(|(dx, dy)| dx.abs().max(dy.abs())).max();
    assert_eq!((farthest(1.0), farthest(4.0), farthest(8.0)), (Some(1), Some(4), Some(8)));
    assert!(fixed.with_radius_by_samples(-1.0).is_err());

    // A wide pass before the other has a radius of its own, and its taps fill it though they are fewer.
    let surface = WeightSettings::surface(0.002);
    let both = filter.with_wide_pass(&surface, 32.0, 1600.0, 1.0).unwrap();
    assert_eq!([both.radius(0, 25.0), both.radius(1, 25.0), both.radius(0, 0.0)], [8.0, 4.0, 32.0]);
    assert_eq!((both.passes(), fixed.passes()), (2, 1));
    let squares: Vec<_> =
        (0..500).flat_map(|x| both.taps(0, x, 3, 32.0)).map(|(dx, dy)| (dx * dx + dy * dy) as f32).collect();
    let farthest = squares.iter().copied().fold(0.0, f32::max);
    assert!(farthest > 30.0 * 30.0 && farthest <= 33.0 * 33.0, "{farthest}");
    assert!((squares.iter().sum::<f32>() / squares.len() as f32 / 512.0 - 1.0).abs() < 0.1);
    for (radius, samples, deviations) in [(0.5, 0.0, 1.0), (8.0, -1.0, 1.0), (8.0, 0.0, 0.0), (f32::NAN, 0.0, 1.0)] {
        assert!(fixed.with_wide_pass(&surface, radius, samples, deviations).is_err());
    }
}

/// Noise that blocks of pixels share, as those of a cache's cell do, beside an edge in the light of a plane wall: a wide
/// pass that knows the variance takes most of the noise away, and leaves the edge where it is.
#[test]
fn significance_clears_what_cells_share_and_keeps_edges() {
    let (width, height, cell) = (128_u32, 128_u32, 12_u32);
    let records: Vec<_> = (0..width * height)
        .map(|_| GuideRecord {
            position_path: [0.0, 0.0, 0.0, 1.0],
            normal_segment: [0.0, 0.0, 1.0, 1.0],
            albedo_shininess: [0.5, 0.5, 0.5, 0.0],
            ..GuideRecord::NONE
        })
        .collect();
    let guides = prepared(&records);
    let view = View::new(width, height, &guides).unwrap();
    let light = |i: u32| if i % width < 60 { 1.0 } else { 4.0_f32 };
    let noisy: Vec<Light> = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width / cell, i / width / cell);
            let light = light(i) * (1.0 + 0.6 * (unit([x, y, 9, 9])[0] - 0.5));
            [light, light, light, (light * 0.6).powi(2) / 12.0]
        })
        .collect();
    let surface = WeightSettings::surface(0.002);
    let narrow = CrossBilateral::new(&surface, 8.0, 1, 0).unwrap();
    let error = |image: &[Light], columns: std::ops::Range<u32>| {
        let all = (0..).zip(image).filter(|(i, _)| columns.contains(&(i % width)));
        let errors: Vec<_> = all.map(|(i, v)| (v[0] / light(i) - 1.0).powi(2)).collect();
        errors.iter().sum::<f32>() / errors.len() as f32
    };
    let filtered = |filter: &CrossBilateral| run(filter, &view, &noisy, noisy.len());
    let with_wide = |filter: CrossBilateral| filtered(&filter.with_wide_pass(&surface, 32.0, 0.0, 2.0).unwrap());
    let far = 0..40;
    let (before, after) = (error(&filtered(&narrow), far.clone()), error(&with_wide(narrow), far));
    assert!(after < before / 2.0, "{before} -> {after} far from the edge");
    // The pass alone: the one after it knows no light.
    let mut wide = noisy.clone();
    let both = narrow.with_wide_pass(&surface, 32.0, 0.0, 2.0).unwrap();
    layered_filter::filter_pixels(&both, 0, &view, &noisy, 0, &mut wide);
    let at = 50..70;
    let (before, after) = (error(&noisy, at.clone()), error(&wide, at));
    assert!(after < before / 2.0, "{before} -> {after} at the edge");
}
