//! Lambertian scenes keep their bits: what a scene does not need costs it nothing, not even a rounding.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    clippy::unreadable_literal,
    reason = "scenes come from the platform's functions, and golden numbers are never read"
)]

mod common;

use common::caster::BruteForce;
use common::scenes::{add_triangles, inward_box, quad};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::traits::Sampler;
use pt_integrator::camera::CameraRays;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{
    DirectSettings, PathOutcome, PathSettings, RayCounts, Strategy, VertexSettings, VisibleSettings, trace_path,
    trace_path_vertices, trace_visible,
};
use pt_integrator::sampler::{Sobol, pixel_seed, vertex_seed};
use pt_integrator::scene::{Camera, Environment, EnvironmentImage, Material, Needs, SceneData, Texture, Wrap};

const SIZE: u32 = 16;
const SAMPLES: u32 = 8;

/// The Cornell box in metres: coloured walls, a lamp, and a block with smooth normals. `open`: without its lamp and its
/// front, under a sky, on a floor with a texture.
fn room(open: bool) -> SceneData {
    let mut scene = SceneData::default();
    let walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    let mut white = Material::lambert([0.73, 0.74, 0.69]);
    if open {
        textured(&mut scene, &mut white);
    }
    add_triangles(&mut scene, &walls[..2], Material::lambert([0.63, 0.06, 0.05]));
    add_triangles(&mut scene, &walls[2..6], white);
    add_triangles(&mut scene, &walls[6..8], Material::lambert([0.14, 0.45, 0.09]));
    add_triangles(&mut scene, &walls[8..10], white);
    let block = inward_box(Vec3::new(0.1, -0.4, -0.5), Vec3::new(0.6, -1.0, 0.1));
    let first = scene.triangle_shading.len();
    add_triangles(&mut scene, &block, Material::lambert([0.725, 0.71, 0.68]));
    for (shading, corners) in scene.triangle_shading[first..].iter_mut().zip(&block) {
        let centre = Vec3::new(0.35, -0.7, -0.2);
        shading.normals = corners.map(|corner| octahedral_encode(corner - centre));
    }
    if open {
        let texel = |i: u32| if i % 16 == 3 { [9.0, 8.0, 6.0, 0.0] } else { [0.2, 0.3, 0.5 + 0.01 * i as f32, 0.0] };
        let texels = (0..16 * 8).map(texel).collect();
        scene.environment = Some(Environment::Image(EnvironmentImage { width: 16, height: 8, texels }));
    } else {
        let lamp = quad(Vec3::new(-0.25, 0.98, -0.2), 0.5 * Vec3::X, 0.4 * Vec3::Z);
        add_triangles(&mut scene, &lamp, Material::emissive([0.78; 3], [17.0, 12.0, 4.0]));
    }
    scene
}

/// An even sky and nothing else.
fn even() -> SceneData {
    let mut scene = SceneData { environment: Some(Environment::Constant([1.0, 2.0, 3.0])), ..SceneData::default() };
    let floor = quad(Vec3::new(-3.0, -1.0, -3.0), 6.0 * Vec3::Z, 6.0 * Vec3::X);
    add_triangles(&mut scene, &floor, Material::lambert([0.9, 0.5, 0.1]));
    let block = inward_box(Vec3::new(0.1, -0.4, -0.5), Vec3::new(0.6, -1.0, 0.1));
    add_triangles(&mut scene, &block, Material::lambert([0.725, 0.71, 0.68]));
    scene
}

fn textured(scene: &mut SceneData, material: &mut Material) {
    scene.texels = vec![0x0040_80c0, 0x00c0_4080, 0x0080_c040, 0x00ff_ffff];
    scene.textures = vec![Texture::new(0, [2, 2], [Wrap::Repeat, Wrap::Mirror])];
    *material = material.textured(Material::BASE_COLOR, 0);
}

/// Sums of what was traced, and a hash of all its bits (FNV-1a).
#[derive(Debug, PartialEq)]
struct Golden {
    sum: [f64; 3],
    bits: u64,
}

impl Golden {
    fn new() -> Self {
        Self { sum: [0.0; 3], bits: 0xcbf2_9ce4_8422_2325 }
    }

    fn add(&mut self, outcome: &PathOutcome) {
        let light = outcome.radiance();
        self.sum = [0, 1, 2].map(|c| self.sum[c] + f64::from(light[c]));
        for byte in bytemuck::bytes_of(&outcome.record(0.01, 0)) {
            self.bits = (self.bits ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Whole paths, paths with three vertices, paths with roulette, and first vertices.
fn traced(scene: &SceneData, forced: u32) -> [Golden; 4] {
    let mut packed = PackedScene::new(scene).unwrap();
    packed.force_needs(forced);
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 0.95), Vec3::ZERO, Vec3::Y, 1.2, SIZE, SIZE).unwrap();
    let rays = CameraRays::new(&camera);
    let mut counts = RayCounts::default();
    let mut golden = [Golden::new(), Golden::new(), Golden::new(), Golden::new()];
    let all = PathSettings::default();
    let roulette = PathSettings { roulette_depth: 2, ..all };
    let direct = DirectSettings::new(2, &view);
    for pixel in 0..SIZE * SIZE {
        let seed = pixel_seed(pixel, 1);
        let seeds = [1, 2].map(|salt| vertex_seed(seed, salt));
        for sample in 0..SAMPLES {
            let start = |u: Vec2| rays.ray([pixel % SIZE, pixel / SIZE], u);
            let mut sampler = Sobol::new(sample, seed);
            let ray = start(sampler.next_2d());
            let mut again = sampler;
            golden[0].add(&trace_path(&view, &caster, &mut again, &ray, &all, &mut counts));
            let mut vertices = [PathOutcome::NONE; 3];
            let mut again = sampler;
            let settings = VertexSettings::new(all);
            trace_path_vertices(&view, &caster, &mut again, &ray, &settings, &mut vertices, &mut counts);
            for vertex in &vertices {
                golden[1].add(vertex);
            }
            golden[2].add(&trace_path(&view, &caster, &mut sampler, &ray, &roulette, &mut counts));
            let numbers = |strategy, _, i: u32| match strategy {
                Strategy::NextEvent => Sobol::new(sample * direct.all() + i, seeds[0]),
                Strategy::Scattering => Sobol::new(sample * direct.scattered + i, seeds[1]),
                Strategy::Chain => Sobol::new(sample, seed),
            };
            let settings = VisibleSettings { direct, max_bounces: all.max_bounces };
            let mut layers = [PathOutcome::NONE; 2];
            trace_visible(&view, &caster, &ray, &settings, &mut layers, numbers, &mut counts);
            assert_eq!(layers[1], PathOutcome::NONE);
            golden[3].add(&layers[0]);
        }
    }
    assert_eq!(counts.non_finite, 0);
    golden
}

const fn golden(sum: [f64; 3], bits: u64) -> Golden {
    Golden { sum, bits }
}

/// What was traced when surfaces could be nothing but Lambertian.
const EXPECTED: [(&str, [Golden; 4]); 3] = [
    (
        "cornell",
        [
            golden([352.9104835400358, 213.4684364147688, 54.484748359983314], 14597197274075527450),
            golden([597.3556849326706, 334.75455288174, 76.22678390072304], 8332107512905109342),
            golden([354.0051874318742, 210.20191951747984, 54.06005006875421], 13999752523756379108),
            golden([194.24346774692822, 132.10752614657395, 39.18379235351313], 1197731196453217831),
        ],
    ),
    (
        "open",
        [
            golden([41.82555782658176, 34.541235891463806, 124.03886744736457], 13434053231382954347),
            golden([61.09830787508254, 43.2097291886528, 141.0393250446776], 4482143962939349784),
            golden([46.80450601817574, 38.89025672002026, 126.60595882673806], 12638639805207245336),
            golden([26.75513357273303, 26.22919361758977, 108.00676437304355], 9483901320589249784),
        ],
    ),
    (
        "even",
        [
            golden([1930.1735602915287, 3508.2154900729656, 4732.412397580221], 8876263211125985959),
            golden([1981.6231876313686, 3560.1164883077145, 4746.121198328212], 10361552315625546672),
            golden([1927.1999933123589, 3505.0741933584213, 4731.557252332568], 11223864829021154787),
            golden([1887.8833300471306, 3462.2533277869225, 4714.440001226962], 11297586350342838186),
        ],
    ),
];

#[test]
fn lambertian_scenes_keep_their_bits() {
    for ((what, expected), scene) in EXPECTED.iter().zip([room(false), room(true), even()]) {
        assert_eq!(traced(&scene, 0), *expected, "{what}");
    }
}

/// Features that a scene does not need may be on.
#[test]
fn forced_needs_change_no_bit() {
    for ((what, expected), scene) in EXPECTED.iter().zip([room(false), room(true), even()]) {
        for forced in [Needs::LAMBERT, Needs::GLOSSY, Needs::PUNCTUAL, Needs::ALL] {
            assert_eq!(traced(&scene, forced), *expected, "{what}, {forced}");
        }
    }
}
