//! Holes and unknown variances.

use layered_filter::fill::{Filled, fill};
use layered_filter::{GuideRecord, HOLE, Light, LuminanceWeight, PreparedGuide, View, WeightSettings, Weights};

use super::{prepared, unit};

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

/// Two surfaces: floor on the left, wall on the right.
fn room() -> Vec<PreparedGuide> {
    let records: Vec<_> = (0..WIDTH * HEIGHT)
        .map(|i| GuideRecord {
            position_path: [0.0, 0.0, 0.0, 1.0],
            normal_segment: if i % WIDTH < 20 { [0.0, 1.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0, 1.0] },
            albedo_shininess: [0.5, 0.5, 0.5, 0.0],
            ..GuideRecord::NONE
        })
        .collect();
    prepared(&records)
}

fn weights(luminance: LuminanceWeight) -> Weights {
    Weights::new(&WeightSettings { luminance, ..WeightSettings::surface(0.002) }).unwrap()
}

/// Light 1 on the floor, 3 on the wall.
fn lit(i: u32) -> Light {
    let light = if i % WIDTH < 20 { 1.0 } else { 3.0 };
    [light, light, light, 0.01]
}

#[test]
fn holes_take_the_light_of_their_own_surface() {
    let guides = room();
    let view = View::new(WIDTH, HEIGHT, &guides).unwrap();
    let weights = weights(LuminanceWeight::Off);
    // A disc of holes across the edge.
    let hole = |i: u32| (i % WIDTH).abs_diff(20).pow(2) + (i / WIDTH).abs_diff(15).pow(2) < 50;
    let image: Vec<Light> =
        (0..WIDTH * HEIGHT).map(|i| if hole(i) { [f32::NAN, 0.0, 9.0, HOLE] } else { lit(i) }).collect();
    for i in 0..WIDTH * HEIGHT {
        let (light, filled) = fill(&weights, &view, &image, i % WIDTH, i / WIDTH);
        assert_eq!(filled, if hole(i) { Filled::Filled } else { Filled::Kept });
        assert_eq!(light[..3], lit(i)[..3], "{i}");
        assert!(light[3] > 0.0 && light[3] <= 0.01);
    }
}

#[test]
fn a_hole_without_like_neighbours_stays_one() {
    let mut guides = room();
    guides[600] = prepared(&[GuideRecord {
        position_path: [0.0, 0.0, 0.0, 1.0],
        normal_segment: [0.0, 0.0, 1.0, 1.0],
        albedo_shininess: [0.5, 0.5, 0.5, 0.0],
        ..GuideRecord::NONE
    }])[0];
    let view = View::new(WIDTH, HEIGHT, &guides).unwrap();
    let mut image: Vec<Light> = (0..WIDTH * HEIGHT).map(lit).collect();
    image[600] = [0.0, 0.0, 0.0, HOLE];
    let (light, filled) = fill(&weights(LuminanceWeight::Off), &view, &image, 0, 15);
    assert_eq!((light, filled), (image[600], Filled::Empty));

    let all = vec![[0.0, 0.0, 0.0, HOLE]; image.len()];
    assert_eq!(fill(&weights(LuminanceWeight::Off), &view, &all, 3, 3).1, Filled::Empty);
}

#[test]
fn unknown_variances_are_those_of_the_surroundings() {
    let guides = room();
    let view = View::new(WIDTH, HEIGHT, &guides).unwrap();
    let image: Vec<Light> = (0..WIDTH * HEIGHT)
        .map(|i| {
            let light = lit(i)[0] + unit([i, 9, 9, 9])[0] - 0.5;
            [light, light, light, f32::INFINITY]
        })
        .collect();
    let weights = weights(LuminanceWeight::Deviation { scale: 4.0 });
    let mut sum = 0.0;
    for i in 0..WIDTH * HEIGHT {
        let (light, _) = fill(&weights, &view, &image, i % WIDTH, i / WIDTH);
        assert!(light[3].is_finite() && light[..3] == image[i as usize][..3]);
        sum += light[3];
    }
    // Uniform noise of width 1 has a variance of 1/12; 1200 estimates of 25 pixels each know it to a few per cent.
    let mean = sum / (WIDTH * HEIGHT) as f32;
    assert!((mean - 1.0 / 12.0).abs() < 0.005, "{mean}");
    // Nothing to learn from one pixel.
    let one = View::new(1, 1, &guides[..1]).unwrap();
    assert_eq!(fill(&weights, &one, &image[..1], 0, 0).0[3], f32::INFINITY);
}
