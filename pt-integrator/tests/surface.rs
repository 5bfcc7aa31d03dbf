//! Surfaces of placed meshes against the same meshes modelled in place.

mod common;

use common::caster::BruteForce;
use common::scenes::add_sphere;
use hashcache_core::geometry::Instance;
use hashcache_core::pack::octahedral_encode;
use hashcache_core::traits::RayCaster;
use proptest::prelude::*;
use pt_integrator::glam::{Mat3, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::ray::ray_towards;
use pt_integrator::scene::{Material, Needs, SceneData};
use pt_integrator::surface::Surface;

fn ball() -> SceneData {
    let mut scene = SceneData::default();
    add_sphere(&mut scene, Vec3::new(0.2, 0.0, 0.1), 1.0, 8, true, Material::lambert([0.5; 3]));
    scene
}

/// The ball with its map applied to corners and normals; a mirroring map turns the winding round.
fn baked(m: Mat3, shift: Vec3) -> SceneData {
    let mut scene = ball();
    let first = scene.positions.clone();
    for p in &mut scene.positions {
        *p = (m * Vec3::from_array(*p) + shift).to_array();
    }
    let of_normals = m.inverse().transpose();
    for (triangle, shading) in scene.indices.iter_mut().zip(&mut scene.triangle_shading) {
        for (vertex, normal) in triangle.iter().zip(&mut shading.normals) {
            let outward = Vec3::from_array(first[*vertex as usize]) - Vec3::new(0.2, 0.0, 0.1);
            *normal = octahedral_encode(of_normals * outward);
        }
        if m.determinant() < 0.0 {
            triangle.swap(1, 2);
            shading.normals.swap(1, 2);
        }
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn instances_are_what_they_would_be_in_place(
        rows in prop::array::uniform3(prop::array::uniform3(-2.0_f32..2.0)),
        shift in prop::array::uniform3(-5.0_f32..5.0),
        towards in prop::array::uniform3(-0.5_f32..0.5),
    ) {
        let m = Mat3::from_cols_array_2d(&rows);
        prop_assume!(m.determinant().abs() > 0.3);
        let shift = Vec3::from_array(shift);
        let mut placed = ball();
        let row = |r: usize| [m.row(r).x, m.row(r).y, m.row(r).z, shift[r]];
        placed.instances[0] = Instance {
            to_scene: [row(0), row(1), row(2)],
            mirrored: u32::from(m.determinant() < 0.0),
            ..placed.instances[0]
        };
        let baked = baked(m, shift);
        let (packed, in_place) = (PackedScene::new(&placed).unwrap(), PackedScene::new(&baked).unwrap());
        let eye = shift + Vec3::new(9.0, 8.0, 7.0);
        let target = shift + m * (Vec3::new(0.2, 0.0, 0.1) + Vec3::from_array(towards));
        // From outside, and on from the middle: both sides of the faces.
        for ray in [ray_towards(eye, (target - eye).normalize()), ray_towards(target, (eye - target).normalize())] {
            let hit = BruteForce::new(&placed).closest(&ray);
            let other = BruteForce::new(&baked).closest(&ray);
            let (Some(hit), Some(other)) = (hit, other) else {
                return Err(TestCaseError::reject("between two triangles"));
            };
            prop_assume!(hit.triangle == other.triangle);
            let a = Surface::at::<{ Needs::ALL }>(&packed.view(), &hit, ray.direction);
            let b = Surface::at::<{ Needs::ALL }>(&in_place.view(), &other, ray.direction);
            prop_assert!(a.position.distance(b.position) < 1e-3);
            prop_assert!(a.face.distance(b.face) < 1e-2, "{:?} {:?}", a.face, b.face);
            prop_assert!(a.normal.distance(b.normal) < 1e-2 || a.normal.dot(ray.direction).abs() < 1e-2);
            prop_assert_eq!(a.from_front, b.from_front);
            prop_assert!(a.normal.dot(ray.direction) <= 0.0);
            prop_assert!((a.normal.length() - 1.0).abs() < 1e-5 && (a.face.length() - 1.0).abs() < 1e-5);
        }
    }
}
