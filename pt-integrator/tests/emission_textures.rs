//! Emitters with textures: densities, what is sampled and what is seen agree, and black parts are no lights.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions")]

mod common;

use common::caster::BruteForce;
use common::chi2;
use common::scenes::{add_triangles, quad};
use hashcache_core::geometry::Instance;
use hashcache_core::traits::{RayCaster, Sampler};
use proptest::prelude::*;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::light::{pick_alias, sample_light};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts, trace_path};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::{Independent, Sobol};
use pt_integrator::scene::{Material, NONE, Needs, SceneData, Texture, Wrap};
use pt_integrator::surface::Surface;
use pt_integrator::texture::sample_texture;

const ALL: u32 = Needs::ALL;

/// A lamp of one square metre at y = 1 that shines down, with texture coordinates from 0 to `repeat`.
fn lamp(texels: Vec<u32>, side: u32, repeat: f32, flags: u32) -> SceneData {
    let mut scene = SceneData { texels, ..SceneData::default() };
    scene.textures = vec![Texture::new(0, [side, side], [Wrap::Repeat, Wrap::Mirror])];
    let triangles = quad(Vec3::new(-0.5, 1.0, -0.5), Vec3::X, Vec3::Z);
    let material = Material { flags, ..Material::emissive([0.0; 3], [3.0, 2.0, 1.0]) };
    add_triangles(&mut scene, &triangles, material.textured(Material::EMISSION, 0));
    for (shading, corners) in scene.triangle_shading.iter_mut().zip(&triangles) {
        shading.uv = corners.map(|p| [(p.x + 0.5) * repeat, (p.z + 0.5) * repeat]);
    }
    scene
}

/// Unlike shades, a third of them black.
fn picture(side: u32) -> Vec<u32> {
    (0..side * side).map(|i| if i % 3 == 0 { 0xff00_0000 } else { i.wrapping_mul(0x0123_4567) | 0xff00_0000 }).collect()
}

#[test]
fn densities_add_up_to_one() {
    for repeat in [0.4, 1.0, 3.7] {
        let mut scene = lamp(picture(8), 8, repeat, 0);
        // A second one, twice as large in both directions, and one without a texture.
        scene.instances.push(Instance {
            to_scene: [[2.0, 0.0, 0.0, 4.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]],
            ..scene.instances[0]
        });
        let plain = quad(Vec3::new(5.0, 1.0, -0.5), Vec3::X, Vec3::Z);
        add_triangles(&mut scene, &plain, Material::emissive([0.0; 3], [1.0; 3]));
        let packed = PackedScene::new(&scene).unwrap();
        let view = packed.view();
        assert_eq!((view.lights.len(), view.emitters), (6, &[0, 1, 0, 1, 2, 3][..]));
        let areas = [0.5, 0.5, 2.0, 2.0, 0.5, 0.5];
        let total: f32 = view.lights.iter().zip(areas).map(|(light, area)| light.edge1[3] * area).sum();
        assert!((total - 1.0).abs() < 1e-5, "{total}");
        // And the alias table chooses each as often as its density says.
        let mut counts = [0; 6];
        let samples = 100_000_u32;
        for i in 0..samples {
            counts[pick_alias(view.alias, Independent::new(i, 9).next_2d()) as usize] += 1;
        }
        let expected: Vec<f64> = view
            .lights
            .iter()
            .zip(areas)
            .map(|(light, area)| f64::from(light.edge1[3] * area) * f64::from(samples))
            .collect();
        chi2::check("textured lights", &counts, &expected);
    }
}

/// What next event states for a point is what a ray finds that hits the point.
#[test]
fn sampled_points_are_seen_as_sampled() {
    for (flags, below) in [(0, true), (Material::DOUBLE_SIDED, true), (Material::DOUBLE_SIDED, false)] {
        let mut scene = lamp(picture(8), 8, 1.7, flags);
        let turned = Instance {
            to_scene: [[-1.0, 0.0, 0.0, 3.0], [0.0, 1.5, 0.2, 0.0], [0.0, 0.0, 1.0, 0.4]],
            mirrored: 1,
            ..scene.instances[0]
        };
        scene.instances.push(turned);
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        let from = Vec3::new(0.7, if below { -0.2 } else { 2.6 }, 0.1);
        let (mut found, mut black) = (0, 0);
        for i in 0..4000 {
            let Some(sample) = sample_light::<ALL>(&view, &mut Independent::new(i, 5), from) else {
                black += 1;
                continue;
            };
            let Some(hit) = caster.closest(&ray_towards(from, sample.direction)) else { continue };
            let surface = Surface::at::<ALL>(&view, &hit, sample.direction);
            let emitted = surface.emission::<ALL>(&view);
            assert!(emitted.distance(sample.radiance) < 1e-3, "{emitted} {}", sample.radiance);
            let density = surface.light_density::<ALL>(&view, emitted);
            let pdf = density * hit.t * hit.t / surface.face.dot(sample.direction).abs();
            assert!((pdf / sample.pdf - 1.0).abs() < 1e-3, "{pdf} {}", sample.pdf);
            found += 1;
        }
        assert!(found > 2000 && black < 1500, "{found} {black}");
    }
}

/// A floor below a textured lamp against a quadrature over the lamp's texture.
#[test]
fn floor_below_a_textured_lamp() {
    const N: u32 = 400;
    for (side, repeat) in [(4, 1.0), (8, 2.3)] {
        let mut scene = lamp(picture(side), side, repeat, 0);
        let floor = quad(Vec3::new(-9.0, 0.0, -9.0), 18.0 * Vec3::Z, 18.0 * Vec3::X);
        add_triangles(&mut scene, &floor, Material::lambert([0.5; 3]));
        let point = Vec3::new(0.1, 0.0, 0.2);
        let mut expected = Vec3::ZERO;
        for i in 0..N * N {
            let at = (Vec2::new((i % N) as f32, (i / N) as f32) + 0.5) / N as f32;
            let to = Vec3::new(at.x - 0.5, 1.0, at.y - 0.5) - point;
            let radiance = Vec3::new(3.0, 2.0, 1.0) * sample_texture(&scene.textures[0], &scene.texels, at * repeat);
            let squared = to.length_squared();
            expected += radiance * (0.5 / std::f32::consts::PI / squared / squared / (N * N) as f32);
        }
        let packed = PackedScene::new(&scene).unwrap();
        let (view, caster) = (packed.view(), BruteForce::new(&scene));
        let ray = ray_towards(point + 0.1 * Vec3::Y, Vec3::NEG_Y);
        let settings = PathSettings { max_bounces: 1, ..PathSettings::default() };
        let mut counts = RayCounts::default();
        let samples = 1 << 15;
        let sum: Vec3 = (0..samples)
            .map(|i| trace_path(&view, &caster, &mut Sobol::new(i, 8), &ray, &settings, &mut counts).radiance())
            .sum();
        let mean = sum / samples as f32;
        assert!((mean / expected - 1.0).abs().max_element() < 0.005, "{mean}, not {expected}");
    }
}

#[test]
fn black_textures_emit_nothing() {
    let scene = lamp(vec![0xff00_0000; 16], 4, 1.0, 0);
    let packed = PackedScene::new(&scene).unwrap();
    let needs = Needs::from_bits(packed.needs().bits());
    assert!(!needs.contains(Needs::TRIANGLE_LIGHTS) && packed.view().lights.is_empty());
}

/// Of a mesh whose texture is lit in one corner only the triangles there are lights; shading normals stay.
#[test]
fn only_lit_parts_are_lights() {
    let side = 64;
    let texels = (0..side * side).map(|i| if i % side < 8 && i / side < 8 { u32::MAX } else { 0 }).collect();
    let mut scene = SceneData { texels, ..SceneData::default() };
    scene.textures = vec![Texture::new(0, [side, side], [Wrap::Clamp; 2])];
    let mut triangles = Vec::new();
    for i in 0..16 {
        for j in 0..16 {
            triangles.extend(quad(Vec3::new(i as f32, 0.0, j as f32), Vec3::Z, Vec3::X));
        }
    }
    let material = Material::emissive([0.5; 3], [1.0; 3]).textured(Material::EMISSION, 0);
    add_triangles(&mut scene, &triangles, material);
    let code = hashcache_core::pack::octahedral_encode(Vec3::new(0.1, 1.0, 0.0));
    for (shading, corners) in scene.triangle_shading.iter_mut().zip(&triangles) {
        shading.uv = corners.map(|p| [p.x / 16.0, p.z / 16.0]);
        shading.normals = [code; 3];
    }
    let packed = PackedScene::new(&scene).unwrap();
    let view = packed.view();
    // Two of sixteen squares in each direction are lit, and a neighbour's filter may reach in.
    assert!((2 * 4..=2 * 16).contains(&view.lights.len()), "{}", view.lights.len());
    let lit = |p: &[Vec3; 3]| p.iter().all(|p| p.x <= 2.0 && p.z <= 2.0);
    for (triangle, corners) in view.triangles.iter().zip(&triangles) {
        assert!(!lit(corners) || triangle.emitter != NONE);
        assert_eq!(triangle.vertices[0].normal, code);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Wherever a triangle shines, next event may choose it, whatever its coordinates and its map.
    #[test]
    fn nothing_that_shines_is_left_out(
        uv in prop::array::uniform3(prop::array::uniform2(prop_oneof![-3.0_f32..3.0, -1e9_f32..1e9])),
        lit in 0_u32..64,
        wraps in 0_u32..16,
        rows in prop::array::uniform2(prop::array::uniform4(-2.0_f32..2.0)),
        emission in prop::sample::select(vec![1e-12_f32, 1.0, 1e12]),
        u in prop::array::uniform2(0.0_f32..1.0),
    ) {
        let mut texels = vec![0; 64];
        texels[lit as usize] = 0x0001_0000;
        let mut scene = lamp(texels, 8, 1.0, 0);
        scene.textures[0].flags = wraps;
        scene.textures[0].uv_rows = rows;
        scene.materials[0].emission = [emission, emission, emission, 0.0];
        scene.triangle_shading[0].uv = uv;
        let packed = PackedScene::new(&scene).unwrap();
        let view = packed.view();
        let [a, b, c] = uv.map(Vec2::from_array);
        let (s, t) = if u[0] + u[1] < 1.0 { (u[0], u[1]) } else { (1.0 - u[0], 1.0 - u[1]) };
        let shown = sample_texture(&scene.textures[0], &scene.texels, a * (1.0 - s - t) + b * s + c * t);
        if shown != Vec3::ZERO {
            prop_assert!(view.triangles[0].emitter != NONE);
            let light = view.lights[(view.instances[0].first_light + view.triangles[0].emitter) as usize];
            prop_assert!(light.edge1[3] > 0.0 && light.edge1[3].is_finite());
        }
    }
}
