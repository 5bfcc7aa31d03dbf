//! Light transport against closed forms and against an independent, simpler estimator.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_sphere, add_triangles, inward_box, quad};
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathOutcome, PathSettings, RayCounts, trace_path};
use pt_integrator::ray::{offset_origin, ray_towards};
use pt_integrator::sampler::{Independent, Sobol};
use pt_integrator::sampling::{Basis, sample_cosine};
use pt_integrator::scene::{Environment, EnvironmentImage, Material, Needs, SceneData};
use pt_integrator::surface::Surface;
use pt_integrator::view::SceneView;

const SETTINGS: PathSettings = PathSettings { max_bounces: 8, roulette_depth: PathSettings::NO_ROULETTE };

fn outcomes<S: Sampler>(
    scene: &SceneData,
    ray: &Ray,
    settings: PathSettings,
    samples: u32,
    sampler: impl Fn(u32) -> S,
) -> Vec<PathOutcome> {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let mut counts = RayCounts::default();
    let outcomes =
        (0..samples).map(|i| trace_path(&view, &caster, &mut sampler(i), ray, &settings, &mut counts)).collect();
    assert_eq!(counts.paths, u64::from(samples));
    assert_eq!(counts.non_finite, 0);
    outcomes
}

fn down(from: Vec3) -> Ray {
    ray_towards(from, Vec3::NEG_Y)
}

/// Irradiance at a point with normal `n` by a polygon of radiance 1 that is wholly above the horizon.
///
/// Lambert 1760; Baum et al. 1989: E = ½ Σ Θᵢ n·Γᵢ.
fn lambert(polygon: &[Vec3], point: Vec3, n: Vec3) -> f64 {
    let corner = |i: usize| (polygon[i % polygon.len()] - point).normalize();
    let edge = |i: usize| {
        let (a, b) = (corner(i), corner(i + 1));
        // The arc tangent keeps small angles exact.
        let cross = a.cross(b);
        f64::from(cross.length().atan2(a.dot(b)) * cross.normalize().dot(n))
    };
    (0..polygon.len()).map(edge).sum::<f64>().abs() / 2.0
}

#[test]
fn floor_below_a_triangle_lamp() {
    for (lamp, albedo) in [
        ([Vec3::new(-0.4, 1.0, -0.3), Vec3::new(0.6, 1.2, -0.2), Vec3::new(0.0, 0.9, 0.7)], 0.6_f32),
        // Close and large, then far and small.
        ([Vec3::new(-3.0, 0.1, -3.0), Vec3::new(3.0, 0.1, -3.0), Vec3::new(0.0, 0.12, 4.0)], 0.9),
        ([Vec3::new(5.0, 9.0, -3.0), Vec3::new(5.1, 9.0, -3.0), Vec3::new(5.0, 9.1, -3.05)], 0.3),
    ] {
        let mut scene = SceneData::default();
        add_triangles(
            &mut scene,
            &quad(Vec3::new(-9.0, 0.0, -9.0), 18.0 * Vec3::Z, 18.0 * Vec3::X),
            Material::lambert([albedo; 3]),
        );
        let radiance = [4.0_f32, 2.0, 1.0];
        add_triangles(
            &mut scene,
            &[lamp],
            Material { flags: Material::DOUBLE_SIDED, ..Material::emissive([0.0; 3], radiance) },
        );
        let point = Vec3::new(0.01, 0.0, 0.02);
        let irradiance = lambert(&lamp, point, Vec3::Y);
        let settings = PathSettings { max_bounces: 1, ..SETTINGS };
        let all = outcomes(&scene, &down(point + 0.05 * Vec3::Y), settings, 1 << 15, |i| Sobol::new(i, 5));
        for (channel, l) in radiance.into_iter().enumerate() {
            let expected = irradiance * f64::from(l * albedo) / std::f64::consts::PI;
            let found = all.iter().map(|o| f64::from(o.radiance()[channel])).sum::<f64>() / all.len() as f64;
            assert!((found / expected - 1.0).abs() < 0.005, "{lamp:?}: {found}, not {expected}");
        }
        // One scattering only: nothing came from further on.
        assert!(all.iter().all(|o| o.further == Vec3::ZERO && o.emitted == Vec3::ZERO));
    }
}

/// An image of one colour is the constant environment.
#[test]
fn even_image_is_the_constant_environment() {
    let floor = quad(Vec3::new(-1.0, 0.0, -1.0), 2.0 * Vec3::Z, 2.0 * Vec3::X);
    let image = EnvironmentImage { width: 32, height: 16, texels: vec![[0.5, 1.0, 2.0, 0.0]; 512] };
    for environment in [Environment::Constant([0.5, 1.0, 2.0]), Environment::Image(image)] {
        let mut scene = SceneData { environment: Some(environment), ..SceneData::default() };
        add_triangles(&mut scene, &floor, Material::lambert([0.5; 3]));
        let all = outcomes(&scene, &down(Vec3::Y), SETTINGS, 4096, |i| Sobol::new(i, 5));
        let mean = all.iter().map(PathOutcome::radiance).sum::<Vec3>() / all.len() as f32;
        assert!((mean - Vec3::new(0.25, 0.5, 1.0)).abs().max_element() < 0.01, "{mean}");
        let seen = outcomes(&scene, &ray_towards(Vec3::Y, Vec3::X), SETTINGS, 1, |i| Sobol::new(i, 5));
        assert!((seen[0].emitted - Vec3::new(0.5, 1.0, 2.0)).abs().max_element() < 1e-5);
        assert!(!seen[0].has_vertex);
    }
}

/// Path tracing without next event: what multiple importance sampling must agree with.
fn scattering_only(view: &SceneView<'_>, caster: &BruteForce, sampler: &mut Independent, ray: &Ray) -> Vec3 {
    let (mut ray, mut weight, mut sum) = (*ray, Vec3::ONE, Vec3::ZERO);
    for _ in 0..=SETTINGS.max_bounces {
        let Some(hit) = caster.closest(&ray) else {
            let [r, g, b, _] = view.header.constant_environment;
            return sum + weight * (Vec3::new(r, g, b) + view.environment.evaluate(ray.direction).radiance);
        };
        let surface = Surface::at::<{ Needs::ALL }>(view, &hit, ray.direction);
        sum += weight * surface.emission::<{ Needs::ALL }>(view);
        weight *= surface.albedo::<{ Needs::ALL }>(view);
        let local = sample_cosine(sampler.next_2d());
        let direction = Basis::new(surface.normal).to_scene(local.truncate(), local.z);
        ray = ray_towards(offset_origin(surface.position, surface.face, direction, surface.offset), direction);
    }
    sum
}

/// A room with a lamp, a smooth ball, a window to a sky with a sun.
fn room(sky: bool) -> SceneData {
    let mut scene = SceneData::default();
    let mut walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    walls.truncate(10);
    if !sky {
        walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    }
    add_triangles(&mut scene, &walls, Material::lambert([0.7, 0.5, 0.3]));
    add_triangles(
        &mut scene,
        &quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z),
        Material::emissive([0.2; 3], [3.0, 2.0, 1.0]),
    );
    add_sphere(&mut scene, Vec3::new(0.3, -0.5, 0.2), 0.4, 4, true, Material::lambert([0.8, 0.8, 0.2]));
    if sky {
        let texel = |i: u32| if i % 16 == 3 { [9.0, 8.0, 6.0, 0.0] } else { [0.2, 0.3, 0.5 + 0.01 * i as f32, 0.0] };
        let texels = (0..16 * 8).map(texel).collect();
        scene.environment = Some(Environment::Image(EnvironmentImage { width: 16, height: 8, texels }));
    }
    scene
}

#[test]
fn next_event_and_scattering_alone_agree() {
    for sky in [false, true] {
        let scene = room(sky);
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        let ray = ray_towards(Vec3::new(-0.9, 0.1, -0.8), Vec3::new(1.0, -0.4, 0.8).normalize());
        let n = 40_000;
        let mean_and_error = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
            (mean, (variance / values.len() as f64).sqrt())
        };
        let luminance = |v: Vec3| f64::from(v.x + v.y + v.z);
        let alone: Vec<f64> =
            (0..n).map(|i| luminance(scattering_only(&view, &caster, &mut Independent::new(i, 3), &ray))).collect();
        let both: Vec<f64> = outcomes(&scene, &ray, SETTINGS, n, |i| Independent::new(i, 77))
            .iter()
            .map(|o| luminance(o.radiance()))
            .collect();
        let ((a, sigma_a), (b, sigma_b)) = (mean_and_error(&alone), mean_and_error(&both));
        let bound = 4.5 * sigma_a.hypot(sigma_b);
        assert!((a - b).abs() < bound, "sky {sky}: alone {a} ± {sigma_a}, with next event {b} ± {sigma_b}");
        assert!(sigma_b < sigma_a, "next event is there to reduce noise");
    }
}

/// `direct` is what one scattering brings and `direct + further` what all bring, path by path: the same numbers are
/// drawn whatever the limit is.
#[test]
fn split_equals_the_whole() {
    for sky in [false, true] {
        let scene = room(sky);
        let ray = ray_towards(Vec3::new(-0.9, 0.1, -0.8), Vec3::new(1.0, -0.4, 0.8).normalize());
        let trace =
            |max_bounces| outcomes(&scene, &ray, PathSettings { max_bounces, ..SETTINGS }, 500, |i| Sobol::new(i, 11));
        let (none, one, all) = (trace(0), trace(1), trace(8));
        for ((none, one), all) in none.iter().zip(&one).zip(&all) {
            assert!(!none.has_vertex && none.emitted == all.emitted);
            assert_eq!(one.direct, all.direct);
            assert_eq!(one.further, Vec3::ZERO);
            assert_eq!(all.radiance(), all.emitted + all.throughput * (all.direct + all.further));
            let record = all.record(0.01, 7);
            assert_eq!(record.direct[..3], all.direct.to_array());
            assert_eq!(record.further[..3], all.further.to_array());
            assert!((record.position_footprint[3] - all.distance * 0.01).abs() < 1e-6);
        }
        assert!(all.iter().any(|o| o.further != Vec3::ZERO) && all.iter().any(|o| o.direct != Vec3::ZERO));
    }
}

/// An emitter's dark side: seen neither directly nor by next event nor by scattering.
#[test]
fn emitters_shine_from_their_front_only() {
    for (flags, bright) in [(0, false), (Material::DOUBLE_SIDED, true)] {
        let mut scene = SceneData::default();
        add_triangles(
            &mut scene,
            &quad(Vec3::new(-1.0, 0.0, -1.0), 2.0 * Vec3::Z, 2.0 * Vec3::X),
            Material::lambert([0.5; 3]),
        );
        // Looks upwards, away from the floor.
        let lamp = quad(Vec3::new(-1.0, 0.5, -1.0), 2.0 * Vec3::Z, 2.0 * Vec3::X);
        add_triangles(&mut scene, &lamp, Material { flags, ..Material::emissive([0.5; 3], [1.0; 3]) });
        let all = outcomes(&scene, &down(0.25 * Vec3::Y), SETTINGS, 256, |i| Sobol::new(i, 2));
        assert_eq!(all.iter().any(|o| o.radiance() != Vec3::ZERO), bright);
        let up = outcomes(&scene, &ray_towards(0.25 * Vec3::Y, Vec3::Y), SETTINGS, 1, |i| Sobol::new(i, 2));
        assert_eq!(up[0].emitted != Vec3::ZERO, bright);
    }
}
