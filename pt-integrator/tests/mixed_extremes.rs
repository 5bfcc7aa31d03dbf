//! Lobes at the extremes: any parameters, sizes, light and normals bring finite light, and end.
#![allow(clippy::disallowed_methods, reason = "scenes come from the platform's functions")]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_sphere, add_triangles, inward_box};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use proptest::prelude::*;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{
    DirectSettings, PathOutcome, PathSettings, RayCounts, VertexSettings, VisibleSettings, trace_path,
    trace_path_vertices, trace_visible,
};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::Sobol;
use pt_integrator::scene::{Environment, Material, PunctualLight, SceneData};

/// Mostly the ends of the range.
fn unit() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), Just(1.0), Just(1e-3), 0.0_f32..1.0]
}

prop_compose! {
    fn material()(
        color in [unit(), unit(), unit()],
        [metallic, roughness, transmission, specular] in [unit(), unit(), unit(), unit()],
        [coat, coat_roughness] in [unit(), unit()],
        ior in prop_oneof![Just(1.0_f32), Just(1.5), 1.0_f32..10.0],
        absorption in prop_oneof![Just(0.0_f32), Just(f32::MAX), 1e-6_f32..1e6],
        flags in prop_oneof![Just(0), Just(Material::VOLUME), Just(Material::UNLIT)],
    ) -> Material {
        Material {
            specular: [1.0, 0.5, 2.0, specular],
            interior: [absorption, 0.0, absorption, ior],
            surface: [metallic, roughness, transmission, 1.0],
            coat: [coat, coat_roughness, 1.0, 0.0],
            flags,
            ..Material::lambert(color)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn nothing_is_nan(
        materials in [material(), material()],
        scale in -4_i32..8,
        emission in -12_i32..13,
        normal in prop_oneof![Just(Vec3::Y), Just(Vec3::NEG_Y), Just(Vec3::ZERO), Just(Vec3::new(1.0, 1e-3, 0.0))],
        layers in 1_usize..=8,
        roulette_depth in prop_oneof![Just(1), Just(PathSettings::NO_ROULETTE)],
    ) {
        let size = 10.0_f32.powi(scale);
        let mut scene = SceneData { environment: Some(Environment::Constant([0.5, 0.0, 1.0])), ..SceneData::default() };
        let mut walls = inward_box(-Vec3::splat(size), Vec3::splat(size));
        walls.truncate(11);
        // Two corners in one place.
        walls.push([Vec3::splat(size), Vec3::splat(size), Vec3::ZERO]);
        add_triangles(&mut scene, &walls, materials[0]);
        // Normals that lean anywhere, against their faces too.
        for shading in &mut scene.triangle_shading {
            shading.normals = [octahedral_encode(normal); 3];
        }
        add_sphere(&mut scene, Vec3::splat(0.3 * size), 0.4 * size, 3, true, materials[1]);
        let lamp = inward_box(Vec3::new(-0.5, 0.5, -0.5) * size, Vec3::new(-0.2, 0.4, -0.2) * size);
        add_triangles(&mut scene, &lamp, Material::emissive([0.5; 3], [10.0_f32.powi(emission), 0.0, 1e-12]));
        scene.punctual_lights.push(PunctualLight::point(Vec3::ZERO, [size * size; 3]));
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        let path = PathSettings { max_bounces: 12, roulette_depth };
        let direct = DirectSettings { samples: 1, candidates: 2, scattered: 1 }.for_scene(&view);
        let look = VisibleSettings { direct, max_bounces: 12 };
        let mut counts = RayCounts::default();
        for (i, towards) in (0_u32..).zip([Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8), Vec3::ONE.normalize()]) {
            let ray = ray_towards(Vec3::new(-0.4, -0.3, -0.2) * size, towards);
            for sample in 0..8 {
                let mut found = [PathOutcome::NONE; 12];
                let (first, rest) = found.split_at_mut(1);
                let (kept, shown) = rest.split_at_mut(3);
                let mut sampler = Sobol::new(sample, i);
                first[0] = trace_path(&view, &caster, &mut sampler, &ray, &path, &mut counts);
                let vertices = VertexSettings::new(path);
                trace_path_vertices(&view, &caster, &mut sampler, &ray, &vertices, kept, &mut counts);
                let numbers = |strategy, layer, k| Sobol::new(sample * 2 + k, 8 * layer + strategy as u32);
                let shown = &mut shown[..layers];
                trace_visible(&view, &caster, &ray, &look, shown, numbers, &mut counts);
                for outcome in &found {
                    prop_assert!(outcome.is_finite(), "{outcome:?}");
                    prop_assert!(outcome.direct.min_element() >= 0.0 && outcome.further.min_element() >= 0.0);
                    prop_assert!(outcome.emitted.min_element() >= 0.0 && outcome.throughput.min_element() >= 0.0);
                    prop_assert!((0.0..=1.0).contains(&outcome.shininess));
                    let record = outcome.record(0.01, 0);
                    prop_assert!(record.position_footprint.iter().all(|x| x.is_finite()));
                    prop_assert!(record.flags & VertexRecord::VALID == 0 || record.flags & VertexRecord::GUIDE == 0);
                }
            }
        }
        prop_assert_eq!(counts.non_finite, 0);
    }
}
