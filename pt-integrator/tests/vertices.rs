//! The light of each kept vertex against sums that can be written down.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_triangles, inward_box, quad};
use hashcache_core::record::VertexRecord;
use proptest::prelude::*;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{MAX_STORED, PathOutcome, PathSettings, RayCounts, VertexSettings};
use pt_integrator::path::{trace_path, trace_path_vertices};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::Sobol;
use pt_integrator::scene::{Environment, EnvironmentImage, Material, SceneData};

/// The kept vertices of `samples` paths from one point in varied directions.
fn trace(
    scene: &SceneData,
    from: Vec3,
    settings: VertexSettings,
    store: usize,
    samples: u32,
) -> (Vec<Vec<PathOutcome>>, RayCounts) {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let mut counts = RayCounts::default();
    let paths = (0..samples)
        .map(|i| {
            let angle = i as f32 * 2.399_963;
            let y = 1.0 - (2 * i + 1) as f32 / samples as f32;
            let direction = Vec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
            let ray = ray_towards(from, direction.normalize());
            let mut vertices = vec![PathOutcome::NONE; store];
            trace_path_vertices(&view, &caster, &mut Sobol::new(i, 1), &ray, &settings, &mut vertices, &mut counts);
            vertices
        })
        .collect();
    (paths, counts)
}

fn settings(max_bounces: u32, length: u32, roulette_depth: u32) -> VertexSettings {
    VertexSettings { path: PathSettings { max_bounces, roulette_depth }, length }
}

/// A closed room whose walls all emit 1 and reflect `albedo`: light by triangles, half by next event, half by what
/// scattering meets.
fn room(albedo: f32) -> SceneData {
    let mut scene = SceneData::default();
    let walls = inward_box(Vec3::new(-1.0, -0.8, -1.2), Vec3::new(1.1, 0.9, 1.0));
    add_triangles(&mut scene, &walls, Material::emissive([albedo; 3], [1.0; 3]));
    scene
}

/// Mean of one vertex's light over the paths that have it.
fn mean(paths: &[Vec<PathOutcome>], k: usize, light: impl Fn(&PathOutcome) -> f32) -> f64 {
    let all: Vec<f64> = paths.iter().filter(|v| v[k].has_vertex).map(|v| f64::from(light(&v[k]))).collect();
    assert!(all.len() * 50 > paths.len() * 49, "vertex {k} is there");
    all.iter().sum::<f64>() / all.len() as f64
}

/// Every kept vertex, the first or a later one, finds 1 by its own eyes and a + … + a^len through len further
/// scatterings, whatever the roulette does. Its own albedo is in none of it.
#[test]
fn closed_room_of_emitting_walls() {
    const NEVER: u32 = PathSettings::NO_ROULETTE;
    for (albedo, store, length, roulette) in [
        (0.5_f32, 3, 0, NEVER),
        (0.5, 3, 1, NEVER),
        (0.9, 4, 7, NEVER),
        (0.9, 1, 7, NEVER),
        (0.5, 2, 4, 1),
        (0.9, 3, 5, 2),
        (0.9, 8, 2, 4),
    ] {
        let scene = room(albedo);
        let (paths, counts) = trace(&scene, Vec3::splat(0.1), settings(8, length, roulette), store, 8192);
        let what = format!("albedo {albedo}, {store} kept, length {length}, roulette from {roulette}");
        let expected: f64 = (1..=length).map(|k| f64::from(albedo).powi(k as i32)).sum();
        // By roulette some paths end before the last vertex that could be kept; those that go on are weighted for it.
        let mut reach = 1.0;
        for k in 0..store {
            let alive = paths.iter().filter(|v| v[k].has_vertex).count() as f64 / paths.len() as f64;
            reach *= if k as u32 >= roulette { 0.95 } else { 1.0 };
            assert!((alive / reach - 1.0).abs() < 0.02, "{what}: {alive} of the paths have vertex {k}");
            let found = |light: fn(&PathOutcome) -> f32| {
                let all = paths.iter().filter(|v| v[k].has_vertex).map(|v| f64::from(light(&v[k])));
                all.sum::<f64>() / (alive * paths.len() as f64)
            };
            let (direct, further) = (found(|v| v.direct.x), found(|v| v.further.x));
            assert!((direct - 1.0).abs() < 0.02, "{what}: direct {direct} at vertex {k}");
            let tolerance = if roulette == NEVER { 0.02 } else { 0.04 };
            assert!((further - expected).abs() <= tolerance * expected, "{what}: {further} at {k}, not {expected}");
        }
        if roulette == NEVER {
            let closest = 1 + store as u64 + u64::from(length);
            assert!(counts.closest > closest * 8192 * 999 / 1000 && counts.closest <= closest * 8192);
        }
    }
}

/// Paths never get longer than their limits, and a vertex never holds more than `max_bounces` scatterings.
#[test]
fn length_is_bounded_by_max_bounces() {
    let scene = room(0.5);
    for (length, max_bounces) in [(7, 3), (u32::MAX, 3), (2, 3)] {
        let (paths, counts) = trace(&scene, Vec3::ZERO, settings(max_bounces, length, u32::MAX), 2, 2048);
        assert!(counts.closest <= 2048 * 5);
        assert!((mean(&paths, 1, |v| v.further.x) - 0.75).abs() < 0.02);
    }
    let (paths, _) = trace(&scene, Vec3::ZERO, settings(0, 5, u32::MAX), 2, 16);
    assert!(paths.iter().all(|v| !v[0].has_vertex && v[0].emitted == Vec3::ONE && v[1] == PathOutcome::NONE));
    let (paths, _) = trace(&scene, Vec3::ZERO, settings(1, u32::MAX, u32::MAX), 2, 64);
    assert!(paths.iter().flatten().all(|v| v.has_vertex && v.further == Vec3::ZERO && v.direct.x > 0.0));
}

/// Next-event light alone: walls that reflect `a` about a lamp that is too small to be met. What a vertex holds is the
/// mean of its own next event, no albedo in it, and a times what the vertex behind it holds with one scattering less.
#[test]
fn next_event_light_passes_one_albedo_a_vertex() {
    let a = 0.6_f32;
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), Material::lambert([a; 3]));
    let lamp = quad(Vec3::splat(0.01), 1e-4 * Vec3::X, 1e-4 * Vec3::Z);
    let bright = Material { flags: Material::DOUBLE_SIDED, ..Material::emissive([0.0; 3], [1e6; 3]) };
    add_triangles(&mut scene, &lamp, bright);
    let (paths, _) = trace(&scene, Vec3::new(0.5, -0.3, 0.2), settings(5, 2, u32::MAX), 3, 512);
    for v in &paths {
        assert!(v.iter().all(|v| v.has_vertex && v.direct.x > 0.0));
        // Vertex 1 hears of the vertices 2 and 3: light from two scatterings on, no more.
        let expected = a * v[1].direct.x + a * a * v[2].direct.x;
        assert!((v[0].further.x / expected - 1.0).abs() < 1e-5, "{} is not {expected}", v[0].further.x);
        assert!(v[1].further.x > a * v[2].direct.x * 0.999_99);
        assert!((v[2].throughput.x / (a * a * a) - 1.0).abs() < 1e-5);
    }
}

/// An even environment image through an open room's missing wall: next event and scattering share it, vertices of any
/// rank see the same when the room is a plane, which sees 1 and nothing further.
#[test]
fn plane_under_an_even_image() {
    let image = EnvironmentImage { width: 32, height: 16, texels: vec![[1.0; 4]; 512] };
    let mut scene = SceneData { environment: Some(Environment::Image(image)), ..SceneData::default() };
    let plane = quad(Vec3::new(-9.0, 0.0, -9.0), 18.0 * Vec3::Z, 18.0 * Vec3::X);
    add_triangles(&mut scene, &plane, Material::lambert([0.9; 3]));
    let (paths, _) = trace(&scene, Vec3::Y, settings(8, 7, u32::MAX), 2, 8192);
    let below: Vec<_> = paths.iter().filter(|v| v[0].has_vertex).collect();
    assert!(below.len() > 3000);
    let direct = below.iter().map(|v| f64::from(v[0].direct.x)).sum::<f64>() / below.len() as f64;
    assert!((direct - 1.0).abs() < 0.01, "{direct}");
    assert!(below.iter().all(|v| v[0].further == Vec3::ZERO && v[1] == PathOutcome::NONE));
    assert!(paths.iter().all(|v| v[0].has_vertex || (v[0].emitted.x - 1.0).abs() < 1e-5));
}

/// A black first surface: a cache may share its light with a white one, so roulette must not end the path for it.
#[test]
fn roulette_lights_black_surfaces_too() {
    let mut scene = SceneData::default();
    let walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    add_triangles(&mut scene, &walls, Material::lambert([0.8; 3]));
    let black = quad(Vec3::new(-0.99, -0.99, -0.99), 1.98 * Vec3::Z, 1.98 * Vec3::X);
    add_triangles(&mut scene, &black, Material::lambert([0.0; 3]));
    let lamp = quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.2; 3], [5.0; 3]));
    let light = |roulette| {
        let (paths, _) = trace(&scene, Vec3::ZERO, settings(6, u32::MAX, roulette), 1, 16384);
        let dark = paths.iter().filter(|v| v[0].throughput == Vec3::ZERO).map(|v| f64::from(v[0].further.x));
        (dark.clone().sum::<f64>() / dark.count() as f64, paths)
    };
    let ((never, _), (from_two, _)) = (light(u32::MAX), light(2));
    assert!(never > 0.1 && (from_two / never - 1.0).abs() < 0.1, "{from_two}, not {never}");
}

/// One kept vertex is the path tracer's, bit for bit; further ones change nothing of the first's direct light.
#[test]
fn first_vertex_is_the_path_tracers() {
    let mut scene = room(0.7);
    scene.materials[0].emission = [0.0; 4];
    let lamp = quad(Vec3::new(-0.4, 0.85, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.2; 3], [5.0, 4.0, 3.0]));
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let mut counts = RayCounts::default();
    for i in 0..512 {
        let ray = ray_towards(Vec3::ZERO, Vec3::new(0.3, -0.5, (i as f32).cos()).normalize());
        let path = PathSettings { max_bounces: 5, ..PathSettings::default() };
        let whole = trace_path(&view, &caster, &mut Sobol::new(i, 1), &ray, &path, &mut counts);
        for store in [1, 3] {
            let mut kept = vec![PathOutcome::NONE; store];
            let settings = VertexSettings::new(path);
            trace_path_vertices(&view, &caster, &mut Sobol::new(i, 1), &ray, &settings, &mut kept, &mut counts);
            assert_eq!(kept[0], whole, "{store} kept");
            for (k, v) in kept.iter().enumerate() {
                assert_eq!(v.is_secondary, k > 0);
                let flags = v.record(1.0, 0).flags;
                assert_eq!(flags, VertexRecord::VALID | if k > 0 { VertexRecord::SECONDARY } else { 0 });
            }
        }
    }
}

/// The footprint of a later vertex is that of the whole path to it.
#[test]
fn distances_add_up() {
    let (paths, _) = trace(&room(0.5), Vec3::splat(0.1), settings(4, 1, u32::MAX), MAX_STORED, 64);
    for v in &paths {
        let mut from = Vec3::splat(0.1);
        let mut length = 0.0;
        for v in v {
            length += v.position.distance(from);
            from = v.position;
            assert!((v.distance / length - 1.0).abs() < 1e-4);
            assert!((v.direction.length() - 1.0).abs() < 1e-5 && v.normal.dot(v.direction) <= 1e-6);
        }
    }
    // More room than a path keeps stays empty.
    let (paths, _) = trace(&room(0.5), Vec3::ZERO, settings(4, 1, u32::MAX), MAX_STORED + 2, 4);
    assert!(paths.iter().all(|v| v[MAX_STORED - 1].has_vertex && !v[MAX_STORED].has_vertex));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn nothing_is_nan(
        scale in -4_i32..8,
        emission in -12_i32..13,
        albedo in 0.0_f32..1.0,
        store in 0_usize..10,
        length: u32,
        roulette in 1_u32..12,
    ) {
        let size = 10.0_f32.powi(scale);
        let mut scene = SceneData::default();
        let walls = inward_box(-Vec3::splat(size), Vec3::splat(size));
        add_triangles(&mut scene, &walls, Material::lambert([albedo, 1.0, 0.0]));
        let lamp = inward_box(Vec3::splat(-0.25 * size), Vec3::splat(0.25 * size));
        add_triangles(&mut scene, &lamp, Material::emissive([albedo; 3], [10.0_f32.powi(emission), 0.0, 1e-12]));
        let (paths, counts) = trace(&scene, Vec3::splat(0.5 * size), settings(6, length, roulette), store, 32);
        prop_assert_eq!(counts.non_finite, 0);
        prop_assert_eq!(counts.paths, 32);
        for v in paths.iter().flatten() {
            prop_assert!(v.is_finite() && v.direct.min_element() >= 0.0 && v.further.min_element() >= 0.0);
            prop_assert!(v.distance.is_finite() && v.throughput.is_finite());
        }
    }
}

/// Light beyond numbers at any kept vertex drops the light of the whole path, and is counted once.
#[test]
fn overflow_is_counted() {
    let mut scene = room(1.0);
    scene.materials[0].emission = [2e38; 4];
    let (paths, counts) = trace(&scene, Vec3::ZERO, settings(8, 7, u32::MAX), 4, 64);
    assert_eq!(counts.non_finite, 64);
    assert!(paths.iter().flatten().all(|v| v.has_vertex && v.radiance() == Vec3::ZERO));
}
