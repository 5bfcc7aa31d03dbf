//! What a pixel knows of its own error, against means of many and at the ends of f32.
#![allow(clippy::disallowed_methods, clippy::float_cmp, reason = "expectations come from exact values")]

use backend_api::{Backend, BufferDesc};
use backend_cpu::CpuBackend;
use bytemuck::Zeroable;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg3d, to_unit_f32};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use hashcache_core::traits::Estimate;
use layered_filter::{Composition, Direct, Filter, FilterSettings, FilterStages, GatherParams, LayerPixel, NoisePixel};

fn vertex(throughput: Vec3, direct: Vec3) -> VertexRecord {
    VertexRecord {
        throughput: throughput.extend(0.0).to_array(),
        direct: direct.extend(0.0).to_array(),
        flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY,
        ..VertexRecord::zeroed()
    }
}

fn answer(light: Vec3, samples: u32, variance: f32) -> Estimate {
    Estimate { direct: Vec3::ZERO, further: light, samples, variance }
}

fn noise(sums: &[LayerPixel], direct: Direct) -> NoisePixel {
    sums.iter().fold(NoisePixel::default(), |mut pixel, sums| {
        pixel.add(sums, direct);
        pixel
    })
}

/// Pixels of a few independent samples: their means scatter by what each of them says on average.
#[test]
fn the_error_is_that_of_means() {
    const PIXELS: u32 = 20_000;
    for (direct, samples) in [(Direct::Record, 4), (Direct::Record, 9), (Direct::Estimate, 5)] {
        let params = GatherParams::new(0.001, direct, 1, 1).unwrap();
        let (mut sum, mut squares, mut told) = (0.0, 0.0, 0.0);
        for i in 0..PIXELS {
            let mut sums = LayerPixel::zeroed();
            for k in 0..samples {
                let [a, b, _] = pcg3d([i, k, 1]).map(to_unit_f32);
                let record = vertex(Vec3::splat(0.5), Vec3::splat(a * a * a));
                sums.add(&params, &record, &answer(Vec3::splat(3.0 * b), 1, 0.0));
            }
            let pixel = noise(&[sums], direct);
            sum += f64::from(pixel.radiance);
            squares += f64::from(pixel.radiance).powi(2);
            told += f64::from(pixel.variance);
        }
        let n = f64::from(PIXELS);
        let variance = squares / n - (sum / n).powi(2);
        // A variance by 20,000 pixels is known to 1 %; the told ones have as much noise of their own.
        assert!((told / n / variance - 1.0).abs() < 0.05, "{direct:?}, {samples}: {} for {variance}", told / n);
    }
}

#[test]
fn what_a_cache_tells_is_carried_by_its_share_of_each_layer() {
    let params = GatherParams::new(0.001, Direct::Estimate, 1, 1).unwrap();
    let layer = |throughput, light, variance| {
        let mut sums = LayerPixel::zeroed();
        sums.add(&params, &vertex(throughput, Vec3::ZERO), &answer(light, 50, variance));
        sums
    };
    let (white, red) = (Vec3::ONE, Vec3::X);
    let front = layer(white * 0.25, white * 4.0, 0.16);
    let back = layer(red, Vec3::new(2.0, 0.0, 0.0), 0.01);
    let pixel = noise(&[front, back], Direct::Estimate);
    // 0.25²·0.16, and red light behind a red surface: all of it.
    assert!((pixel.variance - (0.01 + 0.01)).abs() < 1e-6, "{pixel:?}");
    assert!((pixel.radiance - (1.0 + 2.0 * 0.2126)).abs() < 1e-6);
    assert!((pixel.standard_error() - pixel.variance.sqrt()).abs() < 1e-6);
    // Red light behind a blue surface: nothing, and no error.
    let swallowed = noise(&[layer(Vec3::Z, red, 0.01)], Direct::Estimate);
    assert!(swallowed.variance < 1e-9 && swallowed.radiance < 1e-5, "{swallowed:?}");
}

#[test]
fn what_is_not_known_is_infinite_and_nothing_is_nan() {
    let estimate = GatherParams::new(0.001, Direct::Estimate, 1, 1).unwrap();
    let with = |records: &[(VertexRecord, Estimate)]| {
        let mut sums = LayerPixel::zeroed();
        for (record, answer) in records {
            sums.add(&estimate, record, answer);
        }
        noise(&[sums], Direct::Estimate)
    };
    let grey = vertex(Vec3::splat(0.5), Vec3::ZERO);
    let sky = VertexRecord { emitted: [3.0; 4], ..VertexRecord::zeroed() };
    assert_eq!(noise(&[LayerPixel::zeroed()], Direct::Record), NoisePixel::default(), "no sample");
    let of_sky = with(&[(sky, answer(Vec3::ZERO, 0, 0.0))]);
    assert!((of_sky.radiance - 3.0).abs() < 1e-5 && of_sky.variance == 0.0, "{of_sky:?}");
    assert_eq!(with(&[(grey, answer(Vec3::ONE, 1, 0.0))]).variance, f32::INFINITY, "one sample");
    assert_eq!(with(&[(grey, answer(Vec3::ONE, 0, 0.0))]).variance, f32::INFINITY, "a hole");
    assert_eq!(with(&[(grey, answer(Vec3::splat(f32::NAN), 1, 0.0))]).variance, f32::INFINITY, "no light");
    let black = vertex(Vec3::ZERO, Vec3::ZERO);
    assert_eq!(with(&[(black, answer(Vec3::ONE, 1, 0.0))]), NoisePixel::default(), "a black surface");
    for scale in [1e-12, 1e12, 1e19, f32::MAX] {
        for variance in [0.0, 1e-30, 1.0, f32::MAX, f32::INFINITY, f32::NAN, -1.0] {
            for samples in [1, 2, 4, 30] {
                let all: Vec<_> = (0..samples).map(|_| (grey, answer(Vec3::splat(scale), 3, variance))).collect();
                let pixel = with(&all);
                assert!(pixel.variance >= 0.0 && pixel.radiance >= 0.0 && pixel.radiance.is_finite(), "{pixel:?}");
                assert!(!pixel.standard_error().is_nan());
            }
        }
    }
}

/// The kernel over all layers, in any number of threads, is the plain function.
#[test]
fn the_stage_is_the_plain_function() {
    const SIZE: [u32; 2] = [37, 29];
    const LAYERS: u32 = 3;
    let settings = FilterSettings {
        width: SIZE[0],
        height: SIZE[1],
        direct: Direct::Record,
        radius: 1.0,
        pixel_angle: 0.001,
        further: Filter::None,
        direct_filter: Filter::None,
        carried: Filter::None,
        layers: LAYERS,
        composition: Composition::Layered,
    };
    let pixels = SIZE[0] * SIZE[1];
    let (mut records, mut estimates) = (Vec::new(), Vec::new());
    for i in 0..pixels * LAYERS {
        let r = pcg3d([i, 5, 6]).map(to_unit_f32);
        records.push(vertex(Vec3::from_array(r), Vec3::splat(r[1])));
        estimates.push(EstimateRecord { direct: [0.0, 0.0, 0.0, 7.0], further: [r[2], r[0], r[1], 0.1 * r[2]] });
    }
    let params = GatherParams::new(0.001, Direct::Record, 1, 1).unwrap();
    let expected: Vec<NoisePixel> = (0..pixels as usize)
        .map(|i| {
            let sums: Vec<_> = (0..LAYERS as usize)
                .map(|layer| {
                    let k = i * LAYERS as usize + layer;
                    let [r, g, b, variance] = estimates[k].further;
                    let mut sums = LayerPixel::zeroed();
                    for _ in 0..4 {
                        sums.add(&params, &records[k], &answer(Vec3::new(r, g, b), 7, variance));
                    }
                    sums
                })
                .collect();
            noise(&sums, Direct::Record)
        })
        .collect();
    assert!(expected.iter().any(|pixel| pixel.variance > 0.0 && pixel.variance.is_finite()));
    for mut backend in [CpuBackend::serial(), CpuBackend::rayon(3).unwrap()] {
        let mut stages = FilterStages::new(&settings).unwrap();
        stages.prepare(&mut backend).unwrap();
        let mut upload = |bytes: &[u8]| {
            let size = bytes.len() as u64;
            let buffer = backend.create(&BufferDesc { name: "test", size }).unwrap();
            backend.write(buffer, 0, bytes).unwrap();
            backend_api::Binding { buffer, offset: 0, size }
        };
        let (records, estimates) = (upload(bytemuck::cast_slice(&records)), upload(bytemuck::cast_slice(&estimates)));
        let noise = upload(bytemuck::cast_slice(&vec![NoisePixel::default(); pixels as usize]));
        for _ in 0..4 {
            stages.gather(&mut backend, records, LAYERS, estimates, LAYERS, 0, pixels).unwrap();
        }
        stages.noise(&mut backend, noise.buffer).unwrap();
        backend.submit().unwrap();
        let ticket = backend.read(noise.buffer, 0, noise.size).unwrap();
        let bytes = backend.redeem(ticket, true).unwrap().unwrap();
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, NoisePixel>(&bytes), expected);
    }
}
