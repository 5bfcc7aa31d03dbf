//! Composition layer by layer against a model that follows every path by itself.

use hashcache_core::glam::DVec3;
use layered_filter::{
    CrossBilateral, Denoiser, GuideRecord, HOLE, Layer, Light, LuminanceWeight, PreparedGuide, Scratch, View,
    WeightSettings, Weights, compose_layers, compose_screen,
};
use proptest::prelude::*;

use super::{guides, prepared, unit};

/// Leaves an image alone.
struct Nothing;

impl Denoiser for Nothing {
    fn passes(&self) -> u32 {
        1
    }

    fn pixel(&self, _: u32, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Light {
        input[(y * view.width() + x) as usize]
    }
}

struct Layers {
    records: Vec<Vec<GuideRecord>>,
    guides: Vec<Vec<PreparedGuide>>,
    lights: Vec<Vec<Light>>,
}

impl Layers {
    fn new(count: u32, pixels: u32, seed: u32) -> Self {
        let records: Vec<_> = (0..count).map(|layer| guides(seed.wrapping_add(layer), pixels)).collect();
        let light = |layer: u32, i: u32| {
            let [r, g, b, _] = unit([i, layer, seed, 4]);
            [r, g, b, 0.1]
        };
        let lights = (0..count).map(|layer| (0..pixels).map(|i| light(layer, i)).collect()).collect();
        Self { guides: records.iter().map(|records| prepared(records)).collect(), records, lights }
    }

    fn views(&self) -> Vec<Layer<'_>> {
        let parts = self.records.iter().zip(&self.guides).zip(&self.lights);
        parts.map(|((records, guides), illumination)| Layer { records, guides, illumination }).collect()
    }
}

fn weights() -> Weights {
    Weights::new(&WeightSettings::PAPER).unwrap()
}

fn compose(denoiser: &dyn Denoiser, size: [u32; 2], layers: &[Layer<'_>], screen: bool) -> (Vec<Light>, u32) {
    let image = vec![[9.0; 4]; (size[0] * size[1]) as usize];
    let (mut filtered, mut carried, mut pass, mut radiance) = (image.clone(), image.clone(), image.clone(), image);
    let mut scratch = Scratch { filtered: &mut filtered, carried: &mut carried, pass: &mut pass };
    let run = if screen { compose_screen } else { compose_layers };
    let empty = run(denoiser, &weights(), size, layers, &mut scratch, &mut radiance);
    (radiance, empty)
}

fn rgb(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Without a filter, a pixel's radiance is Σ over layers of E·C and all C·T in front, of this pixel alone. A path ends
    /// for the layers in front where it has no vertex.
    #[test]
    fn unfiltered_layers_are_paths(count in 1_u32..5, width in 1_u32..9, height in 1_u32..9, seed in any::<u32>()) {
        let layers = Layers::new(count, width * height, seed);
        for screen in [false, true] {
            let (radiance, empty) = compose(&Nothing, [width, height], &layers.views(), screen);
            prop_assert_eq!(empty, 0);
            for (i, found) in radiance.iter().enumerate() {
                let mut model = DVec3::ZERO;
                let mut way = DVec3::ONE;
                for (records, lights) in layers.records.iter().zip(&layers.lights) {
                    if records[i].albedo_shininess[3] < 0.0 {
                        break;
                    }
                    let albedo = rgb(records[i].albedo_shininess);
                    model += way * albedo * rgb(lights[i]);
                    way *= albedo * rgb(records[i].throughput);
                }
                prop_assert!((rgb(*found) - model).abs().max_element() < 1e-5, "{found:?} for {model}");
            }
        }
    }

    /// With a filter, layer by layer by hand.
    #[test]
    fn filtered_layers_follow_the_recursion(width in 1_u32..12, height in 1_u32..12, seed in any::<u32>()) {
        let denoiser = CrossBilateral::new(&WeightSettings::surface(0.002), 3.0, 1, 0).unwrap();
        let layers = Layers::new(2, width * height, seed);
        let filtered = |layer: usize, image: &[Light]| {
            let view = View::new(width, height, &layers.guides[layer]).unwrap();
            super::run(&denoiser, &view, image, image.len())
        };
        let back = filtered(1, &layers.lights[1]);
        let front: Vec<Light> = (0..back.len()).map(|i| {
            let ends = layers.records[1][i].albedo_shininess[3] < 0.0;
            let carried = rgb(back[i]) * rgb(layers.records[1][i].albedo_shininess) * rgb(layers.records[0][i].throughput);
            let light = rgb(layers.lights[0][i]) + if ends { DVec3::ZERO } else { carried };
            light.as_vec3().extend(0.1).to_array()
        }).collect();
        let front = filtered(0, &front);
        let (radiance, _) = compose(&denoiser, [width, height], &layers.views(), false);
        for (i, found) in radiance.iter().enumerate() {
            let has_vertex = layers.records[0][i].albedo_shininess[3] >= 0.0;
            let expected = if has_vertex { rgb(front[i]) * rgb(layers.records[0][i].albedo_shininess) } else { DVec3::ZERO };
            prop_assert!((rgb(*found) - expected).abs().max_element() < 1e-5, "{found:?} for {expected}");
        }
    }

    /// A single layer has nothing behind it: both ways are the same.
    #[test]
    fn one_layer_is_the_screen(width in 1_u32..12, height in 1_u32..12, seed in any::<u32>()) {
        let denoiser = CrossBilateral::new(&WeightSettings::PAPER, 3.0, 1, 0).unwrap();
        let layers = Layers::new(1, width * height, seed);
        let by = |screen| compose(&denoiser, [width, height], &layers.views(), screen);
        prop_assert!(by(false) == by(true));
    }
}

/// A noisy wall seen in a mirror that shows two halves: only layered filtering knows where the halves meet.
#[test]
fn layers_keep_what_a_mirror_shows() {
    let (width, height) = (32, 16);
    let mirror = GuideRecord {
        position_path: [0.0, 0.0, 0.0, 1.0],
        normal_segment: [0.0, 0.0, 1.0, 1.0],
        albedo_shininess: [1.0, 1.0, 1.0, 1000.0],
        throughput: [1.0; 4],
    };
    let wall = |i: u32| GuideRecord {
        position_path: [0.0, 0.0, 0.0, 3.0],
        normal_segment: if i % width < 16 { [0.0, 1.0, 0.0, 2.0] } else { [1.0, 0.0, 0.0, 2.0] },
        albedo_shininess: [0.5, 0.5, 0.5, 0.0],
        throughput: [0.0; 4],
    };
    let truth = |i: u32| if i % width < 16 { 1.0 } else { 3.0 };
    let pixels = width * height;
    let records = vec![vec![mirror; pixels as usize], (0..pixels).map(wall).collect()];
    let noisy = |i: u32| truth(i) + unit([i, 1, 1, 1])[0] - 0.5;
    let mut layers = Layers {
        guides: records.iter().map(|records| prepared(records)).collect(),
        records,
        lights: vec![
            vec![[0.0, 0.0, 0.0, 0.0]; pixels as usize],
            (0..pixels).map(|i| [noisy(i), noisy(i), noisy(i), 0.1]).collect(),
        ],
    };
    let luminance = LuminanceWeight::Deviation { scale: 2.0 };
    let settings = WeightSettings { luminance, ..WeightSettings::surface(0.002) };
    let denoiser = CrossBilateral::new(&settings, 6.0, 1, 0).unwrap();
    let error = |image: &[Light]| {
        (0..pixels).map(|i| (image[i as usize][0] - 0.5 * truth(i)).powi(2)).sum::<f32>() / pixels as f32
    };
    let layered = error(&compose(&denoiser, [width, height], &layers.views(), false).0);
    let screen = error(&compose(&denoiser, [width, height], &layers.views(), true).0);
    assert!(layered < 0.5 * screen, "{layered} against {screen}");

    // Holes in the wall are filled from its own half, none is left.
    for i in (0..pixels as usize).step_by(5) {
        layers.lights[1][i] = [0.0, 0.0, 0.0, HOLE];
    }
    let (radiance, empty) = compose(&Nothing, [width, height], &layers.views(), false);
    assert_eq!(empty, 0);
    assert!((0..pixels).all(|i| (radiance[i as usize][0] - 0.5 * truth(i)).abs() < 0.26));
}
