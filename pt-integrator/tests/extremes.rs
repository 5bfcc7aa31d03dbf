//! Scenes of any size, anywhere, with hostile numbers: nothing panics, nothing is NaN, nothing leaks.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_triangles, inward_box, quad};
use hashcache_core::geometry::Instance;
use proptest::prelude::*;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathOutcome, PathSettings, RayCounts, trace_path};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::Sobol;
use pt_integrator::scene::{
    Camera, CameraError, Environment, EnvironmentImage, Material, PunctualLight, SceneData, SceneError, Texture, Wrap,
};
use pt_integrator::texture::{SRGB_TO_LINEAR, sample_texture};

fn trace(scene: &SceneData, from: Vec3, samples: u32, settings: PathSettings) -> (Vec<PathOutcome>, RayCounts) {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let mut counts = RayCounts::default();
    let outcomes = (0..samples)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let direction = Vec3::new(angle.cos(), (i as f32 * 0.37).sin(), angle.sin()).normalize();
            let ray = ray_towards(from, direction);
            trace_path(&view, &caster, &mut Sobol::new(i, 3), &ray, &settings, &mut counts)
        })
        .collect();
    (outcomes, counts)
}

/// A closed, evenly emitting room of any size and place: no ray may leave it, so all light is found. Far from the
/// origin the room must be some thousand offsets large.
#[test]
fn rooms_of_any_size_do_not_leak() {
    for (size, offset) in
        [(1e-4_f32, 0.0_f32), (1.0, 0.0), (1e7, 0.0), (1.0, 10.0), (1e-4, 1e-3), (1e5, 1e6), (1e3, -3e4)]
    {
        let corner = Vec3::new(offset, -0.7 * offset, 0.3 * offset);
        let mut scene = SceneData::default();
        let walls = inward_box(corner, corner + Vec3::new(size, 0.8 * size, 1.1 * size));
        add_triangles(&mut scene, &walls, Material::emissive([0.5; 3], [1.0; 3]));
        let settings = PathSettings { max_bounces: 3, ..PathSettings::default() };
        let (outcomes, counts) = trace(&scene, corner + 0.4 * size, 4096, settings);
        assert_eq!(counts.non_finite, 0);
        // The hit caster of these tests is not watertight: a ray along an edge may escape, one in a thousand.
        assert!(counts.closest >= 4 * 4096 * 999 / 1000, "{size} at {offset}: {} rays", counts.closest);
        let mean = outcomes.iter().map(|o| f64::from(o.radiance().x)).sum::<f64>() / 4096.0;
        assert!((mean / 1.875 - 1.0).abs() < 0.02, "{size} at {offset}: {mean}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn nothing_is_nan(
        scale in -4_i32..8,
        emission in -12_i32..13,
        albedo in 0.0_f32..1.0,
        normals in prop::array::uniform3(any::<u32>()),
        mirrored: bool,
        inside in 0.0_f32..1.0,
    ) {
        let size = 10.0_f32.powi(scale);
        let mut scene = SceneData::default();
        add_triangles(&mut scene, &inward_box(-Vec3::splat(size), Vec3::splat(size)), Material::lambert([albedo, 1.0, 0.0]));
        let lamp = Vec3::splat(0.25 * size);
        let mut triangles = inward_box(-lamp, lamp);
        // No area, in three ways.
        triangles.push([lamp; 3]);
        triangles.push([lamp, lamp * 1.1, lamp * 1.2]);
        triangles.push([Vec3::ZERO; 3]);
        add_triangles(&mut scene, &triangles, Material::emissive([albedo; 3], [10.0_f32.powi(emission), 0.0, 1e-12]));
        for shading in &mut scene.triangle_shading {
            shading.normals = normals;
        }
        if mirrored {
            scene.instances[0] = Instance {
                to_scene: [[-1.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.1, 0.0], [0.0, 0.0, 1.0, 0.0]],
                mirrored: 1,
                ..scene.instances[0]
            };
        }
        // From inside of the lamp to outside.
        let (outcomes, counts) = trace(&scene, Vec3::splat(inside * size * 0.9), 64, PathSettings::default());
        prop_assert_eq!(counts.non_finite, 0);
        for outcome in outcomes {
            prop_assert!(outcome.is_finite());
            prop_assert!(outcome.direct.min_element() >= 0.0 && outcome.further.min_element() >= 0.0);
            let record = outcome.record(1e-3, 0);
            prop_assert!(record.position_footprint.iter().chain(&record.direct).all(|x| x.is_finite()));
        }
    }

    #[test]
    fn textures_take_any_coordinate(u: f32, v: f32, width in 1_u32..9, height in 1_u32..9, wrap in 0_u32..16) {
        let texels: Vec<u32> = (0..width * height).map(|i| i.wrapping_mul(0x0103_0507)).collect();
        let texture = Texture { first_texel: 0, width, height, flags: wrap, uv_rows: Texture::IDENTITY };
        let color = sample_texture(&texture, &texels, Vec2::new(u, v));
        if u.is_finite() && v.is_finite() {
            prop_assert!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0);
        }
    }
}

/// More light than numbers can hold is dropped and counted, and the vertex stays.
#[test]
fn overflow_is_counted() {
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), Material::emissive([1.0; 3], [1e38; 3]));
    let (outcomes, counts) = trace(&scene, Vec3::ZERO, 64, PathSettings::default());
    assert_eq!(counts.non_finite, 64);
    assert!(outcomes.iter().all(|o| o.has_vertex && o.radiance() == Vec3::ZERO));
}

#[test]
fn wraps_and_centres() {
    // Two texels: black, white.
    let texels = [0, 0x00ff_ffff];
    let at = |wrap, u| {
        let texture = Texture::new(0, [2, 1], [wrap; 2]);
        sample_texture(&texture, &texels, Vec2::new(u, 0.3)).x
    };
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        assert_eq!([at(wrap, 0.25), at(wrap, 0.5), at(wrap, 0.75)], [0.0, 0.5, 1.0]);
    }
    assert_eq!([at(Wrap::Repeat, 1.25), at(Wrap::Repeat, -0.25), at(Wrap::Repeat, 0.0)], [0.0, 1.0, 0.5]);
    assert_eq!([at(Wrap::Clamp, 1.25), at(Wrap::Clamp, -0.25), at(Wrap::Clamp, 0.0)], [1.0, 0.0, 0.0]);
    assert_eq!([at(Wrap::Mirror, 1.25), at(Wrap::Mirror, -0.25), at(Wrap::Mirror, 2.25)], [1.0, 0.0, 0.0]);
}

#[test]
fn srgb_table_is_its_formula() {
    for (code, linear) in SRGB_TO_LINEAR.iter().enumerate() {
        let x = code as f64 / 255.0;
        let expected = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
        assert!((f64::from(*linear) - expected).abs() <= expected * 6e-8, "{code}");
    }
}

#[test]
fn cameras_that_cannot_be() {
    let look = |from, to, up, fov, w, h| Camera::look_at(from, to, up, fov, w, h).unwrap_err();
    let (o, z, y) = (Vec3::ZERO, Vec3::Z, Vec3::Y);
    assert_eq!(look(o, o, y, 1.0, 8, 8), CameraError::Degenerate);
    assert_eq!(look(o, z, z, 1.0, 8, 8), CameraError::Degenerate);
    assert_eq!(look(o, z, Vec3::NAN, 1.0, 8, 8), CameraError::NotFinite);
    assert_eq!(look(o, z, y, 0.0, 8, 8), CameraError::FieldOfView);
    assert_eq!(look(o, z, y, 3.2, 8, 8), CameraError::FieldOfView);
    assert_eq!(look(o, z, y, 1.0, 0, 8), CameraError::Size);
    assert_eq!(look(o, z, y, 1.0, 1 << 16, 1 << 16), CameraError::Size);
}

#[test]
fn scenes_that_cannot_be() {
    let good = || {
        let mut scene = SceneData::default();
        add_triangles(&mut scene, &quad(Vec3::ZERO, Vec3::X, Vec3::Y), Material::lambert([0.5; 3]));
        scene
    };
    assert!(PackedScene::new(&good()).is_ok());
    let error = |change: fn(&mut SceneData)| {
        let mut scene = good();
        change(&mut scene);
        PackedScene::new(&scene).unwrap_err()
    };
    assert_eq!(error(|s| s.indices[1][2] = 9), SceneError::Index { at: "triangle", element: 1, index: 9, length: 6 });
    assert!(matches!(error(|s| s.positions[3][0] = f32::NAN), SceneError::Number { at: "vertex", element: 3 }));
    assert!(matches!(error(|s| s.meshes[0].triangle_count = u32::MAX), SceneError::Index { at: "mesh", .. }));
    assert!(matches!(error(|s| s.instances[0].mesh = 1), SceneError::Index { at: "instance", .. }));
    assert!(matches!(error(|s| s.materials[0].emission[0] = -1.0), SceneError::Number { at: "material", .. }));
    assert!(matches!(error(|s| s.materials[0].textures[Material::BASE_COLOR] = 0), SceneError::Index { .. }));
    assert!(matches!(error(|s| s.triangle_shading.truncate(1)), SceneError::Length { .. }));
    for change in [
        |m: &mut Material| m.interior[0] = f32::INFINITY,
        |m: &mut Material| m.interior[3] = -1.5,
        |m: &mut Material| m.surface[1] = f32::NAN,
        |m: &mut Material| m.surface[3] = f32::INFINITY,
        |m: &mut Material| m.specular[3] = -0.1,
        |m: &mut Material| m.coat[0] = f32::NAN,
        |m: &mut Material| m.base_color[3] = -1.0,
    ] {
        let mut scene = good();
        change(&mut scene.materials[0]);
        assert!(matches!(PackedScene::new(&scene), Err(SceneError::Number { at: "material", element: 0 })));
    }
    for place in 0..12 {
        let mut scene = good();
        scene.materials[0].textures[place] = 3;
        assert!(matches!(PackedScene::new(&scene), Err(SceneError::Index { index: 3, .. })));
    }
    let light = PunctualLight::spot(Vec3::ONE, Vec3::Y, [1.0; 3], [0.9, 0.8]);
    for change in [
        |l: &mut PunctualLight| l.position[1] = f32::NAN,
        |l: &mut PunctualLight| l.position[3] = 7.0,
        |l: &mut PunctualLight| l.direction[0] = 1.0,
        |l: &mut PunctualLight| l.direction[3] = 1.5,
        |l: &mut PunctualLight| l.intensity[2] = -1.0,
        |l: &mut PunctualLight| l.intensity[3] = f32::NAN,
        |l: &mut PunctualLight| l.range[0] = -1.0,
    ] {
        let mut scene = good();
        scene.punctual_lights = vec![light, light];
        assert!(PackedScene::new(&scene).is_ok());
        change(&mut scene.punctual_lights[1]);
        assert!(matches!(PackedScene::new(&scene), Err(SceneError::Number { at: "punctual light", element: 1 })));
    }
    assert!(matches!(error(|s| s.environment_rotation = f32::NAN), SceneError::Number { .. }));
    assert!(matches!(error(|s| s.uv2 = vec![[[0.0; 2]; 3]; 1]), SceneError::Length { .. }));
    assert!(matches!(error(|s| s.uv2 = vec![[[f32::NAN; 2]; 3]; 2]), SceneError::Number { .. }));
    let texture = Texture { uv_rows: [[f32::NAN; 4]; 2], ..Texture::new(0, [1, 1], [Wrap::Repeat; 2]) };
    let mut scene = SceneData { textures: vec![texture], texels: vec![0], ..good() };
    assert!(matches!(PackedScene::new(&scene), Err(SceneError::Number { at: "texture", .. })));
    scene.textures[0] = Texture::new(u32::MAX, [2, 2], [Wrap::Repeat; 2]);
    assert!(matches!(PackedScene::new(&scene), Err(SceneError::Index { at: "texture", .. })));
    let image = EnvironmentImage { width: 4, height: 2, texels: vec![[0.0; 4]; 7] };
    let mut scene = good();
    scene.environment = Some(Environment::Image(image));
    assert!(matches!(PackedScene::new(&scene), Err(SceneError::Length { .. })));
}
