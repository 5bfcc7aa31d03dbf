//! What textures show: encodings, channels, transforms, both sets of coordinates.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_triangles, quad};
use hashcache_core::traits::RayCaster;
use proptest::prelude::*;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::ray::ray_towards;
use pt_integrator::scene::{Lobes, Material, Needs, SceneData, Texture, Wrap};
use pt_integrator::surface::Surface;
use pt_integrator::texture::{decode, sample_alpha, sample_texture};

fn picture(width: u32, height: u32) -> Vec<u32> {
    (0..width * height).map(|i| i.wrapping_mul(0x9e37_79b9) ^ (i << 7)).collect()
}

#[test]
fn encodings_and_channels() {
    let texel = 0x40_ff_80_33_u32;
    let encoded = Texture::new(0, [1, 1], [Wrap::Repeat; 2]);
    let linear = Texture { flags: Texture::LINEAR, ..encoded };
    for uv in [Vec2::ZERO, Vec2::splat(0.3), Vec2::new(-7.9, 12.0)] {
        assert!(sample_texture(&encoded, &[texel], uv).distance(decode(texel)) < 1e-6);
        let expected = Vec3::new(51.0, 128.0, 255.0) / 255.0;
        assert!(sample_texture(&linear, &[texel], uv).distance(expected) < 1e-6);
        assert!((sample_alpha(&encoded, &[texel], uv) - 64.0 / 255.0).abs() < 1e-6);
    }
}

/// `KHR_texture_transform`: translation · rotation · scale.
fn rows(offset: Vec2, rotation: f32, scale: Vec2) -> [[f32; 4]; 2] {
    let (s, c) = rotation.sin_cos();
    [[c * scale.x, s * scale.y, offset.x, 0.0], [-s * scale.x, c * scale.y, offset.y, 0.0]]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// A transformed texture shows at uv what the plain one shows at the transformed uv.
    #[test]
    fn transforms_map_coordinates(
        uv in prop::array::uniform2(-4.0_f32..4.0),
        offset in prop::array::uniform2(-2.0_f32..2.0),
        rotation in -7.0_f32..7.0,
        scale in prop::array::uniform2(-3.0_f32..3.0),
        linear in any::<bool>(),
        wrap in prop::sample::select(vec![Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]),
    ) {
        let texels = picture(5, 3);
        let (uv, offset, scale) = (Vec2::from_array(uv), Vec2::from_array(offset), Vec2::from_array(scale));
        let mut plain = Texture::new(0, [5, 3], [wrap, Wrap::Repeat]);
        plain.flags |= if linear { Texture::LINEAR } else { 0 };
        let mapped = Texture { uv_rows: rows(offset, rotation, scale), ..plain };
        let [x, y] = mapped.uv_rows;
        let there = Vec2::new(x[0] * uv.x + x[1] * uv.y + x[2], y[0] * uv.x + y[1] * uv.y + y[2]);
        prop_assert_eq!(sample_texture(&mapped, &texels, uv), sample_texture(&plain, &texels, there));
        prop_assert_eq!(sample_alpha(&mapped, &texels, uv), sample_alpha(&plain, &texels, there));
    }

    /// Any coordinates and any map show a colour between the texels'.
    #[test]
    fn colours_stay_between_the_texels(
        uv in prop::array::uniform2(any::<f32>()),
        rows in prop::array::uniform2(prop::array::uniform4(any::<f32>())),
        flags in 0_u32..32,
    ) {
        let texels = picture(4, 4);
        let texture = Texture { flags, uv_rows: rows, ..Texture::new(0, [4, 4], [Wrap::Repeat; 2]) };
        let color = sample_texture(&texture, &texels, Vec2::from_array(uv));
        let alpha = sample_alpha(&texture, &texels, Vec2::from_array(uv));
        prop_assert!(color.cmpge(Vec3::ZERO).all() && color.cmple(Vec3::ONE).all(), "{color}");
        prop_assert!((0.0..=1.0).contains(&alpha));
    }
}

/// A quad with all of a material's textures, seen from above at (0.25, 0.75) of it. Second coordinates are the first
/// ones mirrored.
fn inputs(
    material: Material,
    textures: Vec<Texture>,
    texels: Vec<u32>,
    second: bool,
) -> pt_integrator::bsdf::BsdfInputs {
    let mut scene = SceneData { textures, texels, ..SceneData::default() };
    let triangles = quad(Vec3::ZERO, Vec3::Z, Vec3::X);
    add_triangles(&mut scene, &triangles, material);
    for (shading, corners) in scene.triangle_shading.iter_mut().zip(&triangles) {
        shading.uv = corners.map(|p| [p.x, p.z]);
    }
    if second {
        scene.uv2 = triangles.map(|corners| corners.map(|p| [1.0 - p.x, p.z])).to_vec();
    }
    let packed = PackedScene::new(&scene).unwrap();
    let ray = ray_towards(Vec3::new(0.25, 1.0, 0.75), Vec3::NEG_Y);
    let hit = BruteForce::new(&scene).closest(&ray).unwrap();
    Surface::at::<{ Needs::ALL }>(&packed.view(), &hit, ray.direction).bsdf_inputs(&packed.view())
}

#[test]
fn textures_multiply_their_factors() {
    let bytes =
        [[100, 150, 200, 50], [10, 60, 120, 255], [90, 1, 2, 3], [7, 99, 7, 7], [255, 0, 0, 40], [30, 60, 90, 0]];
    let texels: Vec<u32> = bytes.map(u32::from_le_bytes).to_vec();
    let linear = |i| Texture { flags: Texture::LINEAR, ..Texture::new(i, [1, 1], [Wrap::Clamp; 2]) };
    let encoded = |i| Texture::new(i, [1, 1], [Wrap::Clamp; 2]);
    let textures = vec![encoded(0), linear(1), linear(2), linear(3), linear(4), encoded(5)];
    let material = Material {
        surface: [0.8, 0.7, 0.6, 1.0],
        specular: [0.9, 0.8, 0.7, 0.5],
        interior: [0.0, 0.0, 0.0, 1.7],
        coat: [0.4, 0.3, 1.0, 0.0],
        flags: Material::VOLUME,
        ..Material::lambert([0.5, 0.25, 1.0])
    }
    .textured(Material::BASE_COLOR, 0)
    .textured(Material::METALLIC_ROUGHNESS, 1)
    .textured(Material::TRANSMISSION, 2)
    .textured(Material::CLEARCOAT_ROUGHNESS, 3)
    .textured(Material::CLEARCOAT, 4)
    .textured(Material::SPECULAR, 4)
    .textured(Material::SPECULAR_COLOR, 5);
    let found = inputs(material, textures, texels.clone(), false);
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a}, not {b}: {found:?}");
    assert!(found.base_color.distance(Vec3::new(0.5, 0.25, 1.0) * decode(texels[0])) < 1e-6);
    assert!(found.specular_color.distance(Vec3::new(0.9, 0.8, 0.7) * decode(texels[5])) < 1e-6);
    near(found.roughness, 0.7 * 60.0 / 255.0);
    near(found.metallic, 0.8 * 120.0 / 255.0);
    near(found.transmission, 0.6 * 90.0 / 255.0);
    near(found.clearcoat, 0.4);
    near(found.clearcoat_roughness, 0.3 * 99.0 / 255.0);
    near(found.specular, 0.5 * 40.0 / 255.0);
    near(found.ior, 1.7);
    assert!(!found.thin);
    assert_eq!(found.coat_normal, Vec3::Y);
}

#[test]
fn second_coordinates() {
    // Four columns from 0 to 255; clamped, so that a point reads one of them.
    let texels: Vec<u32> = [0, 85, 170, 255].map(|c| u32::from_le_bytes([c; 4])).to_vec();
    let first = Texture {
        flags: Texture::LINEAR | Texture::wrap_word(Wrap::Clamp, Wrap::Clamp),
        ..Texture::new(0, [4, 1], [Wrap::Clamp; 2])
    };
    let second = Texture { flags: first.flags | Texture::SECOND_UV, ..first };
    let material = Material::lambert([1.0; 3]).textured(Material::BASE_COLOR, 0);
    let read = |texture, has_second| inputs(material, vec![texture], texels.clone(), has_second).base_color.x * 3.0;
    assert!((read(first, true) - 0.5).abs() < 1e-5);
    assert!((read(second, true) - 2.5).abs() < 1e-5);
    // Without a second set all coordinates are 0.
    assert!(read(second, false).abs() < 1e-5);
}

/// Lambert materials are taken as such however their unused parameters stand.
#[test]
fn lambert_inputs_are_exactly_lambert() {
    let found = inputs(Material::lambert([0.3, 0.2, 0.1]), vec![], vec![], false);
    assert_eq!((found.metallic, found.specular, found.transmission, found.clearcoat), (0.0, 0.0, 0.0, 0.0));
    assert_eq!(found.base_color, Vec3::new(0.3, 0.2, 0.1));
}

#[test]
fn materials_say_their_lobes() {
    let plain = Material::lambert([0.5; 3]);
    let with = |surface: [f32; 4]| Material { surface, ..plain };
    assert_eq!(plain.lobes(), Lobes::DIFFUSE);
    assert_eq!(with([1.0, 0.5, 0.0, 1.0]).lobes(), Lobes::REFLECTION);
    let textured = with([1.0, 0.5, 0.0, 1.0]).textured(Material::METALLIC_ROUGHNESS, 0);
    assert_eq!(textured.lobes(), Lobes::DIFFUSE | Lobes::REFLECTION);
    assert_eq!(with([0.0, 0.5, 1.0, 1.0]).lobes(), Lobes::REFLECTION | Lobes::TRANSMISSION);
    let coated = Material { coat: [0.1, 0.0, 1.0, 0.0], ..plain };
    assert_eq!(coated.lobes(), Lobes::DIFFUSE | Lobes::COAT);
    assert_eq!(Material { flags: Material::UNLIT, ..coated }.lobes(), Lobes::NONE);
    assert_eq!(Needs::of_materials(&[plain, plain.textured(Material::METALLIC_ROUGHNESS, 0)]).bits(), 0);
    assert_eq!(Needs::of_materials(&[coated]).bits(), Needs::GLOSSY | Needs::COAT);
}

/// Unlit surfaces show their base colour, textured, and reflect nothing.
#[test]
fn unlit_surfaces_emit_their_base_color() {
    let mut scene = SceneData { textures: vec![Texture::new(0, [1, 1], [Wrap::Repeat; 2])], ..SceneData::default() };
    scene.texels = vec![0xff_80_80_80];
    let material = Material { flags: Material::UNLIT | Material::DOUBLE_SIDED, ..Material::lambert([0.5, 1.0, 0.0]) };
    add_triangles(&mut scene, &quad(Vec3::ZERO, Vec3::Z, Vec3::X), material.textured(Material::BASE_COLOR, 0));
    let packed = PackedScene::new(&scene).unwrap();
    assert_eq!(packed.needs().bits(), Needs::TRIANGLE_LIGHTS | Needs::EMISSIVE_TEXTURES);
    for direction in [Vec3::Y, Vec3::NEG_Y] {
        let ray = ray_towards(Vec3::new(0.25, 0.0, 0.5) - direction, direction);
        let hit = BruteForce::new(&scene).closest(&ray).unwrap();
        let surface = Surface::at::<{ Needs::ALL }>(&packed.view(), &hit, direction);
        let emitted = surface.emission::<{ Needs::ALL }>(&packed.view());
        assert!(emitted.distance(Vec3::new(0.5, 1.0, 0.0) * decode(0x80_80_80)) < 1e-6);
        assert_eq!(surface.albedo::<{ Needs::ALL }>(&packed.view()), Vec3::ZERO);
    }
}
