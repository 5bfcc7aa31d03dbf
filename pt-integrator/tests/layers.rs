//! Layers of a pixel: with the true illumination they are the path tracer's picture.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::mixed::{Mean, mean_of_paths, metal, room};
use common::scenes::{add_triangles, quad};
use hashcache_core::geometry::Ray;
use hashcache_core::record::VertexRecord;
use pt_integrator::bsdf::fresnel_dielectric;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{
    DirectSettings, PathOutcome, PathSettings, RayCounts, Strategy, VertexSettings, VisibleSettings, trace_path,
    trace_path_vertices, trace_visible,
};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::Independent;
use pt_integrator::scene::{Environment, EnvironmentImage, Material, SceneData};
use pt_integrator::view::SceneView;

/// So many that what the last of them brings does not show.
const SETTINGS: PathSettings = PathSettings { max_bounces: 24, roulette_depth: PathSettings::NO_ROULETTE };

fn skies() -> [Option<Environment>; 3] {
    let texel = |i: u32| if i % 16 == 3 { [9.0, 8.0, 6.0, 0.0] } else { [0.2, 0.3, 0.5 + 0.01 * i as f32, 0.0] };
    let image = EnvironmentImage { width: 16, height: 8, texels: (0..16 * 8).map(texel).collect() };
    [None, Some(Environment::Constant([0.5, 0.7, 1.0])), Some(Environment::Image(image))]
}

fn rays() -> impl Iterator<Item = Ray> {
    // To the polished floor, the ball, the coated wall, the mirror and the pane.
    let towards = [[0.5, -0.8, -0.3], [1.2, -0.6, -0.5], [0.3, 0.8, -0.1], [-0.4, 0.1, -0.3], [0.6, -0.1, -0.4]];
    towards.into_iter().map(|d| ray_towards(Vec3::new(-0.9, 0.1, 0.7), Vec3::from_array(d).normalize()))
}

fn layers_of(
    view: &SceneView<'_>,
    caster: &BruteForce,
    ray: &Ray,
    direct: DirectSettings,
    sample: u32,
    layers: &mut [PathOutcome],
) {
    let settings = VisibleSettings { direct, max_bounces: SETTINGS.max_bounces };
    let numbers = |strategy, layer, i| {
        let seed = 10 * layer;
        match strategy {
            Strategy::NextEvent => Independent::new(sample * direct.all() + i, 77 + seed),
            Strategy::Scattering => Independent::new(sample * direct.scattered + i, 78 + seed),
            Strategy::Chain => Independent::new(sample, 79 + seed),
        }
    };
    let mut counts = RayCounts::default();
    trace_visible(view, caster, ray, &settings, layers, numbers, &mut counts);
    assert_eq!((counts.paths, counts.non_finite), (1, 0));
}

/// One sample of the illumination of a vertex's diffuse lobe: paths that arrive like the chain did, of which the first
/// that scatters diffusely at once is taken.
fn illumination(view: &SceneView<'_>, caster: &BruteForce, vertex: &PathOutcome, sample: u32) -> (Vec3, Vec3) {
    let ray = ray_towards(vertex.position - vertex.direction * 2e-5, vertex.direction);
    let mut counts = RayCounts::default();
    for attempt in 0..1000 {
        let mut sampler = Independent::new(sample, 1000 + attempt);
        let path = trace_path(view, caster, &mut sampler, &ray, &SETTINGS, &mut counts);
        if path.has_vertex && path.layer == 0 {
            return (path.direct, path.further);
        }
    }
    panic!("no path scattered diffusely at {vertex:?}");
}

#[test]
fn layers_are_the_picture() {
    for (k, sky) in skies().into_iter().enumerate() {
        let scene = room(sky);
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        let direct = DirectSettings { samples: 1, candidates: 1, scattered: 1 }.for_scene(&view);
        for ray in rays().take(if k == 0 { 5 } else { 2 }) {
            let expected = mean_of_paths(&scene, &ray, &SETTINGS, 4_000);
            for count in [1, 2, 4] {
                let mut layers = [PathOutcome::NONE; 4];
                let pictures = (0..3_000).map(|sample| {
                    layers_of(&view, &caster, &ray, direct, sample, &mut layers[..count]);
                    let light = |vertex: &PathOutcome| {
                        assert!(vertex.further == Vec3::ZERO && vertex.emitted.min_element() >= 0.0);
                        if !vertex.has_vertex || vertex.throughput == Vec3::ZERO {
                            return vertex.emitted;
                        }
                        let (_, further) = illumination(&view, &caster, vertex, sample);
                        vertex.emitted + vertex.throughput * (vertex.direct + further)
                    };
                    layers[..count].iter().map(light).sum()
                });
                let what = format!("sky {k}, {count} layers towards {}", ray.direction);
                let found = Mean::of(pictures);
                found.assert_is(&expected, &what);
                for c in 0..3 {
                    let errors = [found.error[c], expected.error[c]];
                    assert!(
                        errors.iter().all(|error| *error < 0.05 * expected.mean[c]),
                        "{what} must be able to fail: {errors:?}"
                    );
                }
            }
        }
    }
}

/// Two tinted panes between a sky and a lamp: what both reflect, also to each other, is in the layers, however few. The
/// series of reflections has a closed form.
#[test]
fn passed_by_lobes_lose_nothing() {
    let (sky, lamp) = ([3.0_f32, 2.0, 4.0], [1.0_f32, 0.5, 0.25]);
    let colors = [[0.9_f32, 0.6, 0.3], [0.5_f32, 0.7, 0.9]];
    let mut scene = SceneData { environment: Some(Environment::Constant(sky)), ..SceneData::default() };
    let sheet = |height: f32| quad(Vec3::new(-50.0, height, -50.0), 100.0 * Vec3::Z, 100.0 * Vec3::X);
    for (height, color) in [0.0, -1.0].into_iter().zip(colors) {
        add_triangles(&mut scene, &sheet(height), common::mixed::pane(color, 0.0));
    }
    add_triangles(&mut scene, &sheet(-2.0), Material::emissive([0.0; 3], lamp));
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    for cosine in [1.0_f32, 0.5, 0.2] {
        let ray = ray_towards(Vec3::Y, Vec3::new((1.0 - cosine * cosine).sqrt(), -cosine, 0.0));
        let reflected = f64::from(fresnel_dielectric(cosine, 1.5));
        let expected = [0, 1, 2].map(|c| {
            let passed = colors.map(|color| (1.0 - reflected) * f64::from(color[c]));
            let between = 1.0 / (1.0 - reflected * reflected);
            let up = reflected + passed[0] * passed[0] * reflected * between;
            f64::from(sky[c]) * up + f64::from(lamp[c]) * passed[0] * passed[1] * between
        });
        for count in [1, 2, 3, 4, 8] {
            let mut layers = [PathOutcome::NONE; 8];
            let light = (0..20_000).map(|sample| {
                let layers = &mut layers[..count];
                layers_of(&view, &caster, &ray, DirectSettings::NONE, sample, layers);
                // The lamp is black.
                assert!(layers.iter().all(|layer| layer.throughput == Vec3::ZERO));
                layers.iter().map(|layer| layer.emitted).sum()
            });
            let found = Mean::of(light);
            found.assert_is(&Mean::exactly(expected), &format!("{count} layers at {cosine}"));
            assert!((0..3).all(|c| found.error[c] < 0.02 * expected[c]), "must be able to fail: {:?}", found.error);
        }
    }
}

/// Kept vertices give the picture too: emitted + throughput·(direct + further) is the path's light.
#[test]
fn records_are_the_picture() {
    let scene = room(None);
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    for ray in rays() {
        let expected = mean_of_paths(&scene, &ray, &SETTINGS, 4_000);
        for store in [1, 3] {
            let mut counts = RayCounts::default();
            let mut vertices = [PathOutcome::NONE; 3];
            let light = (0..4_000).map(|i| {
                let mut sampler = Independent::new(i, 6);
                let settings = VertexSettings::new(SETTINGS);
                let vertices = &mut vertices[..store];
                trace_path_vertices(&view, &caster, &mut sampler, &ray, &settings, vertices, &mut counts);
                for (k, vertex) in vertices.iter().enumerate() {
                    assert!(!vertex.is_guide && vertex.is_secondary == (k > 0 && vertex.has_vertex));
                    assert!(k == 0 || vertex.emitted == Vec3::ZERO);
                    assert_eq!(vertex.record(0.01, 0).layer(), vertex.layer.min(15));
                }
                vertices[0].radiance()
            });
            Mean::of(light).assert_is(&expected, &format!("{store} kept"));
        }
    }
}

/// A mirror, then a floor: a guide, then the vertex that the mirror shows, with the path's length.
#[test]
fn mirrors_are_guides() {
    let mut scene = SceneData { environment: Some(Environment::Constant([1.0; 3])), ..SceneData::default() };
    let wall = quad(Vec3::new(-5.0, 0.0, -2.0), 10.0 * Vec3::X, 10.0 * Vec3::Y);
    add_triangles(&mut scene, &wall, metal([0.5; 3], 0.0));
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), 10.0 * Vec3::Z, 10.0 * Vec3::X);
    add_triangles(&mut scene, &floor, Material::lambert([0.4; 3]));
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let direct = DirectSettings { samples: 0, candidates: 1, scattered: 1 };
    let ray = ray_towards(Vec3::Y, Vec3::new(0.0, -0.25, -1.0).normalize());
    let length = 17.0_f32.sqrt();
    for count in 1..=4 {
        let mut layers = [PathOutcome::NONE; 4];
        layers_of(&view, &caster, &ray, direct, 0, &mut layers[..count]);
        let records = layers.map(|vertex| vertex.record(0.01, 0));
        let (guide, shown) = if count == 1 { (None, &records[0]) } else { (Some(&records[0]), &records[1]) };
        if let Some(guide) = guide {
            assert_eq!(guide.flags, VertexRecord::GUIDE);
            assert!(guide.shininess() == 1.0 && guide.is_guide() && !guide.is_valid());
            assert!((Vec3::from_slice(&guide.position_footprint[..3]) - Vec3::new(0.0, 0.5, -2.0)).length() < 1e-4);
        }
        assert_eq!(shown.flags, VertexRecord::VALID | VertexRecord::layer_bits(1));
        assert!((shown.normal() - Vec3::Y).length() < 1e-4 && shown.shininess() == 0.0);
        assert!((shown.position_footprint[3] / (0.01 * length) - 1.0).abs() < 1e-4, "{shown:?}");
        assert!((Vec3::from_slice(&shown.throughput[..3]) - Vec3::splat(0.2)).abs().max_element() < 1e-5);
        assert!(layers[2..].iter().all(|layer| *layer == PathOutcome::NONE));
        // Scatterings are counted from the camera.
        let once = VisibleSettings { direct, max_bounces: 1 };
        let numbers = |_, _, i| Independent::new(i, 1);
        trace_visible(&view, &caster, &ray, &once, &mut layers[..count], numbers, &mut RayCounts::default());
        assert!(layers.iter().all(|layer| !layer.has_vertex), "{layers:?}");
    }
}

/// A chain goes on by chance where little is behind it: dielectrics cost a fraction of a ray.
#[test]
fn faint_reflections_are_rare() {
    let mut scene = SceneData { environment: Some(Environment::Constant([1.0; 3])), ..SceneData::default() };
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), 10.0 * Vec3::Z, 10.0 * Vec3::X);
    add_triangles(&mut scene, &floor, common::mixed::plastic([0.5; 3], 0.0));
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let ray = ray_towards(Vec3::Y, Vec3::NEG_Y);
    let settings = VisibleSettings { direct: DirectSettings::NONE, max_bounces: 8 };
    let mut counts = RayCounts::default();
    let n = 4000;
    let reflected = (0..n).map(|i| {
        let mut layers = [PathOutcome::NONE; 2];
        let numbers = |_, _, _| Independent::new(i, 1);
        trace_visible(&view, &caster, &ray, &settings, &mut layers, numbers, &mut counts);
        assert!(layers[0].has_vertex && !layers[0].is_guide);
        layers[1].emitted
    });
    Mean::of(reflected).assert_is(&Mean::exactly([0.04; 3]), "reflected sky");
    let rays = counts.closest as f32 / n as f32;
    assert!((rays - 1.32).abs() < 0.05, "{rays} rays a sample: 0.04 / (1/8) go on");
}

/// Neighbours whose reflection chance passed by are dark, not without one: a filter counts them.
#[test]
fn chains_tell_their_lobe_even_where_chance_ends_them() {
    for (roughness, expected) in [(0.0, 1.0), (0.75, 0.25), (1.0, VertexRecord::LEAST_SHININESS)] {
        for layer_count in [2, 4] {
            let mut scene = SceneData { environment: Some(Environment::Constant([1.0; 3])), ..SceneData::default() };
            let floor = quad(Vec3::new(-5.0, 0.0, -5.0), 10.0 * Vec3::Z, 10.0 * Vec3::X);
            add_triangles(&mut scene, &floor, common::mixed::plastic([0.5; 3], roughness));
            let packed = PackedScene::new(&scene).unwrap();
            let (view, caster) = (packed.view(), BruteForce::new(&scene));
            let mut dark = 0;
            for sample in 0..64 {
                let mut layers = [PathOutcome::NONE; 4];
                let ray = ray_towards(Vec3::Y, Vec3::NEG_Y);
                layers_of(&view, &caster, &ray, DirectSettings::NONE, sample, &mut layers[..layer_count]);
                assert!((layers[0].shininess - expected).abs() < 1e-6, "{roughness}: {}", layers[0].shininess);
                dark += u32::from(layers.iter().skip(1).all(|layer| layer.emitted == Vec3::ZERO));
            }
            assert!((1..64).contains(&dark), "{dark} of 64 chains ended by chance");
        }
    }
}
