//! Laws of the metrics, for any finite pixels.

#![expect(clippy::float_cmp, reason = "equal inputs give equal bits")]

use image_metrics::{
    ImageView, energy_ratio, flip, flip_map, ms_ssim, mse, psnr, rel_mse, rel_mse_trimmed, srgb_encode,
};
use proptest::prelude::*;

/// Radiance from far below to far above what a renderer makes, of either sign, zero included.
fn radiance() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.0_f32..4.0,
        1 => (-12_i32..=12, -1.0_f32..1.0).prop_map(|(e, m)| m * 10.0_f32.powi(e)),
        1 => prop::sample::select(vec![0.0, -0.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, f32::MIN]),
    ]
}

fn images() -> impl Strategy<Value = (usize, Vec<[f32; 3]>, Vec<[f32; 3]>)> {
    (1_usize..9, 1_usize..9).prop_flat_map(|(w, h)| {
        let pixels = || prop::collection::vec([radiance(), radiance(), radiance()], w * h);
        (Just(w), pixels(), pixels())
    })
}

fn view(width: usize, pixels: &[[f32; 3]]) -> ImageView<'_> {
    ImageView::new(width, pixels.len() / width, pixels).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Nothing becomes NaN, errors are not negative, trimming never adds.
    #[test]
    fn metrics_are_numbers((w, a, b) in images()) {
        let (a, b) = (view(w, &a), view(w, &b));
        let (whole, trimmed) = (rel_mse(a, b).unwrap(), rel_mse_trimmed(a, b).unwrap());
        prop_assert!(whole.is_finite() && whole >= 0.0);
        prop_assert!(trimmed >= 0.0 && trimmed <= whole * (1.0 + 1e-12));
        let e = mse(a, b).unwrap();
        prop_assert!(e.is_finite() && e >= 0.0);
        prop_assert!(psnr(a, b).unwrap() >= 0.0);
        prop_assert!(!energy_ratio(a, b).unwrap().whole.is_nan());
        prop_assert!(flip_map(a, b).unwrap().iter().all(|e| (0.0..=1.0).contains(e)));
    }

    #[test]
    fn an_image_equals_itself((w, a, _) in images()) {
        let a = view(w, &a);
        prop_assert_eq!(rel_mse(a, a).unwrap(), 0.0);
        prop_assert_eq!(rel_mse_trimmed(a, a).unwrap(), 0.0);
        prop_assert_eq!(mse(a, a).unwrap(), 0.0);
        prop_assert_eq!(psnr(a, a).unwrap(), f64::INFINITY);
        prop_assert_eq!(flip(a, a).unwrap(), 0.0);
        let energy = energy_ratio(a, a).unwrap();
        prop_assert_eq!((energy.whole, energy.channels), (1.0, [1.0; 3]));
    }

    /// MSE, PSNR and FLIP do not care which image is the reference; energy turns round; relMSE does care.
    #[test]
    fn symmetry((w, a, b) in images()) {
        let (a, b) = (view(w, &a), view(w, &b));
        prop_assert_eq!(mse(a, b).unwrap(), mse(b, a).unwrap());
        prop_assert_eq!(psnr(a, b).unwrap(), psnr(b, a).unwrap());
        prop_assert_eq!(flip_map(a, b).unwrap(), flip_map(b, a).unwrap());
        let (ab, ba) = (energy_ratio(a, b).unwrap().whole, energy_ratio(b, a).unwrap().whole);
        prop_assert!((ab * ba - 1.0).abs() < 1e-12 || ab == 0.0 || ba == 0.0);
    }

    /// Powers of two change no bits: MSE scales with the square, energy stays, doubling one image doubles its ratio.
    #[test]
    fn scale(e in -20_i32..20, pixels in prop::collection::vec(([0.01_f32..100.0, 0.01..100.0, 0.01..100.0], [0.01_f32..100.0, 0.01..100.0, 0.01..100.0]), 1..40)) {
        let (a, b): (Vec<_>, Vec<_>) = pixels.into_iter().unzip();
        let s = 2.0_f32.powi(e);
        let scaled = |image: &[[f32; 3]]| -> Vec<[f32; 3]> { image.iter().map(|p| p.map(|c| c * s)).collect() };
        let (sa, sb) = (scaled(&a), scaled(&b));
        let (a, b, sa, sb) = (view(1, &a), view(1, &b), view(1, &sa), view(1, &sb));
        let s = f64::from(s);
        prop_assert_eq!(mse(sa, sb).unwrap(), mse(a, b).unwrap() * s * s);
        prop_assert_eq!(energy_ratio(sa, sb).unwrap(), energy_ratio(a, b).unwrap());
        prop_assert_eq!(energy_ratio(sa, b).unwrap().whole, energy_ratio(a, b).unwrap().whole * s);
        // Brighter light makes epsilon matter less.
        let (scaled, plain) = (rel_mse(sa, sb).unwrap(), rel_mse(a, b).unwrap());
        let ordered = if e >= 0 { scaled >= plain } else { scaled <= plain };
        prop_assert!(ordered, "{} at {} times {}", scaled, s, plain);
    }

    /// A turned picture has the turned map: rows and columns are filtered alike. A screen shows no more than white.
    #[test]
    fn flip_turns_with_the_picture((w, a, b) in images()) {
        let turn = |image: &[[f32; 3]]| -> Vec<[f32; 3]> {
            let h = image.len() / w;
            (0..image.len()).map(|i| image[i % h * w + i / h]).collect()
        };
        let (ta, tb) = (turn(&a), turn(&b));
        let h = a.len() / w;
        let (map, turned) = (flip_map(view(w, &a), view(w, &b)).unwrap(), flip_map(view(h, &ta), view(h, &tb)).unwrap());
        for (i, e) in turned.iter().enumerate() {
            prop_assert!((e - map[i % h * w + i / h]).abs() < 1e-5);
        }
        let clip: Vec<_> = a.iter().map(|p| p.map(|c| c.clamp(0.0, 1.0))).collect();
        prop_assert_eq!(flip(view(w, &a), view(w, &clip)).unwrap(), 0.0);
    }

    /// The order of pixels does not matter beyond rounding.
    #[test]
    fn pixels_may_be_reordered((_, mut a, mut b) in images()) {
        let before = rel_mse(view(1, &a), view(1, &b)).unwrap();
        a.reverse();
        b.reverse();
        let after = rel_mse(view(1, &a), view(1, &b)).unwrap();
        prop_assert!((before - after).abs() <= 1e-12 * before);
    }

    #[test]
    fn encoding_is_monotonous_and_bounded(a in radiance(), b in radiance()) {
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        let (a, b) = (srgb_encode(a.into()), srgb_encode(b.into()));
        prop_assert!(0.0 <= a && a <= b && b <= 1.0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// MS-SSIM is 1 for equal images, symmetric, inside [0, 1], and falls as noise grows; FLIP rises.
    #[test]
    fn structure(seed in 1_usize..1000, w in 176_usize..200, h in 176_usize..200) {
        let noise = |i: usize| (((i * 2_654_435_761 * (2 * seed + 1)) >> 9) % 1024) as f32 / 1024.0;
        let image = |amount: f32| -> Vec<[f32; 3]> {
            (0..w * h).map(|i| [0.2 + 0.5 * ((i / 20) % 2) as f32 + amount * noise(i); 3]).collect()
        };
        let (clean, some, much) = (image(0.0), image(0.1), image(0.3));
        let (clean, some, much) = (view(w, &clean), view(w, &some), view(w, &much));
        prop_assert_eq!(ms_ssim(some, some).unwrap(), 1.0);
        let (s, m) = (ms_ssim(some, clean).unwrap(), ms_ssim(much, clean).unwrap());
        prop_assert!((s - ms_ssim(clean, some).unwrap()).abs() < 1e-12);
        prop_assert!(0.0 < m && m < s && s < 1.0, "{m} {s}");
        let (s, m) = (flip(some, clean).unwrap(), flip(much, clean).unwrap());
        prop_assert!(0.0 < s && s < m && m < 1.0, "{s} {m}");
    }
}

/// MS-SSIM at the extremes of radiance: a screen clips them.
#[test]
fn structure_of_extremes() {
    let black = vec![[f32::MIN; 3]; 176 * 176];
    let white = vec![[f32::MAX; 3]; 176 * 176];
    let (black, white) = (view(176, &black), view(176, &white));
    assert_eq!(ms_ssim(black, black).unwrap(), 1.0);
    let apart = ms_ssim(black, white).unwrap();
    assert!((0.0..0.5).contains(&apart), "{apart}");
}
