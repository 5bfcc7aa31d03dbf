//! How noisy an answer is told to be.

use hashcache_core::exact::Quantum;
use hashcache_core::octree::{CellRecord, ExactCell, OctreeCache, OctreeSettings, PaperCell};
use hashcache_core::traits::RadianceCache;

use super::room::{Noise, QUADS, lit, octree, params, plain, vertex};

/// Luminance of `lit(1.0)`.
const LUMINANCE: f64 = 0.2126 + 0.5 * 0.7152 + 0.25 * 0.0722;

/// A sample as path tracing gives it: mostly dark, now and then bright.
fn sample(noise: &mut Noise) -> f32 {
    let x = noise.unit();
    if x < 0.9 { 0.1 * noise.unit() } else { 8.0 * noise.unit() }
}

/// Every cell's root mean square is that of its samples, after many frames, at any exposure.
#[test]
fn cells_know_their_scatter() {
    for exponent in [-12, 0, 12] {
        let unit = 10.0_f64.powi(exponent) as f32;
        let settings = OctreeSettings { quantum: Quantum::for_scale(64.0 * unit), ..plain() };
        let mut cache = OctreeCache::<ExactCell>::new(octree(&QUADS, 8), params(&settings));
        let mut noise = Noise(4);
        let (mut squares, mut count) = (0.0, 0);
        for frame in 0..200 {
            for _ in 0..frame % 5 {
                let value = sample(&mut noise);
                cache.record(&lit(value * unit));
                squares += (f64::from(value) * LUMINANCE).powi(2);
                count += 1;
            }
            cache.end_frame();
        }
        let expected = (squares / f64::from(count)).sqrt();
        let cells = (0..cache.octree().view().cells()).map(|index| cache.cell(index));
        let mut found =
            cells.flat_map(|cell| [0, 1].map(|side| (cell.side(side, settings.quantum), cell.scatter[side])));
        assert!(found.clone().any(|(side, _)| side.count == count));
        assert!(found.all(|(side, scatter)| {
            if side.count == 0 { scatter == 0.0 } else { (f64::from(scatter / unit) / expected - 1.0).abs() < 1e-4 }
        }));
    }
}

/// Over many runs, answers scatter by the variance that they tell.
#[test]
fn variances_are_those_of_answers() {
    let settings = OctreeSettings { shrinkage: 16.0, min_samples: 400, max_climb: 31, ..plain() };
    let octree = std::sync::Arc::new(octree(&[QUADS[0]], 8));
    let (mut told, mut means) = (0.0, Vec::new());
    for seed in 0..300 {
        let mut cache = OctreeCache::<ExactCell>::new(octree.clone(), params(&settings));
        let mut noise = Noise(seed * 7919);
        for _ in 0..600 {
            let mut place = vertex(&mut noise, &[QUADS[0]]);
            let light = lit(sample(&mut noise));
            (place.direct, place.further, place.normal) = ([0.0; 4], light.further, light.normal);
            cache.record(&place);
        }
        cache.end_frame();
        let answer = cache.estimate(&lit(0.0));
        told += f64::from(answer.variance) / 300.0;
        means.push(f64::from(answer.further.x) * LUMINANCE);
    }
    let mean = means.iter().sum::<f64>() / 300.0;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 299.0;
    // A variance of 300 values is known to ±8 %; the number of samples of a cell is random, too.
    assert!((told / variance - 1.0).abs() < 0.3, "{told:e} told, {variance:e} found");
}

/// A layout without scatter assumes it; what was not found tells none; and what is told is finite and above 0.
#[test]
fn every_answer_tells_its_variance() {
    let mut exact = OctreeCache::<ExactCell>::new(octree(&QUADS, 8), params(&plain()));
    let mut paper = OctreeCache::<PaperCell>::new(octree(&QUADS, 8), params(&plain()));
    for cache in [&mut exact as &mut dyn RadianceCache, &mut paper] {
        assert_eq!(cache.estimate(&lit(1.0)).variance, 0.0, "its own light");
        for _ in 0..1000 {
            cache.record(&lit(0.5));
        }
        cache.end_frame();
        let answer = cache.estimate(&lit(0.0));
        assert!(answer.variance > 0.0 && answer.variance < 1e-2, "{answer:?}");
    }
    let y = 0.5 * LUMINANCE;
    let assumed = f64::from(paper.estimate(&lit(0.0)).variance);
    assert!((assumed / (4.0 * y * y / 1000.0) - 1.0).abs() < 1e-2, "twice the mean over √1000: {assumed:e}");
    assert!(f64::from(exact.estimate(&lit(0.0)).variance) < 0.02 * assumed, "samples that are all alike");
    let mut black = OctreeCache::<ExactCell>::new(octree(&QUADS, 8), params(&plain()));
    black.record(&lit(0.0));
    black.end_frame();
    let answer = black.estimate(&lit(0.0));
    assert!(answer.variance > 0.0 && answer.variance < 1e-30, "known, and next to nothing");
}
