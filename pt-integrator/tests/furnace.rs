//! Rooms in which every path must find the same light.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions and exact values")]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_sphere, add_triangles, inward_box};
use hashcache_core::geometry::Ray;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathOutcome, PathSettings, RayCounts, trace_path};
use pt_integrator::sampler::Sobol;
use pt_integrator::scene::{Environment, Material, SceneData};

/// Outcomes of `samples` paths from one point in varied directions.
fn trace(scene: &SceneData, from: Vec3, settings: PathSettings, samples: u32) -> Vec<PathOutcome> {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let mut counts = RayCounts::default();
    (0..samples)
        .map(|i| {
            let angle = i as f32 * 2.399_963;
            let y = 1.0 - (2 * i + 1) as f32 / samples as f32;
            let direction = Vec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
            let ray = Ray { origin: from, t_min: 0.0, direction: direction.normalize(), t_max: f32::MAX };
            trace_path(&view, &caster, &mut Sobol::new(i, 1), &ray, &settings, &mut counts)
        })
        .collect()
}

fn mean(outcomes: &[PathOutcome]) -> f64 {
    outcomes.iter().map(|o| f64::from(o.radiance().x)).sum::<f64>() / outcomes.len() as f64
}

/// In a closed room whose walls all emit 1 and reflect a, N scatterings see 1 + a + … + aᴺ. Only the share between
/// next event and scattering varies, and near edges their weights do: the mean over the paths has that noise.
#[test]
fn closed_room_of_emitting_walls() {
    for albedo in [0.5_f32, 0.9] {
        let mut scene = SceneData::default();
        add_triangles(
            &mut scene,
            &inward_box(Vec3::new(-1.0, -0.8, -1.2), Vec3::new(1.1, 0.9, 1.0)),
            Material::emissive([albedo; 3], [1.0; 3]),
        );
        for bounces in [0, 1, 2, 8] {
            let settings = PathSettings { max_bounces: bounces, ..PathSettings::default() };
            let expected: f64 = (0..=bounces).map(|k| f64::from(albedo).powi(k as i32)).sum();
            let found = mean(&trace(&scene, Vec3::splat(0.1), settings, 16384));
            let tolerance = if bounces == 0 { 1e-6 } else { 0.01 };
            assert!((found / expected - 1.0).abs() < tolerance, "albedo {albedo}, {bounces}: {found}, not {expected}");
        }
    }
}

/// A convex body under an even sky has the sky's radiance times its albedo, exactly and on every path: scattering by
/// the cosine is in proportion to what arrives.
#[test]
fn convex_body_under_an_even_sky() {
    for albedo in [0.5_f32, 0.9] {
        for smooth in [false, true] {
            let sky = Environment::Constant([2.0; 3]);
            let mut scene = SceneData { environment: Some(sky), ..SceneData::default() };
            add_sphere(&mut scene, Vec3::new(0.0, 0.0, -5.0), 1.0, 12, smooth, Material::lambert([albedo; 3]));
            let towards = |o: &PathOutcome| o.has_vertex;
            let outcomes = trace(&scene, Vec3::new(0.0, 0.0, -2.0), PathSettings::default(), 512);
            assert!(outcomes.iter().filter(|o| towards(o)).count() > 10);
            for o in &outcomes {
                let expected = if o.has_vertex { 2.0 * albedo } else { 2.0 };
                // A smooth normal leans over its facet: a grazing direction may enter the body and scatter again.
                if !smooth || !o.has_vertex {
                    assert!((o.radiance().x - expected).abs() < 1e-5, "{o:?}");
                } else {
                    assert!(o.radiance().x < expected + 1e-5, "{o:?}");
                }
            }
        }
    }
}

/// The inside of a sphere that does not emit, in the dark, brings nothing; not a negative, not a NaN.
#[test]
fn dark_room_is_black() {
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), Material::lambert([0.9; 3]));
    for outcome in trace(&scene, Vec3::ZERO, PathSettings::default(), 64) {
        assert!(outcome.has_vertex);
        assert_eq!(outcome.radiance(), Vec3::ZERO);
    }
}

/// Roulette changes the noise, not the mean.
#[test]
fn roulette_keeps_the_mean() {
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), Material::emissive([0.8; 3], [1.0; 3]));
    let expected: f64 = (0..=8).map(|k| 0.8_f64.powi(k)).sum();
    for roulette_depth in [1, 3, 5] {
        let settings = PathSettings { roulette_depth, ..PathSettings::default() };
        let found = mean(&trace(&scene, Vec3::splat(0.1), settings, 16384));
        assert!((found / expected - 1.0).abs() < 0.02, "from {roulette_depth}: {found}, not {expected}");
    }
}
