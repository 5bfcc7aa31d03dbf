//! CPU time of the filter's steps on a picture of 512×288 pixels, beside plain means of as many pixels.
//!
//! One element is a pixel of one image (a layer): criterion's time divided by its throughput is what a pixel and layer
//! cost. Times are CPU time of the process, so that a busy machine does not blur them.

use std::hint::black_box;
use std::time::Duration;

use bytemuck::Zeroable;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg3d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;
use layered_filter::fill::fill;
use layered_filter::{
    ATrous, CrossBilateral, Denoiser, Direct, GatherParams, GuideScale, LayerPixel, Light, LuminanceWeight,
    PreparedGuide, Taps, View, WeightSettings, Weights, filter_pixels,
};

const WIDTH: u32 = 512;
const HEIGHT: u32 = 288;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

/// CPU time that the process has used.
#[cfg(target_os = "linux")]
fn cpu_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Elapsed time.
#[cfg(not(target_os = "linux"))]
fn cpu_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// A tiled floor, two walls and a few boxes in front of them, lit from the left, with noise.
fn sample(x: u32, y: u32, sample: u32) -> (VertexRecord, Estimate) {
    let [a, b, c] = pcg3d([x, y, sample]).map(to_unit_f32);
    let (u, v) = (x as f32 / WIDTH as f32, y as f32 / HEIGHT as f32);
    let boxed = (x / 40) % 3 == 1 && (y / 48) % 2 == 1;
    let (normal, depth) = match (boxed, y > 200, x < 170) {
        (true, _, _) => (Vec3::new(0.2, 0.1, 1.0), 4.0),
        (_, true, _) => (Vec3::Y, 8.0 - 4.0 * v),
        (_, _, true) => (Vec3::X, 4.0 + 4.0 * u),
        _ => (Vec3::Z, 8.0),
    };
    let tile = if (x / 16 + y / 16).is_multiple_of(2) { 0.7 } else { 0.3 };
    let light = (1.2 - u) * (0.4 + a);
    let record = VertexRecord {
        position_footprint: [(u - 0.5) * depth, (0.5 - v) * depth, -depth, depth * 0.002],
        direct: [light * b * 2.0; 4],
        throughput: [tile, 0.5, 0.4 + 0.2 * u, 0.0],
        normal: octahedral_encode(normal),
        flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY,
        ..VertexRecord::zeroed()
    };
    let samples = if c > 0.02 { (c * 100.0) as u32 } else { 0 };
    (
        record,
        Estimate {
            direct: Vec3::ZERO,
            further: Vec3::new(light, light * 0.8, 0.5),
            samples,
            variance: 0.04 * light * light,
        },
    )
}

struct Case {
    pixels: Vec<LayerPixel>,
    guides: Vec<PreparedGuide>,
    image: Vec<Light>,
}

impl Case {
    fn new() -> Self {
        let params = GatherParams::new(0.002, Direct::Record, 1, 1).expect("parameters of a bench");
        let scale = GuideScale::new(10.0).expect("a radius");
        let mut pixels = vec![LayerPixel::zeroed(); PIXELS];
        for (i, pixel) in pixels.iter_mut().enumerate() {
            for s in 0..4 {
                let (record, estimate) = sample(i as u32 % WIDTH, i as u32 / WIDTH, s);
                pixel.add(&params, &record, &estimate);
            }
        }
        let guides: Vec<_> = pixels.iter().map(|pixel| PreparedGuide::of_pixel(&scale, pixel)).collect();
        let image = pixels.iter().map(LayerPixel::further_light).collect();
        Self { pixels, guides, image }
    }

    fn view(&self) -> View<'_> {
        View::new(WIDTH, HEIGHT, &self.guides).expect("as many guides as pixels")
    }
}

fn measure(c: &mut Criterion, group: &str, name: &str, mut work: impl FnMut()) {
    let mut group = c.benchmark_group(format!("layered_filter/{group}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
    group.throughput(Throughput::Elements(PIXELS as u64));
    group.bench_function(BenchmarkId::new(name, "512x288"), |b| {
        b.iter_custom(|runs| {
            let start = cpu_time();
            for _ in 0..runs {
                work();
            }
            cpu_time().saturating_sub(start)
        });
    });
    group.finish();
}

/// All passes; what a picture's layer costs.
fn passes<D: Denoiser>(c: &mut Criterion, case: &Case, name: &str, denoiser: &D) {
    let mut out = [case.image.clone(), case.image.clone()];
    measure(c, "filter", name, || {
        let view = case.view();
        for pass in 0..denoiser.passes() {
            let [from, to] = &mut out;
            let input = if pass == 0 { &case.image } else { &*from };
            filter_pixels(denoiser, pass, &view, input, 0, to);
            out.swap(0, 1);
        }
        black_box(&out);
    });
}

/// The plain mean of the pixels that the bilateral filter would read, guides included: the price of memory.
struct Plain(CrossBilateral);

impl Denoiser for Plain {
    fn passes(&self) -> u32 {
        1
    }

    fn pixel(&self, pass: u32, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Light {
        let (mut sum, mut count) = ([0.0; 4], 0.0);
        for (dx, dy) in self.0.taps(pass, x, y, 16.0) {
            let Some(q) = view.neighbour(x, y, dx, dy) else { continue };
            let guide = &view.guides()[q];
            count += f32::from(guide.has_vertex());
            for (sum, v) in sum.iter_mut().zip(input[q]) {
                *sum += v;
            }
        }
        sum.map(|v| v / count)
    }
}

fn filters(c: &mut Criterion) {
    let case = Case::new();
    let (paper, surface) = (WeightSettings::PAPER, WeightSettings::surface(0.002));
    let deviation = WeightSettings {
        normal_squarings: 5,
        path_scale: 0.0,
        segment_scale: 0.0,
        plane_scale: 50.0,
        luminance: LuminanceWeight::Deviation { scale: 4.0 },
        ..paper
    };
    let bilateral = |weights, radius| CrossBilateral::new(weights, radius, 1, 7).expect("settings of a bench");
    let atrous = |weights, taps, passes| ATrous::new(weights, taps, passes).expect("settings of a bench");
    passes(c, &case, "baseline_24_taps", &Plain(bilateral(&paper, 16.0)));
    passes(c, &case, "bilateral", &bilateral(&paper, 16.0));
    passes(c, &case, "bilateral_surface", &bilateral(&surface, 8.0));
    let by_samples = bilateral(&surface, 8.0).with_radius_by_samples(400.0).expect("settings of a bench");
    passes(c, &case, "bilateral_surface_by_samples", &by_samples);
    // What a picture's layer has by default: a wide pass and a narrow one, of half as many taps each.
    let wide = bilateral(&surface, 8.0)
        .with_radius_by_samples(400.0)
        .and_then(|filter| filter.with_wide_pass(&surface, 24.0, 5000.0, 2.0));
    passes(c, &case, "bilateral_wide_and_narrow", &wide.expect("settings of a bench"));
    passes(c, &case, "bilateral_deviation", &bilateral(&deviation, 16.0));
    passes(c, &case, "atrous_9x4_deviation", &atrous(&deviation, Taps::Nine, 4));
    passes(c, &case, "atrous_25x3_deviation", &atrous(&deviation, Taps::TwentyFive, 3));
    passes(c, &case, "atrous_25x4_paper", &atrous(&paper, Taps::TwentyFive, 4));
}

fn steps(c: &mut Criterion) {
    let case = Case::new();
    let params = GatherParams::new(0.002, Direct::Record, 1, 1).expect("parameters of a bench");
    let scale = GuideScale::new(10.0).expect("a radius");
    let samples: Vec<_> = (0..PIXELS as u32).map(|i| sample(i % WIDTH, i / WIDTH, 9)).collect();
    let mut pixels = case.pixels.clone();
    measure(c, "steps", "gather", || {
        for (pixel, (record, estimate)) in pixels.iter_mut().zip(&samples) {
            pixel.add(&params, record, estimate);
        }
    });
    let mut guides = case.guides.clone();
    let mut images = [case.image.clone(), case.image.clone()];
    measure(c, "steps", "prepare", || {
        for (i, pixel) in case.pixels.iter().enumerate() {
            guides[i] = PreparedGuide::of_pixel(&scale, pixel);
            images[0][i] = pixel.direct_light();
            images[1][i] = pixel.further_light();
        }
        black_box(&images);
    });
    let deviation = WeightSettings { luminance: LuminanceWeight::Deviation { scale: 4.0 }, ..WeightSettings::PAPER };
    let weights = Weights::new(&deviation).expect("settings of a bench");
    let unknown: Vec<Light> = case.image.iter().map(|&[r, g, b, _]| [r, g, b, f32::INFINITY]).collect();
    let surface = Weights::new(&WeightSettings::surface(0.002)).expect("settings of a bench");
    for (name, weights, input) in [("fill", &surface, &case.image), ("fill_variance", &weights, &unknown)] {
        measure(c, "steps", name, || {
            let view = case.view();
            for (y, row) in (0..).zip(images[0].chunks_exact_mut(WIDTH as usize)) {
                for (x, out) in (0..).zip(row) {
                    *out = fill(weights, &view, input, x, y).0;
                }
            }
            black_box(&images);
        });
    }
}

criterion_group!(benches, filters, steps);
criterion_main!(benches);
