//! A pixel's sums against means in f64, and with hostile samples.

use bytemuck::Zeroable;
use hashcache_core::glam::{DVec3, Vec3};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;
use layered_filter::image::is_hole;
use layered_filter::{Direct, GatherParams, GuideScale, LayerPixel, PreparedGuide};
use proptest::prelude::*;

use super::any_float;

const ANGLE: f32 = 0.002;

fn params(direct: Direct) -> GatherParams {
    GatherParams::new(ANGLE, direct, 1, 1).unwrap()
}

fn sum(direct: Direct, samples: &[(VertexRecord, Estimate)]) -> LayerPixel {
    let mut pixel = LayerPixel::zeroed();
    for (record, estimate) in samples {
        pixel.add(&params(direct), record, estimate);
    }
    pixel
}

/// What the pixel shows when nothing is filtered.
fn radiance(pixel: &LayerPixel) -> DVec3 {
    let light = |[r, g, b, _]: [f32; 4]| Vec3::new(r, g, b);
    let light = light(pixel.direct_light()) + light(pixel.further_light());
    (pixel.mean_emitted() + pixel.mean_throughput() * light).as_dvec3()
}

fn wide(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

fn rgb() -> impl Strategy<Value = [f32; 4]> {
    prop::array::uniform3(0.0_f32..1.0).prop_map(|[r, g, b]| [r, g, b, 0.0])
}

fn sample() -> impl Strategy<Value = (VertexRecord, Estimate)> {
    (rgb(), rgb(), rgb(), rgb(), 0_u32..8, prop::bool::weighted(0.8)).prop_map(
        |(direct, further, mut throughput, emitted, samples, valid)| {
            // Some channels reflect nothing.
            throughput[1] = (throughput[1] - 0.2).max(0.0);
            let record = VertexRecord {
                position_footprint: [1.0, 2.0, 3.0, 0.01],
                direct,
                throughput,
                emitted,
                normal: octahedral_encode(Vec3::Y),
                flags: u32::from(valid) * VertexRecord::VALID,
                ..VertexRecord::zeroed()
            };
            let further = Vec3::new(further[0], further[1], further[2]);
            (record, Estimate { direct: Vec3::ZERO, further, samples, variance: 0.0 })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Dividing by throughput and multiplying again gives the mean of the samples' own radiance.
    #[test]
    fn unfiltered_pixels_are_means(samples in prop::collection::vec(sample(), 1..20), e in -40_i32..=40) {
        let unit = 2.0_f32.powi(e);
        let samples: Vec<_> = samples
            .into_iter()
            .map(|(mut record, mut estimate)| {
                for light in [&mut record.direct, &mut record.emitted] {
                    *light = light.map(|v| v * unit);
                }
                estimate.further *= unit;
                (record, estimate)
            })
            .collect();
        let mean = samples.iter().map(|(record, estimate)| {
            let own = wide(record.throughput) * (wide(record.direct) + estimate.further.as_dvec3());
            wide(record.emitted) + if record.is_valid() { own } else { DVec3::ZERO }
        });
        let mean = mean.sum::<DVec3>() / samples.len() as f64;
        let pixel = sum(Direct::Record, &samples);
        let found = radiance(&pixel);
        // A channel that reflects nothing in some samples weighs 2⁻²⁰ there instead.
        let bound = f64::from(unit) * 4e-6;
        prop_assert!((found - mean).abs().max_element() < bound, "{found} for {mean}");
        prop_assert_eq!(pixel.counts[3], 0);
    }

    #[test]
    fn variances_are_those_of_means(lights in prop::collection::vec(0.0_f32..4.0, 4..40)) {
        let samples: Vec<_> = lights.iter().map(|&light| {
            let record = VertexRecord {
                position_footprint: [0.0, 0.0, 0.0, 0.01],
                direct: [2.0 * light; 4],
                throughput: [0.5; 4],
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            };
            (record, Estimate { direct: Vec3::ZERO, further: Vec3::splat(light), samples: 3, variance: 0.0 })
        }).collect();
        let n = lights.len() as f64;
        let mean = lights.iter().copied().map(f64::from).sum::<f64>() / n;
        let squares = lights.iter().map(|&light| (f64::from(light) - mean).powi(2)).sum::<f64>();
        let variance = squares / (n - 1.0) / n;
        let pixel = sum(Direct::Record, &samples);
        let (direct, further) = (f64::from(pixel.direct_light()[3]), f64::from(pixel.further_light()[3]));
        // Σ l² and (Σ l)² cancel: 16·n·2⁻²⁴ of rounding over n.
        prop_assert!((further - variance).abs() < 1e-5 && (direct - 4.0 * variance).abs() < 4e-5, "{further}, {variance}");
        prop_assert_eq!(sum(Direct::Record, &samples[..3]).direct_light()[3], f32::INFINITY);
    }

    /// Any bits: sums and everything made from them stay finite, and what was left out is counted.
    #[test]
    fn hostile_samples_are_left_out(
        bits in prop::collection::vec((prop::array::uniform24(any_float()), prop::array::uniform7(any_float())), 1..6),
        flags in 0_u32..8, samples in 0_u32..3,
    ) {
        for direct in [Direct::Record, Direct::Estimate] {
            let mut pixel = LayerPixel::zeroed();
            let mut broken = 0;
            for (record, [a, b, c, d, e, f, variance]) in &bits {
                let mut record: VertexRecord = bytemuck::cast(*record);
                record.flags = flags;
                let [first, second] = [Vec3::new(*a, *b, *c), Vec3::new(*d, *e, *f)];
                let estimate = Estimate { direct: first, further: second, samples, variance: *variance };
                broken += u32::from(!pixel.add(&params(direct), &record, &estimate));
            }
            prop_assert!(pixel.left_out() >= broken && (broken == 0) == (pixel.left_out() == 0));
            let floats: [[f32; 4]; 8] = bytemuck::cast(pixel);
            prop_assert!(floats[..7].as_flattened().iter().all(|v| v.is_finite()), "{pixel:?}");
            let guide = PreparedGuide::of_pixel(&GuideScale::new(1.0).unwrap(), &pixel);
            prop_assert!(guide.normal_path.iter().chain(&guide.position_segment).all(|v| v.is_finite()));
            prop_assert!(guide.lab_shininess.iter().all(|v| v.is_finite()));
            for light in [pixel.direct_light(), pixel.further_light()] {
                prop_assert!(light[..3].iter().all(|v| *v >= 0.0 && v.is_finite()), "{light:?} {pixel:?}");
                prop_assert!(!light[3].is_nan());
            }
            prop_assert!(pixel.mean_throughput().is_finite() && pixel.mean_emitted().is_finite());
        }
    }
}

#[test]
fn holes_add_guides_and_direct_light() {
    let hole = VertexRecord {
        position_footprint: [0.0, 4.0, 0.0, 0.02],
        direct: [0.25; 4],
        throughput: [0.5; 4],
        normal: octahedral_encode(Vec3::Y),
        flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY,
        ..VertexRecord::zeroed()
    };
    let none = Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0, variance: 0.0 };
    let pixel = sum(Direct::Record, &[(hole, none), (hole, none)]);
    assert!(is_hole(&pixel.further_light()) && pixel.counts == [2, 2, 2, 0]);
    assert_eq!(pixel.direct_light()[..3], [0.25; 3]);
    let guide = PreparedGuide::of_pixel(&GuideScale::new(2.0).unwrap(), &pixel);
    // 0.02 m of footprint are 10 m of path, 5 radii.
    assert!((guide.normal_path[3] - 5.0).abs() < 1e-6 && guide.normal_path[..3] == [0.0, 1.0, 0.0]);
    assert_eq!(guide.position_segment[1], 2.0);

    // An answer among them counts alone, not diluted by the holes.
    let answer = Estimate { further: Vec3::splat(0.8), samples: 7, ..none };
    let pixel = sum(Direct::Record, &[(hole, none), (hole, answer), (hole, none)]);
    assert_eq!(pixel.further_light()[..3], [0.8; 3]);
    assert_eq!(pixel.emitted[3], 7.0);

    // The path's own light is an answer, even where the cache had none.
    let own = VertexRecord { flags: VertexRecord::VALID, ..hole };
    let pixel = sum(Direct::Estimate, &[(own, Estimate { further: Vec3::splat(0.5), ..none })]);
    assert_eq!((pixel.counts, pixel.further_light()[0]), ([1, 1, 0, 0], 0.5));
}

/// Variances that a cache tells are averaged, and stay above 0 and known whatever comes.
#[test]
fn variances_that_are_told_are_believed() {
    let vertex = VertexRecord {
        position_footprint: [0.0, 0.0, 0.0, 0.01],
        throughput: [0.5; 4],
        normal: octahedral_encode(Vec3::Y),
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    };
    let of = |light: f32, variance: f32| {
        (vertex, Estimate { direct: Vec3::ZERO, further: Vec3::splat(light), samples: 9, variance })
    };
    let pixel = sum(Direct::Estimate, &[of(1.0, 0.25), of(3.0, 0.75)]);
    assert_eq!((pixel.further_light()[3], pixel.left_out()), (0.5, 0));
    assert_eq!(pixel.counts[3], LayerPixel::TOLD);
    // One that does not tell stands for its own square.
    let pixel = sum(Direct::Estimate, &[of(2.0, 0.0), of(2.0, 0.5)]);
    assert!((pixel.further_light()[3] - 2.25).abs() < 1e-5);
    // None that tells: what they differ by.
    let pixel = sum(Direct::Estimate, &[of(1.0, 0.0), of(3.0, 0.0), of(1.0, 0.0), of(3.0, f32::NAN)]);
    assert!((pixel.further_light()[3] - 1.0 / 3.0).abs() < 1e-5 && pixel.counts[3] == 0);
    let pixel = sum(Direct::Estimate, &[of(1.0, f32::MAX), of(1.0, f32::MAX), of(f32::NAN, 1.0)]);
    assert!(pixel.further_light()[3].is_finite() && pixel.left_out() == 1);
}

#[test]
fn black_pixels_stay_black_and_tell_their_light() {
    let black = VertexRecord {
        position_footprint: [0.0, 0.0, 0.0, 0.01],
        direct: [2.0; 4],
        throughput: [0.0; 4],
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    };
    let estimate = Estimate { direct: Vec3::ZERO, further: Vec3::ONE, samples: 1, variance: 0.0 };
    let pixel = sum(Direct::Record, &[(black, estimate); 3]);
    assert_eq!(pixel.mean_throughput(), Vec3::ZERO);
    assert_eq!((pixel.direct_light()[0], pixel.further_light()[0]), (2.0, 1.0));
}

#[test]
fn an_empty_pixel_is_black() {
    let pixel = LayerPixel::zeroed();
    assert_eq!(radiance(&pixel), DVec3::ZERO);
    assert!(!is_hole(&pixel.further_light()), "nothing to fill where nothing was met");
    assert_eq!(PreparedGuide::of_pixel(&GuideScale::new(1.0).unwrap(), &pixel), PreparedGuide::NONE);
}
