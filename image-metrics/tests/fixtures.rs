//! The metrics against numbers that other programs computed from the same pixels.
//!
//! Fixture images are integers over 128, so every language makes the same bits:
//! ```python
//! y, x, c = np.meshgrid(np.arange(h), np.arange(w), np.arange(3), indexing="ij")
//! R = (x//24 + y//16 + c) % 3 * 40 + (x*y + 7*c) % 31
//! N = (x*x*3 + y*y*5 + x*y*7 + c*11) % 17 + np.where((x*31 + y*17) % 1009 == 0, 3000, 0)
//! I = R + N  # both / 128, np.float32
//! ```
//! Expected values: numpy 2 and scipy 1.17, in double precision after rounding the encoded images to single:
//! ```python
//! e = (I - R)**2 / (R**2 + 0.01); relmse = e.mean()
//! p = np.sort(e.mean(-1).ravel()); trimmed = p[:int(len(p) * (1 - 0.001))].mean()
//! psnr = -10 * np.log10(((srgb(clip(I)) - srgb(clip(R)))**2).mean())
//! ```
//! FLIP, mean and map: the authors' own `flip-evaluator` 1.7 (Python) on the sRGB-encoded images, with its defaults:
//! ```python
//! m, mean, _ = flip_evaluator.evaluate(srgb(clip(R)), srgb(clip(I)), "LDR", applyMagma=False)
//! mean = m.mean(dtype=np.float64)
//! ```
//! (On seven rendered scenes, each with strong and with weak noise added, the means differ by at most 3e-8.)
//! MS-SSIM: `scipy.ndimage.correlate1d` with the 11-tap Gaussian, σ = 1.5, valid pixels, 2×2 means between scales.

#![expect(clippy::float_cmp, reason = "equal sums have equal bits")]

use image_metrics::{Error, ImageView, energy_ratio, flip, flip_map, ms_ssim, mse, psnr, rel_mse, rel_mse_trimmed};

/// The reference (`k` = 0) and the image (`k` = 1) of a size.
fn image(width: usize, height: usize, k: usize) -> Vec<[f32; 3]> {
    let value = |x: usize, y: usize, c: usize| {
        let base = (x / 24 + y / 16 + c) % 3 * 40 + (x * y + 7 * c) % 31;
        let noise = (x * x * 3 + y * y * 5 + x * y * 7 + c * 11) % 17;
        let firefly = if (x * 31 + y * 17).is_multiple_of(1009) { 3000 } else { 0 };
        (base + (noise + firefly) * k) as f32 / 128.0
    };
    (0..width * height).map(|i| core::array::from_fn(|c| value(i % width, i / width, c))).collect()
}

struct Expected {
    size: [usize; 2],
    rel_mse: f64,
    trimmed: f64,
    mse: f64,
    psnr: f64,
    energy: [f64; 4],
    ms_ssim: Option<f64>,
    flip: f64,
    /// FLIP in the upper left, the upper right, the middle, the last row at a third, and the lower right.
    flip_map: [f32; 5],
}

/// Even and odd sizes; the second is too small for MS-SSIM and below 1000 pixels; the third is the smallest height.
const EXPECTED: [Expected; 3] = [
    Expected {
        size: [200, 181],
        rel_mse: 12.038_853_749_961_387,
        trimmed: 0.106_205_810_015_485_1,
        mse: 0.569_825_927_284_760_6,
        psnr: 21.795_445_464_424_144,
        energy: [1.212_016_376_652_870_7, 1.197_882_198_219_283_5, 1.205_228_387_661_634_5, 1.205_023_056_295_936_5],
        ms_ssim: Some(0.975_358_725_704_840_6),
        flip: 0.223_653_430_254_584_5,
        flip_map: [0.835_755_4, 0.269_748_06, 0.205_204_7, 0.253_080_43, 0.266_506_94],
    },
    Expected {
        size: [23, 11],
        rel_mse: 78.848_329_026_524_25,
        trimmed: 0.119_177_440_865_730_37,
        mse: 2.184_332_042_186_470_7,
        psnr: 19.955_273_542_530_53,
        energy: [2.601_552_795_031_056, 1.360_321_519_912_312_6, 1.207_761_515_817_405_3, 1.368_052_847_114_884_6],
        ms_ssim: None,
        flip: 0.240_121_672_040_389_98,
        flip_map: [0.835_755_4, 0.257_936_45, 0.209_646_25, 0.241_035_79, 0.263_357_94],
    },
    Expected {
        size: [177, 176],
        rel_mse: 12.775_520_731_524_942,
        trimmed: 0.405_600_648_534_653_16,
        mse: 0.608_108_649_819_584_2,
        psnr: 21.761_549_154_317_06,
        energy: [1.216_555_000_551_315_7, 1.201_065_252_532_300_7, 1.209_077_831_328_831, 1.208_849_632_981_429_1],
        ms_ssim: Some(0.975_242_290_947_981_8),
        flip: 0.224_168_496_990_875_82,
        flip_map: [0.835_755_4, 0.304_044_57, 0.266_120_55, 0.223_347_37, 0.292_324_48],
    },
];

/// Rounding of double sums in another order.
const SUM: f64 = 1e-12;
/// The expected values rounded encoded pixels to single precision: 2^-24 of a pixel, squared differences of about 0.1.
const ENCODED: f64 = 1e-6;
/// `flip-evaluator` computes in single precision, and its last step takes a square root of feature differences near 0:
/// on renders with bright lights its pixels are within 1e-4 of ours, on these images within 1e-5.
const SINGLE: f64 = 1e-5;

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() <= tolerance, "{found} instead of {expected}");
}

#[test]
fn metrics_equal_an_independent_computation() {
    for expected in EXPECTED {
        let [w, h] = expected.size;
        let (image, reference) = (image(w, h, 1), image(w, h, 0));
        let (i, r) = (ImageView::new(w, h, &image).unwrap(), ImageView::new(w, h, &reference).unwrap());
        close(rel_mse(i, r).unwrap(), expected.rel_mse, SUM);
        close(rel_mse_trimmed(i, r).unwrap(), expected.trimmed, SUM);
        close(mse(i, r).unwrap(), expected.mse, SUM);
        close(psnr(i, r).unwrap(), expected.psnr, ENCODED);
        let energy = energy_ratio(i, r).unwrap();
        for (found, expected) in energy.channels.iter().chain([&energy.whole]).zip(expected.energy) {
            close(*found, expected, SUM);
        }
        close(flip(i, r).unwrap(), expected.flip, SINGLE);
        let map = flip_map(i, r).unwrap();
        for ((x, y), expected) in
            [(0, 0), (w - 1, 0), (w / 2, h / 2), (w / 3, h - 1), (w - 1, h - 1)].into_iter().zip(expected.flip_map)
        {
            close(map[y * w + x].into(), expected.into(), SINGLE);
        }
        match expected.ms_ssim {
            Some(value) => close(ms_ssim(i, r).unwrap(), value, ENCODED),
            None => assert_eq!(ms_ssim(i, r), Err(Error::TooSmall { size: [w, h], least: 176 })),
        }
    }
}

#[test]
fn flip_of_a_line_and_of_one_pixel() {
    // Wider and higher kernels than the image, by `flip-evaluator` as above.
    for (w, expected) in [(1, 0.953_639_984_130_859_4), (40, 0.341_461_900_994_181_6)] {
        let (image, reference) = (image(w, 1, 1), image(w, 1, 0));
        let (i, r) = (ImageView::new(w, 1, &image).unwrap(), ImageView::new(w, 1, &reference).unwrap());
        close(flip(i, r).unwrap(), expected, 2.0 * SINGLE);
    }
}

#[test]
fn one_pixel_is_never_trimmed_away() {
    let (image, reference) = ([[2.0; 3]], [[1.0; 3]]);
    let (i, r) = (ImageView::new(1, 1, &image).unwrap(), ImageView::new(1, 1, &reference).unwrap());
    assert_eq!(rel_mse_trimmed(i, r).unwrap(), rel_mse(i, r).unwrap());
}

#[test]
fn trimming_follows_whole_pixels() {
    // Two bad pixels of 2001: ⌊2001·0.999⌋ = 1998 are kept, so three go.
    let reference = vec![[1.0; 3]; 2001];
    let mut image = reference.clone();
    (image[5], image[77], image[2000]) = ([9.0, 1.0, 1.0], [1.0, 1.0, 9.0], [1.0, 9.0, 1.0]);
    let r = ImageView::new(2001, 1, &reference).unwrap();
    assert_eq!(rel_mse_trimmed(ImageView::new(2001, 1, &image).unwrap(), r).unwrap(), 0.0);
    image[100] = [2.0, 1.0, 1.0];
    let e = rel_mse_trimmed(ImageView::new(2001, 1, &image).unwrap(), r).unwrap();
    close(e, 1.0 / 1.01 / 3.0 / 1998.0, 1e-9);
}

#[test]
fn broken_pixels_are_counted_and_refused() {
    let mut pixels = vec![[0.0; 3]; 12];
    (pixels[5][2], pixels[6][0], pixels[11]) = (f32::NAN, f32::NEG_INFINITY, [f32::INFINITY; 3]);
    let error = ImageView::new(4, 3, &pixels).unwrap_err();
    assert_eq!(error, Error::NonFinite { count: 3, of: 12, x: 1, y: 1 });
    assert_eq!(error.to_string(), "3 of 12 pixels are NaN or infinite, the first at x = 1, y = 1");
}

#[test]
fn impossible_sizes_are_refused() {
    assert_eq!(ImageView::new(0, 7, &[]), Err(Error::Size { width: 0, height: 7 }));
    assert_eq!(ImageView::new(usize::MAX, 2, &[]), Err(Error::Size { width: usize::MAX, height: 2 }));
    assert_eq!(ImageView::new(2, 2, &[[0.0; 3]]), Err(Error::PixelCount { expected: 4, found: 1 }));
    let pixels = [[0.0; 3]; 6];
    let (a, b) = (ImageView::new(3, 2, &pixels).unwrap(), ImageView::new(2, 3, &pixels).unwrap());
    let differ = Error::SizesDiffer { image: [3, 2], reference: [2, 3] };
    assert_eq!(rel_mse(a, b), Err(differ));
    assert_eq!(rel_mse_trimmed(a, b), Err(differ));
    assert_eq!(mse(a, b), Err(differ));
    assert_eq!(psnr(a, b), Err(differ));
    assert_eq!(ms_ssim(a, b), Err(differ));
    assert_eq!(energy_ratio(a, b), Err(differ));
    assert_eq!(flip(a, b), Err(differ));
    assert_eq!(flip_map(a, b), Err(differ));
}
