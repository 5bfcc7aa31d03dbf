//! Lights without extent against closed forms, and environments that are turned.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions")]

mod common;

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use common::caster::BruteForce;
use common::scenes::{add_triangles, quad};
use hashcache_core::geometry::Instance;
use hashcache_core::traits::Sampler;
use proptest::prelude::*;
use pt_integrator::glam::Vec3;
use pt_integrator::light::sample_light;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts, trace_path};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::{Independent, Sobol};
use pt_integrator::scene::{Environment, EnvironmentImage, Material, Needs, PunctualLight, SceneData};

const ALBEDO: f32 = 0.6;

/// A floor of 20 × 20 units about the origin, `size` metres a unit.
fn floor(size: f32) -> SceneData {
    let mut scene = SceneData::default();
    let floor = quad(Vec3::new(-10.0, 0.0, -10.0), 20.0 * Vec3::Z, 20.0 * Vec3::X);
    add_triangles(&mut scene, &floor, Material::lambert([ALBEDO; 3]));
    scene.instances[0].to_scene = [[size, 0.0, 0.0, 0.0], [0.0, size, 0.0, 0.0], [0.0, 0.0, size, 0.0]];
    scene
}

/// What a camera sees of the floor at (x, 0, z), in units of `size`; the mean and the largest difference from it.
fn seen(scene: &SceneData, size: f32, [x, z]: [f32; 2], samples: u32) -> (f64, f64) {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let ray = ray_towards(Vec3::new(x, 0.5, z) * size, Vec3::NEG_Y);
    let settings = PathSettings { max_bounces: 1, ..PathSettings::default() };
    let mut counts = RayCounts::default();
    let all: Vec<f64> = (0..samples)
        .map(|i| {
            let path = trace_path(&view, &caster, &mut Sobol::new(i, 3), &ray, &settings, &mut counts);
            assert!(path.further == Vec3::ZERO && path.emitted == Vec3::ZERO);
            f64::from(path.radiance().y)
        })
        .collect();
    assert_eq!(counts.non_finite, 0);
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    (mean, all.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max))
}

/// A single light is seen by every path, without noise.
fn assert_exactly(scene: &SceneData, size: f32, at: [f32; 2], expected: f64) {
    let (mean, spread) = seen(scene, size, at, 16);
    let tolerance = 2e-5 * expected;
    assert!(
        (mean - expected).abs() <= tolerance && spread <= tolerance,
        "{mean} ± {spread}, not {expected}: {scene:?}"
    );
}

#[test]
fn floor_below_a_point() {
    for size in [1e-4_f32, 1.0, 1e7] {
        for radiance in [1e-12_f32, 1.0, 1e12] {
            let intensity = radiance * size * size;
            let mut scene = floor(size);
            scene.punctual_lights = vec![PunctualLight::point(Vec3::new(0.5, 2.0, -0.5) * size, [0.0, intensity, 0.0])];
            for [x, z] in [[0.5_f32, -0.5], [1.5, 1.0], [-8.0, 3.0]] {
                let squared = f64::from((x - 0.5).powi(2) + 4.0 + (z + 0.5).powi(2));
                let cosine = 2.0 / squared.sqrt();
                let expected = f64::from(ALBEDO * radiance) / std::f64::consts::PI * cosine / squared;
                assert_exactly(&scene, size, [x, z], expected);
            }
        }
    }
}

#[test]
fn floor_below_a_sun() {
    for size in [1e-4_f32, 1.0, 1e7] {
        for irradiance in [1e-12_f32, 1.0, 1e12] {
            let mut scene = floor(size);
            let direction = Vec3::new(0.6, -0.8, 0.0);
            scene.punctual_lights = vec![PunctualLight::directional(direction, [irradiance; 3])];
            let expected = f64::from(ALBEDO * irradiance) / std::f64::consts::PI * 0.8;
            assert_exactly(&scene, size, [3.0, -2.0], expected);
            // From below the sun is behind the floor.
            scene.punctual_lights[0] = PunctualLight::directional(-direction, [irradiance; 3]);
            assert_exactly(&scene, size, [3.0, -2.0], 0.0);
        }
    }
}

/// `KHR_lights_punctual`: full inside of the inner cone, nothing outside of the outer one, between them the square of a
/// linear ramp in the cosine. Equal cones: a hard edge.
#[test]
fn floor_below_a_spot() {
    let intensity = 5.0_f32;
    for [inner, outer] in [[0.95_f32, 0.8], [0.9, 0.9], [1.0, 0.0]] {
        let mut scene = floor(1.0);
        let spot = PunctualLight::spot(Vec3::new(0.0, 1.0, 0.0), Vec3::NEG_Y, [intensity; 3], [inner, outer]);
        scene.punctual_lights = vec![spot];
        for x in [0.0_f32, 0.2, 0.4, 0.47, 0.5, 0.6, 0.9, 5.0] {
            let cosine = 1.0 / (1.0 + x * x).sqrt();
            let ramp = if cosine >= inner { 1.0 } else { ((cosine - outer) / (inner - outer)).max(0.0) };
            let share = if inner > outer { ramp * ramp } else { f32::from(u8::from(cosine >= inner)) };
            let expected = f64::from(ALBEDO * intensity * share / PI * cosine.powi(3));
            assert_exactly(&scene, 1.0, [x, 0.0], expected);
        }
    }
}

#[test]
fn lights_fade_towards_their_range() {
    let mut scene = floor(1.0);
    let mut light = PunctualLight::point(Vec3::new(0.0, 2.0, 0.0), [3.0; 3]);
    light.range[0] = 2.5;
    scene.punctual_lights = vec![light];
    for x in [0.0_f32, 1.0, 1.6, 9.0] {
        let squared = f64::from(x * x + 4.0);
        let fading = (1.0 - (squared / 6.25).powi(2)).max(0.0);
        let expected = f64::from(ALBEDO) * 3.0 / std::f64::consts::PI * fading / squared * (2.0 / squared.sqrt());
        assert_exactly(&scene, 1.0, [x, 0.0], expected);
    }
}

#[test]
fn obstacles_cast_shadows() {
    let mut scene = floor(1.0);
    let sheet = quad(Vec3::new(-0.5, 1.0, -0.5), Vec3::X, Vec3::Z);
    add_triangles(&mut scene, &sheet, Material::lambert([0.0; 3]));
    for light in [
        PunctualLight::point(Vec3::new(0.0, 2.0, 0.0), [1.0; 3]),
        PunctualLight::directional(Vec3::NEG_Y, [1.0; 3]),
        PunctualLight::spot(Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y, [1.0; 3], [0.5, 0.5]),
    ] {
        scene.punctual_lights = vec![light];
        assert_exactly(&scene, 1.0, [0.01, 0.02], 0.0);
        assert!(seen(&scene, 1.0, [1.2, 0.02], 4).0 > 0.0);
    }
}

/// A light between a floor and the sheet above it is in front of neither.
#[test]
fn shadow_rays_end_at_the_light() {
    let mut scene = floor(1.0);
    let sheet = quad(Vec3::new(-5.0, 2.1, -5.0), 10.0 * Vec3::X, 10.0 * Vec3::Z);
    add_triangles(&mut scene, &sheet, Material::lambert([0.0; 3]));
    scene.punctual_lights = vec![PunctualLight::point(Vec3::new(0.0, 2.0, 0.0), [1.0; 3])];
    assert_exactly(&scene, 1.0, [0.0, 0.0], f64::from(ALBEDO) / std::f64::consts::PI / 4.0);
}

/// Emitters of all kinds at once bring the sum of what each brings alone, however unlike their powers are.
#[test]
fn many_kinds_add_up() {
    let lamp = |scene: &mut SceneData| {
        let lamp = quad(Vec3::new(-0.5, 3.0, -0.5), Vec3::X, Vec3::Z);
        add_triangles(scene, &lamp, Material::emissive([0.0; 3], [2.0; 3]));
    };
    let candle = PunctualLight::point(Vec3::new(0.5, 0.3, 0.0), [0.2; 3]);
    let sun = PunctualLight::directional(Vec3::new(0.6, -0.8, 0.0), [1e4; 3]);
    let spot = PunctualLight::spot(Vec3::new(1.0, 2.0, 0.0), Vec3::NEG_Y, [500.0; 3], [0.6, 0.5]);
    let sky = EnvironmentImage { width: 4, height: 2, texels: vec![[0.3; 4]; 8] };
    let at = [0.0, 0.0];
    let alone = |change: &dyn Fn(&mut SceneData), samples: u32| {
        let mut scene = floor(1.0);
        change(&mut scene);
        seen(&scene, 1.0, at, samples).0
    };
    let parts = [
        alone(&|s| lamp(s), 1 << 12),
        alone(&|s| s.punctual_lights = vec![candle], 1),
        alone(&|s| s.punctual_lights = vec![sun], 1),
        alone(&|s| s.punctual_lights = vec![spot], 1),
        alone(&|s| s.environment = Some(Environment::Image(sky.clone())), 1 << 12),
    ];
    let mut all = floor(1.0);
    lamp(&mut all);
    all.punctual_lights = vec![candle, sun, spot];
    all.environment = Some(Environment::Image(sky.clone()));
    let samples = 1 << 16;
    let sun_alone = parts[2];
    let expected: f64 = parts.iter().sum();
    let (mean, _) = seen(&all, 1.0, at, samples);
    assert!((mean / expected - 1.0).abs() < 0.01, "{mean}, not {expected}");
    // Without the sun, whose light drowns the others: the share of each is right too.
    all.punctual_lights = vec![candle, spot];
    let (mean, _) = seen(&all, 1.0, at, samples);
    let expected = expected - sun_alone;
    assert!((mean / expected - 1.0).abs() < 0.01, "{mean}, not {expected}");

    // Probabilities add up to 1: triangles by density and area, lights without extent, and the environment.
    all.punctual_lights = vec![candle, sun, spot];
    let packed = PackedScene::new(&all).unwrap();
    let view = packed.view();
    let triangles: f32 = view.lights.iter().map(|l| l.edge1[3] * 0.5).sum();
    let punctual: f32 = view.punctual_lights.iter().map(|l| l.range[1]).sum();
    let environment = view.header.environment_probability;
    assert!((triangles + punctual + environment - 1.0).abs() < 1e-5, "{triangles} {punctual} {environment}");
    // The candle is 10⁻⁷ of the power, and the sun leaves the rest a quarter.
    assert!(view.punctual_lights[0].range[1] > 1e-3, "{:?}", view.punctual_lights[0]);
    assert!(view.punctual_lights[1].range[1] + environment <= 0.7501);
}

/// How often each light is chosen is what its sample says.
#[test]
fn choices_have_their_probability() {
    const SAMPLES: u32 = 200_000;
    let mut scene = floor(1.0);
    let heights = [1.0, 2.0, 4.0, 8.0, 16.0];
    let light = |y: f32| PunctualLight::point(Vec3::new(0.0, y, 0.0), [y; 3]);
    scene.punctual_lights = heights.map(light).to_vec();
    let packed = PackedScene::new(&scene).unwrap();
    let mut counts = [0_u64; 5];
    for i in 0..SAMPLES {
        let mut sampler = Independent::new(i, 0xbeef);
        let sample = sample_light::<{ Needs::ALL }>(&packed.view(), &mut sampler, Vec3::ZERO).unwrap();
        assert!(sample.is_delta);
        counts[heights.iter().position(|&y| sample.target == Some(Vec3::new(0.0, y, 0.0))).unwrap()] += 1;
    }
    let expected: Vec<f64> =
        packed.view().punctual_lights.iter().map(|l| f64::from(l.range[1]) * f64::from(SAMPLES)).collect();
    assert!((expected.iter().sum::<f64>() / f64::from(SAMPLES) - 1.0).abs() < 1e-6);
    common::chi2::check("punctual lights", &counts, &expected);
}

fn sky() -> EnvironmentImage {
    let texel = |i: u32| [(i * 7 % 13) as f32, (i % 5) as f32, if i == 20 { 90.0 } else { 0.1 }, 0.0];
    EnvironmentImage { width: 16, height: 6, texels: (0..96).map(texel).collect() }
}

fn packed_sky(image: EnvironmentImage, rotation: f32) -> PackedScene {
    let environment = Some(Environment::Image(image));
    PackedScene::new(&SceneData { environment, environment_rotation: rotation, ..SceneData::default() }).unwrap()
}

/// What was at −z comes to −x.
#[test]
fn environments_turn_counter_clockwise_seen_from_above() {
    let mut image = sky();
    image.texels.fill([0.0; 4]);
    // Left and right of the centre column.
    for y in 0..6 {
        (image.texels[y * 16 + 7], image.texels[y * 16 + 8]) = ([1.0; 4], [1.0; 4]);
    }
    let at = |rotation: f32, d: Vec3| packed_sky(image.clone(), rotation).view().environment.evaluate(d).radiance.x;
    assert!((at(0.0, Vec3::NEG_Z) - 1.0).abs() < 1e-5 && at(0.0, Vec3::NEG_X) < 1e-5);
    assert!((at(FRAC_PI_2, Vec3::NEG_X) - 1.0).abs() < 1e-5 && at(FRAC_PI_2, Vec3::NEG_Z) < 1e-5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Turning by whole columns is shifting them, for what is seen and for what is sampled.
    #[test]
    fn turning_is_shifting(columns in 0_usize..16, turns in -3_i32..3, d in prop::array::uniform3(-1.0_f32..1.0)) {
        let d = Vec3::from_array(d);
        prop_assume!(d.length() > 0.1 && d.x.hypot(d.z) > 0.01);
        let d = d.normalize();
        let rotation = (columns as f32 / 16.0 + turns as f32) * TAU;
        let turned = packed_sky(sky(), rotation);
        // Counter-clockwise is to the left in the picture.
        let mut shifted = sky();
        for row in shifted.texels.chunks_exact_mut(16) {
            row.rotate_left(columns);
        }
        let shifted = packed_sky(shifted, 0.0);
        let (a, b) = (turned.view().environment.evaluate(d), shifted.view().environment.evaluate(d));
        prop_assert!(a.radiance.distance(b.radiance) < 2e-2, "{a:?} {b:?}");
        prop_assert!((a.pdf - b.pdf).abs() < 1e-3 * (1.0 + b.pdf), "{a:?} {b:?}");
    }

    /// Whatever the angle, a sampled direction shows the radiance and the density that its sample states.
    #[test]
    fn samples_are_what_is_seen(rotation in prop_oneof![Just(0.0_f32), -7.0_f32..7.0, -1e6_f32..1e6], seed in any::<u32>()) {
        let packed = packed_sky(sky(), rotation);
        let view = packed.view();
        for i in 0..16 {
            let Some(sample) = view.environment.sample(Independent::new(i, seed).next_2d(), 1.0) else { continue };
            prop_assert!((sample.direction.length() - 1.0).abs() < 1e-5);
            prop_assume!(sample.direction.y.abs() < 0.999);
            let seen = view.environment.evaluate(sample.direction);
            prop_assert!(seen.radiance.distance(sample.radiance) < 1e-2 * (1.0 + sample.radiance.length()));
            prop_assert!((seen.pdf / sample.pdf - 1.0).abs() < 2e-2 || sample.pdf < 1e-3, "{seen:?} {sample:?}");
        }
    }

    /// A scene that is turned together with its environment looks the same.
    #[test]
    fn turning_everything_changes_nothing(angle in -7.0_f32..7.0, seed in any::<u32>()) {
        let (s, c) = angle.sin_cos();
        let mut still = floor(1.0);
        still.environment = Some(Environment::Image(sky()));
        let mut turned = still.clone();
        turned.environment_rotation = angle;
        turned.instances[0] = Instance {
            to_scene: [[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.0]],
            ..turned.instances[0]
        };
        for i in 0..8 {
            let sample = |scene: &SceneData| {
                let packed = PackedScene::new(scene).unwrap();
                sample_light::<{ Needs::ALL }>(&packed.view(), &mut Independent::new(i, seed), Vec3::ZERO)
            };
            let (Some(a), Some(b)) = (sample(&still), sample(&turned)) else { continue };
            let there = Vec3::new(c * a.direction.x + s * a.direction.z, a.direction.y, c * a.direction.z - s * a.direction.x);
            prop_assert!(there.distance(b.direction) < 1e-5);
            prop_assert_eq!((a.radiance, a.pdf), (b.radiance, b.pdf));
        }
    }
}
