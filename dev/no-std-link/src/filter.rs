//! `layered-filter`, on images of the caller's.

use core::hint::black_box;

use bytemuck::Zeroable;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;
use layered_filter::{
    ATrous, CrossBilateral, Direct, GatherParams, GuideRecord, GuideScale, Layer, LayerPixel, Light, PreparedGuide,
    Scratch, Taps, View, WeightSettings, Weights, compose_layers, filter,
};

use crate::checks::Checks;
use crate::grid;

const WIDTH: u32 = 3;
const HEIGHT: u32 = 2;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    checks.that("GatherParams::new: bad", GatherParams::new(black_box(-1.0), Direct::Record, 1, 1).is_err());
    let Ok(params) = GatherParams::new(0.001, Direct::Record, 1, 1) else { return checks.that("GatherParams", false) };
    let Ok(scale) = GuideScale::new(4.0) else { return checks.that("GuideScale", false) };

    let mut pixel = LayerPixel::zeroed();
    let estimate = Estimate { direct: Vec3::ZERO, further: Vec3::splat(0.5), samples: 8, variance: 0.0 };
    let vertices: [VertexRecord; 4] = grid::vertices();
    let fine = vertices.iter().all(|vertex| pixel.add(&params, vertex, &estimate));
    checks.that(
        "LayerPixel::add",
        fine && pixel.counts == [4, 4, 0, 0] && pixel.further_light()[0].to_bits() == 0.5_f32.to_bits(),
    );
    let guides = [PreparedGuide::of_pixel(&scale, &pixel); PIXELS];
    let Some(view) = View::new(WIDTH, HEIGHT, &guides) else { return checks.that("View::new", false) };

    let weights = WeightSettings::surface(0.001);
    let mut image: [Light; PIXELS] = [pixel.direct_light(); PIXELS];
    let before = image;
    let mut scratch = image;
    let bilateral = CrossBilateral::new(&weights, 4.0, 1, 0).and_then(|filter| filter.with_radius_by_samples(400.0));
    if let (Ok(bilateral), Ok(atrous)) = (&bilateral, &ATrous::new(&WeightSettings::PAPER, Taps::Nine, 2)) {
        filter(bilateral, &view, &mut image, &mut scratch);
        filter(atrous, &view, &mut image, &mut scratch);
        layers(checks, atrous, &scale);
    }
    checks.that(
        "filter",
        bilateral.is_ok() && image.map(|light| light[0].to_bits()) == before.map(|light| light[0].to_bits()),
    );
}

fn layers(checks: &mut Checks, denoiser: &ATrous, scale: &GuideScale) {
    let vertex = GuideRecord {
        position_path: [0.0, 0.0, 0.0, 1.0],
        normal_segment: [0.0, 1.0, 0.0, 1.0],
        albedo_shininess: [0.5, 0.5, 0.5, 0.0],
        throughput: [1.0, 1.0, 1.0, 0.0],
    };
    let Ok(weights) = Weights::new(&WeightSettings::PAPER) else { return checks.that("Weights::new", false) };
    let (records, guides) = ([vertex; PIXELS], [PreparedGuide::new(scale, &vertex); PIXELS]);
    let light = [[1.0, 1.0, 1.0, 0.0]; PIXELS];
    let layer = Layer { records: &records, guides: &guides, illumination: &light };
    let (mut filtered, mut carried, mut pass, mut radiance) = (light, light, light, light);
    let mut scratch = Scratch { filtered: &mut filtered, carried: &mut carried, pass: &mut pass };
    let size = [WIDTH, HEIGHT];
    let empty = compose_layers(denoiser, &weights, size, &[layer, layer], &mut scratch, &mut radiance);
    // 0.5 of (1 + 0.5 of 1).
    checks.that("compose_layers", empty == 0 && radiance.iter().all(|light| (light[0] - 0.75).abs() < 1e-6));
}
