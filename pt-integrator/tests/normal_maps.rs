//! Normal maps: their frame on placed, mirrored and mapped triangles, and what never happens.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions")]

mod common;

use common::caster::BruteForce;
use common::mixed::{coated, metal, pane, plastic};
use common::scenes::{add_triangles, quad};
use hashcache_core::geometry::Instance;
use hashcache_core::traits::RayCaster;
use proptest::prelude::*;
use pt_integrator::glam::{Mat3, Quat, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{
    DirectSettings, PathOutcome, PathSettings, RayCounts, VisibleSettings, trace_path, trace_visible,
};
use pt_integrator::ray::ray_towards;
use pt_integrator::sampler::Independent;
use pt_integrator::scene::{Material, Needs, SceneData, Texture, Wrap};
use pt_integrator::surface::Surface;

/// A triangle about the origin in the plane z = 0 that looks to +z; u grows along +x and v along −y, as on a picture.
const CORNERS: [Vec3; 3] = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 0.0), Vec3::new(-1.0, 2.0, 0.0)];

fn uv(p: Vec3) -> [f32; 2] {
    [p.x, -p.y]
}

fn word(rgb: [u8; 3]) -> u32 {
    u32::from_le_bytes([rgb[0], rgb[1], rgb[2], 255])
}

/// The direction that a texel stands for.
fn local(rgb: [u8; 3], scale: f32) -> Vec3 {
    let [x, y, z] = rgb.map(|c| f32::from(c) / 255.0 * 2.0 - 1.0);
    Vec3::new(x * scale, y * scale, z).normalize()
}

fn scene(rgb: [u8; 3], scale: f32) -> SceneData {
    let mut material = Material::lambert([0.5; 3]).textured(Material::NORMAL, 0);
    material.surface[3] = scale;
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &[CORNERS], material);
    scene.triangle_shading[0].uv = CORNERS.map(uv);
    scene.textures = vec![Texture { flags: Texture::LINEAR, ..Texture::new(0, [1, 1], [Wrap::Repeat; 2]) }];
    scene.texels = vec![word(rgb)];
    scene
}

/// The shading normal, and the one without a map, that a ray finds which goes from `from` to the triangle's centre.
fn normals(scene: &SceneData, from: Vec3) -> (Vec3, Vec3) {
    let packed = PackedScene::new(scene).unwrap();
    assert!(packed.needs().contains(Needs::NORMAL_MAPS));
    let target = scene.instances[0].point(Vec3::new(0.1, 0.05, 0.0));
    let ray = ray_towards(from, (target - from).normalize());
    let hit = BruteForce::new(scene).closest(&ray).expect("rays aim at the triangle");
    let surface = Surface::at::<{ Needs::ALL }>(&packed.view(), &hit, ray.direction);
    let plain = Surface::at::<0>(&packed.view(), &hit, ray.direction);
    assert_eq!(surface.smooth_normal, plain.normal);
    (surface.normal, plain.normal)
}

#[test]
fn red_points_along_u_and_green_up_the_picture() {
    for (rgb, scale) in [([255, 128, 200], 1.0), ([128, 255, 200], 1.0), ([40, 90, 250], 0.5), ([128, 128, 255], 9.0)] {
        let (normal, plain) = normals(&scene(rgb, scale), Vec3::new(0.2, 0.3, 5.0));
        assert_eq!(plain, Vec3::Z);
        let expected = local(rgb, scale);
        assert!(normal.distance(expected) < 1e-5, "{rgb:?}: {normal}, not {expected}");
    }
}

#[test]
fn seen_from_behind_it_is_the_same_relief() {
    let (front, _) = normals(&scene([200, 90, 230], 1.0), Vec3::new(0.2, 0.3, 5.0));
    let (back, plain) = normals(&scene([200, 90, 230], 1.0), Vec3::new(0.2, 0.3, -5.0));
    assert_eq!(plain, Vec3::NEG_Z);
    assert!(back.distance(-front) < 1e-6, "{front} {back}");
}

/// Mirrored coordinates mirror the relief: green still points up the picture, not along normal × tangent.
#[test]
fn mirrored_coordinates_keep_their_handedness() {
    let mut mirrored = scene([230, 220, 230], 1.0);
    for uv in &mut mirrored.triangle_shading[0].uv {
        uv[0] = -uv[0];
    }
    let (normal, _) = normals(&mirrored, Vec3::new(0.2, 0.3, 5.0));
    let expected = local([230, 220, 230], 1.0) * Vec3::new(-1.0, 1.0, 1.0);
    assert!(normal.distance(expected) < 1e-5, "{normal}, not {expected}");
}

/// A texture that is turned on its surface takes its relief with it.
#[test]
fn maps_turn_with_their_texture() {
    let mut turned = scene([230, 128, 230], 1.0);
    // u' = v, v' = −u.
    turned.textures[0].uv_rows = [[0.0, 3.0, 0.1, 0.0], [-3.0, 0.0, 0.2, 0.0]];
    let (normal, _) = normals(&turned, Vec3::new(0.2, 0.3, 5.0));
    let [x, y, z] = local([230, 128, 230], 1.0).to_array();
    // Along u' is along v, which is −y; against v' is along u, which is +x.
    let expected = Vec3::new(y, -x, z);
    assert!(normal.distance(expected) < 1e-5, "{normal}, not {expected}");
}

#[test]
fn coordinates_without_an_area_have_no_map() {
    for uv in [[[0.3; 2]; 3], [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], [[0.0, 0.0], [1e30, 0.0], [0.0, 1e30]]] {
        let mut scene = scene([255, 128, 200], 1.0);
        scene.triangle_shading[0].uv = uv;
        let (normal, plain) = normals(&scene, Vec3::new(0.2, 0.3, 5.0));
        assert_eq!(normal, plain, "{uv:?}");
    }
}

/// The clear coat keeps the smooth normal unless it has a map of its own.
#[test]
fn coats_have_their_own_normal() {
    for coat_map in [false, true] {
        let mut scene = scene([220, 128, 230], 1.0);
        scene.materials[0].coat = [1.0, 0.1, 1.0, 0.0];
        if coat_map {
            scene.textures.push(Texture { first_texel: 1, ..scene.textures[0] });
            scene.texels.push(word([128, 40, 230]));
            scene.materials[0].textures[Material::CLEARCOAT_NORMAL] = 1;
        }
        let packed = PackedScene::new(&scene).unwrap();
        let ray = ray_towards(Vec3::new(0.2, 0.3, 5.0), Vec3::NEG_Z);
        let hit = BruteForce::new(&scene).closest(&ray).unwrap();
        let surface = Surface::at::<{ Needs::ALL }>(&packed.view(), &hit, ray.direction);
        let coat = surface.bsdf_inputs(&packed.view()).coat_normal;
        let expected = if coat_map { local([128, 40, 230], 1.0) } else { Vec3::Z };
        assert!(coat.distance(expected) < 1e-5, "{coat}");
        assert!(surface.normal.distance(local([220, 128, 230], 1.0)) < 1e-5);
    }
}

/// A single sheet hides what is behind it, however far its relief leans over, whatever its lobes.
#[test]
fn leaning_normals_let_no_light_through() {
    // About 80° from the surface's normal.
    let leaning = word([253, 128, 150]);
    let opaque = [
        Material::lambert([0.8; 3]),
        plastic([0.8; 3], 0.3),
        metal([0.9; 3], 0.5),
        coated(plastic([0.8; 3], 0.0), 1.0, 0.4),
    ];
    // Nothing but what comes from below.
    let sheet = Material { specular: [0.0; 4], ..pane([0.9; 3], 0.6) };
    for (what, material) in opaque.into_iter().chain([sheet]).enumerate() {
        for place in [Material::NORMAL, Material::CLEARCOAT_NORMAL] {
            let passes = what == 4;
            for height in [-1.0, 1.0] {
                let mut scene = SceneData::default();
                let floor = quad(Vec3::new(-50.0, -50.0, 0.0), 100.0 * Vec3::X, 100.0 * Vec3::Y);
                add_triangles(&mut scene, &floor, material.textured(place, 0));
                for (shading, corners) in scene.triangle_shading.iter_mut().zip(floor) {
                    shading.uv = corners.map(uv);
                }
                scene.textures = vec![Texture { flags: Texture::LINEAR, ..Texture::new(0, [1, 1], [Wrap::Repeat; 2]) }];
                scene.texels = vec![leaning];
                let (corner, a, b) = (Vec3::new(-20.0, -20.0, height), 40.0 * Vec3::X, 40.0 * Vec3::Y);
                let lamp = if height < 0.0 { quad(corner, a, b) } else { quad(corner, b, a) };
                add_triangles(&mut scene, &lamp, Material::emissive([0.0; 3], [1.0; 3]));
                let packed = PackedScene::new(&scene).unwrap();
                let (view, caster) = (packed.view(), BruteForce::new(&scene));
                let ray = ray_towards(Vec3::new(0.3, 0.2, 0.5), Vec3::new(-0.1, 0.05, -1.0).normalize());
                let settings = PathSettings { max_bounces: 1, ..PathSettings::default() };
                let direct = DirectSettings { samples: 2, candidates: 2, scattered: 2 }.for_scene(&view);
                let visible = VisibleSettings { direct, max_bounces: 1 };
                let mut counts = RayCounts::default();
                let mut sums = [Vec3::ZERO; 2];
                for i in 0..512 {
                    sums[0] += trace_path(&view, &caster, &mut Independent::new(i, 1), &ray, &settings, &mut counts)
                        .radiance();
                    let mut layers = [PathOutcome::NONE; 2];
                    let numbers = |strategy, _, j| Independent::new(8 * i + j, 2 + strategy as u32);
                    trace_visible(&view, &caster, &ray, &visible, &mut layers, numbers, &mut counts);
                    sums[1] += layers.iter().map(PathOutcome::radiance).sum::<Vec3>();
                }
                let lit = passes == (height < 0.0);
                for sum in sums {
                    let what = format!("material {what}, map {place}, lamp at {height}: {sum}");
                    assert!(if lit { sum.min_element() > 1.0 } else { sum == Vec3::ZERO }, "{what}");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Turning, mirroring, enlarging and shifting an object does the same to its normals.
    #[test]
    fn placed_objects_take_their_relief_with_them(
        rgb in prop::array::uniform3(60_u8..200),
        axis in prop::array::uniform3(-1.0_f32..1.0),
        angle in 0.0_f32..6.0,
        mirrored in any::<bool>(),
        size in prop::sample::select(vec![1e-4_f32, 1.0, 1e7]),
        coordinate_size in prop::sample::select(vec![1e-6_f32, 1.0, 1e6]),
    ) {
        let axis = Vec3::from_array(axis);
        prop_assume!(axis.length() > 0.1);
        let turn = Mat3::from_quat(Quat::from_axis_angle(axis.normalize(), angle));
        let mirror = Mat3::from_diagonal(Vec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
        let m = turn * mirror;
        let mut plain = scene([rgb[0], rgb[1], 255], 1.0);
        for uv in &mut plain.triangle_shading[0].uv {
            *uv = [uv[0] * coordinate_size, uv[1] * coordinate_size];
        }
        let eye = Vec3::new(0.3, -0.4, 6.0);
        let (before, _) = normals(&plain, eye);
        let shift = Vec3::new(0.3, 0.7, -0.2) * size;
        let row = |r: usize| [m.row(r).x * size, m.row(r).y * size, m.row(r).z * size, shift[r]];
        let mut placed = plain.clone();
        placed.instances[0] = Instance {
            to_scene: [row(0), row(1), row(2)],
            mirrored: u32::from(mirrored),
            ..placed.instances[0]
        };
        let (after, _) = normals(&placed, m * eye * size + shift);
        prop_assert!(after.distance(m * before) < 1e-4, "{after} {}", m * before);
    }

    /// Whatever the map says, the normal has unit length and faces the viewer.
    #[test]
    fn normals_face_the_viewer(
        rgb in any::<[u8; 3]>(),
        scale in prop::sample::select(vec![0.0_f32, 1.0, -3.0, 1e4, 1e30]),
        from in prop::array::uniform3(-1.0_f32..1.0),
        uv in prop::array::uniform3(prop::array::uniform2(prop::num::f32::NORMAL)),
        size in prop::sample::select(vec![1e-4_f32, 1.0, 1e7]),
    ) {
        let from = Vec3::from_array(from);
        prop_assume!(from.z.abs() > 0.01);
        let mut scene = scene(rgb, scale);
        scene.triangle_shading[0].uv = uv;
        scene.instances[0].to_scene =
            [[size, 0.0, 0.0, 0.0], [0.0, size, 0.0, 0.0], [0.0, 0.0, size, 0.0]];
        let target = scene.instances[0].point(Vec3::new(0.1, 0.05, 0.0));
        let outgoing = from.normalize();
        let (normal, _) = normals(&scene, target + outgoing * size * 3.0);
        prop_assert!((normal.length() - 1.0).abs() < 1e-5, "{normal}");
        prop_assert!(normal.dot(outgoing) > 0.0, "{normal} {outgoing}");
    }
}
