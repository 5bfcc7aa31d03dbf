//! Laws of sums, weights, denoisers and layers, at the extremes and beside models in f64.
#![expect(clippy::float_cmp, reason = "the laws state equal bits")]

#[path = "prop/denoisers.rs"]
mod denoisers;
#[path = "prop/holes.rs"]
mod holes;
#[path = "prop/layers.rs"]
mod layers;
#[path = "prop/sums.rs"]
mod sums;
#[path = "prop/weights.rs"]
mod weights;

use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use layered_filter::{
    ATrous, CrossBilateral, Denoiser, GuideRecord, GuideScale, Light, LuminanceWeight, PreparedGuide, Taps, View,
    WeightSettings,
};
use proptest::prelude::*;

/// Floats of every kind: all bit patterns, so NaN, infinities, subnormal numbers and both zeros too.
fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        (-40_i32..40, -1.0_f32..1.0).prop_map(|(e, m)| m * 2.0_f32.powi(e)),
        prop::sample::select(vec![0.0, -0.0, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN, 1e-12, 1e12, 1e7]),
    ]
}

fn unit(seed: [u32; 4]) -> [f32; 4] {
    pcg4d(seed).map(to_unit_f32)
}

/// A guide with a vertex on one of a few surfaces, some of them alike.
fn guide(seed: u32, i: u32) -> GuideRecord {
    let [a, b, c, d] = unit([i, seed, 1, 7]);
    let normal = if a < 0.7 { Vec3::Y } else { Vec3::new(0.3, 1.0 - b, b - 0.5) }.normalize();
    let color = if c < 0.8 { 0.5 } else { c };
    GuideRecord {
        position_path: [a * 0.1, b * 0.001, d * 0.1, 2.0 + 0.01 * d],
        normal_segment: normal.extend(2.0 + 0.002 * b).to_array(),
        albedo_shininess: [color, 0.4, 0.4, if d < 0.8 { 0.0 } else { 30.0 }],
        throughput: [b, c, d, 100.0 * a],
    }
}

/// Every seventh pixel shows no vertex.
fn guides(seed: u32, pixels: u32) -> Vec<GuideRecord> {
    (0..pixels).map(|i| if (i + seed).is_multiple_of(7) { GuideRecord::NONE } else { guide(seed, i) }).collect()
}

fn prepared(records: &[GuideRecord]) -> Vec<PreparedGuide> {
    let scale = GuideScale::new(1.0).expect("a radius");
    records.iter().map(|record| PreparedGuide::new(&scale, record)).collect()
}

/// All settings that the laws are tried with.
fn settings() -> Vec<WeightSettings> {
    let paper = WeightSettings::PAPER;
    let surface = WeightSettings::surface(0.002);
    vec![
        paper,
        surface,
        WeightSettings { luminance: LuminanceWeight::Deviation { scale: 4.0 }, ..surface },
        WeightSettings { luminance: LuminanceWeight::Deviation { scale: 1.0 }, position_scale: 10.0, ..paper },
        WeightSettings { luminance: LuminanceWeight::Significance { scale: 2.0 }, ..surface },
        WeightSettings { luminance: LuminanceWeight::Difference { scale: 0.5, kappa: 1e-6 }, ..paper },
        WeightSettings { normal_scale: 0.0, ..paper },
    ]
}

/// All denoisers that the laws are tried with.
fn denoisers() -> Vec<Box<dyn Denoiser>> {
    let mut all: Vec<Box<dyn Denoiser>> = Vec::new();
    for settings in settings() {
        all.push(Box::new(CrossBilateral::new(&settings, 5.0, 2, 3).expect("settings of a test")));
        let wide = CrossBilateral::new(&settings, 9.0, 1, 3).expect("settings of a test");
        let by_samples = wide.with_radius_by_samples(400.0).expect("settings of a test");
        all.push(Box::new(by_samples));
        all.push(Box::new(by_samples.with_wide_pass(&settings, 20.0, 4000.0, 1.5).expect("settings of a test")));
        all.push(Box::new(ATrous::new(&settings, Taps::Nine, 4).expect("settings of a test")));
        all.push(Box::new(ATrous::new(&settings, Taps::TwentyFive, 3).expect("settings of a test")));
    }
    all
}

/// All passes, by whatever cut.
fn run(denoiser: &dyn Denoiser, view: &View<'_>, image: &[Light], cut: usize) -> Vec<Light> {
    let mut from = image.to_vec();
    for pass in 0..denoiser.passes() {
        let mut to = vec![[0.0; 4]; from.len()];
        for (k, part) in to.chunks_mut(cut).enumerate() {
            layered_filter::filter_pixels(denoiser, pass, view, &from, k * cut, part);
        }
        from = to;
    }
    from
}
