//! Direct light of first vertices against the path tracer's.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_sphere, add_triangles, inward_box, quad};
use hashcache_core::geometry::Ray;
use proptest::prelude::*;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{
    DirectSettings, PathOutcome, PathSettings, RayCounts, Strategy, VisibleSettings, trace_path, trace_visible,
};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::{Independent, Sobol};
use pt_integrator::scene::{Environment, EnvironmentImage, Material, SceneData, Texture, Wrap};

/// A room without a wall, with two lamps and a ball; its floor is textured.
fn room(environment: Option<Environment>, lamps: bool) -> SceneData {
    let mut scene = SceneData { environment, ..SceneData::default() };
    let mut walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    walls.truncate(10);
    let textured = Material::lambert([0.7, 0.5, 0.3]).textured(Material::BASE_COLOR, 0);
    scene.texels = vec![0x0040_80c0, 0x00c0_4080, 0x0080_c040, 0x00ff_ffff];
    scene.textures = vec![Texture::new(0, [2, 2], [Wrap::Repeat, Wrap::Mirror])];
    add_triangles(&mut scene, &walls, textured);
    add_sphere(&mut scene, Vec3::new(0.3, -0.5, 0.2), 0.4, 4, true, Material::lambert([0.8, 0.8, 0.2]));
    if lamps {
        let large = quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
        add_triangles(&mut scene, &large, Material::emissive([0.2; 3], [3.0, 2.0, 1.0]));
        let small = quad(Vec3::new(0.9, -0.2, 0.6), 0.1 * Vec3::Y, -0.1 * Vec3::Z);
        let both = Material { flags: Material::DOUBLE_SIDED, ..Material::emissive([0.2; 3], [9.0, 20.0, 40.0]) };
        add_triangles(&mut scene, &small, both);
    }
    scene
}

fn sun_and_sky() -> Environment {
    let texel = |i: u32| if i % 16 == 3 { [9.0, 8.0, 6.0, 0.0] } else { [0.2, 0.3, 0.5 + 0.01 * i as f32, 0.0] };
    Environment::Image(EnvironmentImage { width: 16, height: 8, texels: (0..16 * 8).map(texel).collect() })
}

fn mean_and_error(values: impl Iterator<Item = Vec3>) -> (f64, f64) {
    let values: Vec<f64> = values.map(|v| f64::from(v.x + v.y + v.z)).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n / n).sqrt())
}

fn visible(scene: &SceneData, ray: &Ray, direct: DirectSettings, samples: u32) -> (Vec<PathOutcome>, RayCounts) {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let direct = direct.for_scene(&view);
    let mut counts = RayCounts::default();
    let one = |sample: u32| {
        let numbers = |strategy, _, i| match strategy {
            Strategy::NextEvent => Independent::new(sample * direct.all() + i, 77),
            Strategy::Scattering => Independent::new(sample * direct.scattered + i, 78),
            Strategy::Chain => Independent::new(sample, 79),
        };
        let settings = VisibleSettings { direct, max_bounces: 8 };
        let mut layer = [PathOutcome::NONE];
        trace_visible(&view, &caster, ray, &settings, &mut layer, numbers, &mut counts);
        layer[0]
    };
    ((0..samples).map(one).collect(), counts)
}

const fn settings(samples: u32, candidates: u32, scattered: u32) -> DirectSettings {
    DirectSettings { samples, candidates, scattered }
}

const SETTINGS: [DirectSettings; 7] = [
    settings(1, 1, 0),
    settings(1, 4, 1),
    settings(3, 1, 2),
    settings(4, 3, 0),
    settings(0, 1, 1),
    settings(1, 0, 4),
    settings(1000, 1000, 1),
];

/// The mean is the path tracer's, for every kind of emitter and number of samples.
#[test]
fn direct_light_is_the_path_tracers() {
    let sky = Environment::Constant([0.5, 0.7, 1.0]);
    for (what, scene) in [
        ("lamps", room(None, true)),
        ("even sky", room(Some(sky.clone()), false)),
        ("even sky and lamps", room(Some(sky), true)),
        ("image", room(Some(sun_and_sky()), false)),
        ("image and lamps", room(Some(sun_and_sky()), true)),
    ] {
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        for towards in [Vec3::new(1.0, -0.4, 0.8), Vec3::new(0.2, -0.9, 0.1), Vec3::new(0.5, 0.6, 0.9)] {
            let ray = ray_towards(Vec3::new(-0.9, 0.1, -0.8), towards.normalize());
            let path = PathSettings { max_bounces: 1, ..PathSettings::default() };
            let mut counts = RayCounts::default();
            let whole: Vec<PathOutcome> = (0..16_000)
                .map(|i| trace_path(&view, &caster, &mut Independent::new(i, 3), &ray, &path, &mut counts))
                .collect();
            let (expected, sigma) = mean_and_error(whole.iter().map(|o| o.direct));
            for direct in SETTINGS.into_iter().chain([DirectSettings::new(2, &view)]) {
                let (seen, counts) = visible(&scene, &ray, direct, 16_000 / (direct.all() + direct.scattered).max(4));
                let (mean, error) = mean_and_error(seen.iter().map(|o| o.direct));
                let bound = 4.5 * sigma.hypot(error) + 1e-5 * expected;
                assert!((mean - expected).abs() < bound, "{what}, {direct:?}: {mean} ± {error}, not {expected}");
                let most = u64::from(direct.samples.min(DirectSettings::MAX_CANDIDATES) + direct.scattered.max(1));
                let paths = seen.len() as u64;
                assert!(counts.paths == paths && counts.shadow_traced + counts.closest <= paths * (1 + most));
                // All but the light is the path's.
                let (o, w) = (&seen[0], &whole[0]);
                assert_eq!(PathOutcome { direct: w.direct, ..*o }, PathOutcome { further: Vec3::ZERO, ..*w });
            }
        }
    }
}

/// Under an even sky a plane sees 1 in every sample, whatever the numbers are.
#[test]
fn plane_under_an_even_sky() {
    let mut scene = SceneData { environment: Some(Environment::Constant([1.0, 2.0, 3.0])), ..SceneData::default() };
    let plane = quad(Vec3::new(-9.0, 0.0, -9.0), 18.0 * Vec3::Z, 18.0 * Vec3::X);
    add_triangles(&mut scene, &plane, Material::lambert([0.9; 3]));
    for direct in SETTINGS {
        for o in visible(&scene, &ray_towards(Vec3::Y, Vec3::NEG_Y), direct, 64).0 {
            assert!((o.direct - Vec3::new(1.0, 2.0, 3.0)).abs().max_element() < 1e-4, "{o:?}");
        }
        let (sky, _) = visible(&scene, &ray_towards(Vec3::Y, Vec3::Y), direct, 1);
        assert!(!sky[0].has_vertex && sky[0].emitted == Vec3::new(1.0, 2.0, 3.0));
    }
}

#[test]
fn no_samples_no_light_no_shadow_rays() {
    let none = DirectSettings::NONE;
    let (seen, counts) = visible(&room(None, true), &ray_towards(Vec3::ZERO, Vec3::new(0.6, -0.8, 0.0)), none, 8);
    assert!(seen.iter().all(|o| o.has_vertex && o.direct == Vec3::ZERO && o.throughput != Vec3::ZERO));
    assert_eq!((counts.closest, counts.shadow_asked), (8, 0));
}

/// More candidates, less noise where emitters differ in what they bring; and stratified numbers beat independent ones.
#[test]
fn candidates_and_strata_reduce_noise() {
    let scene = room(None, true);
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let ray = ray_towards(Vec3::new(-0.9, 0.1, -0.8), Vec3::new(1.0, -0.4, 0.8).normalize());
    let error = |candidates| {
        let direct = settings(1, candidates, 0);
        mean_and_error(visible(&scene, &ray, direct, 20_000).0.iter().map(|o| o.direct)).1
    };
    assert!(error(8) < 0.8 * error(1));
    let direct = settings(4, 1, 0);
    let spread = |sobol: bool| {
        let mut counts = RayCounts::default();
        let pixel = |seed: u32| {
            let mut one = |sample: u32| {
                let index = |i| sample * 4 + i;
                let settings = VisibleSettings { direct, max_bounces: 8 };
                let mut layer = [PathOutcome::NONE];
                if sobol {
                    let numbers = |_, _, i| Sobol::new(index(i), seed);
                    trace_visible(&view, &caster, &ray, &settings, &mut layer, numbers, &mut counts);
                } else {
                    let numbers = |_, _, i| Independent::new(index(i), seed);
                    trace_visible(&view, &caster, &ray, &settings, &mut layer, numbers, &mut counts);
                }
                layer[0]
            };
            (0..4).map(|sample| one(sample).direct).sum::<Vec3>() * 0.25
        };
        mean_and_error((0..500).map(pixel)).1
    };
    assert!(spread(true) < 0.8 * spread(false));
}

/// Next to an emitter next event alone may bring any amount of light; with a scattered ray no more than twice the
/// emitter's radiance.
#[test]
fn scattering_bounds_light_near_emitters() {
    let mut scene = SceneData::default();
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), 2.0 * Vec3::Z, 2.0 * Vec3::X);
    add_triangles(&mut scene, &floor, Material::lambert([0.5; 3]));
    // It stands on the floor and looks along it.
    let lamp = quad(Vec3::new(0.0, 0.0, -0.5), Vec3::Y, Vec3::Z);
    let lamp_material = Material { flags: Material::DOUBLE_SIDED, ..Material::emissive([0.0; 3], [1.0; 3]) };
    add_triangles(&mut scene, &lamp, lamp_material);
    let ray = ray_towards(Vec3::new(0.002, 1.0, 0.0), Vec3::NEG_Y);
    let brightest = |scattered| {
        let (seen, _) = visible(&scene, &ray, settings(1, 1, scattered), 4096);
        seen.iter().map(|o| o.direct.x).fold(0.0, f32::max)
    };
    assert!(brightest(0) > 10.0 && brightest(1) <= 2.0, "{} {}", brightest(0), brightest(1));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_is_nan(
        scale in -4_i32..8,
        emission in -12_i32..13,
        sky in prop::option::of(0.0_f32..10.0),
        samples: u32,
        candidates: u32,
        scattered in 0_u32..4,
        inside in 0.0_f32..1.0,
    ) {
        let size = 10.0_f32.powi(scale);
        let environment = sky.map(|x| Environment::Constant([x, 0.0, 1.0]));
        let mut scene = SceneData { environment, ..SceneData::default() };
        let mut walls = inward_box(-Vec3::splat(size), Vec3::splat(size));
        walls.truncate(11);
        add_triangles(&mut scene, &walls, Material::lambert([0.5, 1.0, 0.0]));
        let mut lamp = inward_box(Vec3::splat(-0.25 * size), Vec3::splat(0.25 * size));
        lamp.push([Vec3::splat(size); 3]);
        add_triangles(&mut scene, &lamp, Material::emissive([0.5; 3], [10.0_f32.powi(emission), 0.0, 1e-12]));
        let direct = settings(samples, candidates, scattered);
        prop_assert!(direct.all() <= DirectSettings::MAX_CANDIDATES);
        for towards in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)] {
            let ray = ray_towards(Vec3::splat(inside * size * 0.9), towards);
            let (seen, counts) = visible(&scene, &ray, direct, 8);
            prop_assert_eq!(counts.non_finite, 0);
            for o in seen {
                prop_assert!(o.is_finite() && o.direct.min_element() >= 0.0);
            }
        }
    }
}

/// More light than numbers can hold is dropped and counted, and the vertex stays.
#[test]
fn overflow_is_counted() {
    let mut scene = SceneData::default();
    let walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    add_triangles(&mut scene, &walls, Material::emissive([1.0; 3], [3e38; 3]));
    let direct = settings(4, 4, 1);
    let (seen, counts) = visible(&scene, &ray_towards(Vec3::splat(0.9), Vec3::X), direct, 64);
    assert!(counts.non_finite > 0);
    assert!(seen.iter().all(|o| o.has_vertex && o.is_finite()));
}
