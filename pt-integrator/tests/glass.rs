//! Mirrors, panes and solids against closed forms.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions and exact values")]

mod common;

use common::mixed::{Mean, glass, mean_of_paths, metal, pane, paths};
use common::scenes::{add_triangles, quad};
use hashcache_core::pack::octahedral_encode;
use pt_integrator::bsdf::{fresnel_dielectric, schlick_weight};
use pt_integrator::glam::Vec3;
use pt_integrator::path::PathSettings;
use pt_integrator::ray::ray_towards;
use pt_integrator::scene::{Environment, EnvironmentImage, Material, SceneData};

const SETTINGS: PathSettings = PathSettings { max_bounces: 24, roulette_depth: PathSettings::NO_ROULETTE };

/// A large horizontal rectangle at this height, front upwards or downwards.
fn sheet(scene: &mut SceneData, height: f32, up: bool, material: Material) {
    let corner = Vec3::new(-50.0, height, -50.0);
    let (a, b) = (100.0 * Vec3::Z, 100.0 * Vec3::X);
    add_triangles(scene, &if up { quad(corner, a, b) } else { quad(corner, b, a) }, material);
}

fn at_angle(sine: f32) -> Vec3 {
    Vec3::new(sine, -(1.0 - sine * sine).sqrt(), 0.0)
}

/// What a mirror shows is what is seen along the mirrored ray.
#[test]
fn mirror_shows_the_mirrored_view() {
    let texel = |i: u32| [0.1 + (i % 7) as f32, 0.2 + (i % 5) as f32, 0.01 * i as f32, 0.0];
    let sky = EnvironmentImage { width: 16, height: 8, texels: (0..128).map(texel).collect() };
    let mut scene = SceneData { environment: Some(Environment::Image(sky)), ..SceneData::default() };
    sheet(&mut scene, 0.0, true, metal([0.8, 0.6, 0.4], 0.0));
    for sine in [0.0, 0.3, 0.7, 0.95] {
        let down = at_angle(sine);
        let up = Vec3::new(down.x, -down.y, down.z);
        let seen = paths(&scene, &ray_towards(Vec3::Y, down), &SETTINGS, 4);
        let direct = paths(&scene, &ray_towards(Vec3::Y, up), &SETTINGS, 1)[0].emitted;
        for outcome in seen {
            let color = Vec3::new(0.8, 0.6, 0.4);
            let expected = direct * (color + (1.0 - color) * schlick_weight(-down.y));
            assert!((outcome.radiance() - expected).abs().max_element() < 1e-4 * expected.max_element(), "{sine}");
            assert!(!outcome.has_vertex && outcome.throughput == Vec3::ZERO);
        }
    }
}

/// A slab passes (1−F)²·a / (1−F²·a²), a = e^(−σ·d/cos θₜ): all reflections between its faces, with Beer's law.
#[test]
fn slab_passes_what_fresnel_and_beer_say() {
    let absorption = [0.0_f32, 0.7, 5.0];
    for (ior, thickness) in [(1.5_f32, 0.2_f32), (1.1, 1.0), (2.4, 0.05)] {
        let mut scene = SceneData::default();
        let material = glass(ior, 0.0, absorption);
        sheet(&mut scene, 0.0, true, material);
        sheet(&mut scene, -thickness, false, material);
        sheet(&mut scene, -2.0, true, Material::emissive([0.0; 3], [1.0; 3]));
        for sine in [0.0, 0.5, 0.9] {
            let direction = at_angle(sine);
            let inside = (1.0 - (sine / ior) * (sine / ior)).sqrt();
            let fresnel = f64::from(fresnel_dielectric(-direction.y, ior));
            let expected = absorption.map(|sigma| {
                let a = f64::from(-sigma * thickness / inside).exp();
                (1.0 - fresnel).powi(2) * a / (1.0 - (fresnel * a).powi(2))
            });
            let found = mean_of_paths(&scene, &ray_towards(Vec3::Y, direction), &SETTINGS, 20_000);
            found.assert_is(&Mean::exactly(expected), &format!("ior {ior}, sine {sine}"));
        }
    }
}

/// A pane passes (1 − F)·colour straight on.
#[test]
fn pane_passes_straight() {
    let color = [0.9_f32, 0.5, 0.1];
    let mut scene = SceneData::default();
    sheet(&mut scene, 0.0, true, pane(color, 0.0));
    sheet(&mut scene, -2.0, true, Material::emissive([0.0; 3], [1.0; 3]));
    for sine in [0.0, 0.5, 0.9] {
        let direction = at_angle(sine);
        let fresnel = fresnel_dielectric(-direction.y, 1.5);
        let found = mean_of_paths(&scene, &ray_towards(Vec3::Y, direction), &SETTINGS, 20_000);
        found.assert_is(&Mean::exactly(color.map(|c| f64::from(c * (1.0 - fresnel)))), &format!("{sine}"));
    }
}

/// From inside of a solid: beyond the critical angle all is reflected; below it, radiance from outside comes n² times
/// as dense, less Fresnel's part.
#[test]
fn looking_out_of_a_solid() {
    let ior = 1.5_f32;
    let mut scene = SceneData::default();
    sheet(&mut scene, 0.0, true, glass(ior, 0.0, [0.0, 0.5, 0.0]));
    sheet(&mut scene, 3.0, false, Material::emissive([0.0; 3], [1.0, 1.0, 0.0]));
    sheet(&mut scene, -3.0, true, Material::emissive([0.0; 3], [0.0, 0.0, 4.0]));
    for sine in [0.0_f32, 0.5, 0.66, 0.67, 0.9] {
        let direction = -at_angle(sine);
        let fresnel = f64::from(fresnel_dielectric(direction.y, 1.0 / ior));
        assert_eq!(sine > 1.0 / ior, fresnel >= 1.0);
        let ray = ray_towards(Vec3::NEG_Y, direction);
        let way = f64::from(1.0 / direction.y);
        let passed = (1.0 - fresnel) * f64::from(ior * ior);
        // What goes down has no end inside of the solid that would say so, but it started there.
        let expected = [passed, passed * (-0.5 * way).exp(), fresnel * 4.0];
        mean_of_paths(&scene, &ray, &SETTINGS, 20_000).assert_is(&Mean::exactly(expected), &format!("{sine}"));
    }
}

/// A shading normal that leans so far that mirrored rays go through the face shows what is inside, as dense as light
/// from there is: all that comes from below is divided by the squared index.
#[test]
fn reflections_through_the_face_are_of_the_other_side() {
    let ior = 1.5_f32;
    for roughness in [0.0, 0.2] {
        let mut scene = SceneData::default();
        sheet(&mut scene, 0.0, true, glass(ior, roughness, [0.0; 3]));
        let leaning = octahedral_encode(Vec3::new(0.204_f32.sin(), 0.204_f32.cos(), 0.0));
        for shading in &mut scene.triangle_shading {
            shading.normals = [leaning; 3];
        }
        sheet(&mut scene, -0.1, true, Material::emissive([0.0; 3], [1.0; 3]));
        let ray = ray_towards(Vec3::Y, Vec3::new(0.91_f32.sqrt(), -0.3, 0.0));
        let found = mean_of_paths(&scene, &ray, &SETTINGS, 20_000);
        let most = f64::from(1.0 / (ior * ior));
        if roughness == 0.0 {
            found.assert_is(&Mean::exactly([most; 3]), "mirrored and bent");
        } else {
            assert!((0.5 * most..most).contains(&found.mean[0]), "{}", found.mean[0]);
        }
    }
}

/// What lies on the ground of absorbing water is seen through it twice: on the way of the light and of the view.
#[test]
fn ground_under_water() {
    let (sigma, depth) = (0.8_f32, 0.5_f32);
    let mut scene = SceneData { environment: Some(Environment::Constant([1.0; 3])), ..SceneData::default() };
    // Without refraction, so that the closed form is one integral: light leaves by 2·E₃(σd) of the hemisphere.
    sheet(&mut scene, 0.0, true, Material { specular: [0.0; 4], ..glass(1.0, 0.0, [sigma, 0.0, 0.0]) });
    sheet(&mut scene, -depth, true, Material::lambert([0.5; 3]));
    let found = mean_of_paths(&scene, &ray_towards(Vec3::Y, Vec3::NEG_Y), &SETTINGS, 40_000);
    // ∫ 2μ e^(−σd/μ) dμ over [0, 1].
    let steps = 100_000;
    let up: f64 = (0..steps)
        .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
        .map(|mu| 2.0 * mu * (-f64::from(sigma * depth) / mu).exp() / f64::from(steps))
        .sum();
    let expected = 0.5 * up * (-f64::from(sigma * depth)).exp();
    found.assert_is(&Mean::exactly([expected, 0.5, 0.5]), "water");
}
