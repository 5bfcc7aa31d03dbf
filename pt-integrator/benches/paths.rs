//! Samplers against independent numbers, and path tracing against the rays it casts.
//!
//! The caster here tries every triangle of a small room, and its share is measured by `rays`, so that
//! `paths − rays` is what sampling and shading cost.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]
#![allow(clippy::disallowed_methods, reason = "scenes come from the platform's functions")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::cell::RefCell;
use std::hint::black_box;

use common::caster::BruteForce;
use common::scenes::{add_triangles, inward_box, quad};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::geometry::{Hit, Ray};
use hashcache_core::traits::{RayCaster, Sampler};
use pt_integrator::camera::CameraRays;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::light::sample_light;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts, trace_path};
use pt_integrator::sampler::{Independent, Sobol, pixel_seed};
use pt_integrator::scene::{Camera, Material, Needs, PunctualLight, SceneData, Texture, Wrap};

const PATHS: u32 = 4096;

fn samplers(c: &mut Criterion) {
    let mut group = c.benchmark_group("pt-integrator/sampler");
    group.throughput(Throughput::Elements(u64::from(PATHS)));
    let draw = |s: &mut dyn FnMut(u32) -> Vec2| (0..PATHS).map(s).sum::<Vec2>();
    group.bench_function("independent/2d", |b| b.iter(|| draw(&mut |i| Independent::new(i, black_box(1)).next_2d())));
    group.bench_function("sobol/2d", |b| b.iter(|| draw(&mut |i| Sobol::new(i, black_box(1)).next_2d())));
    group.finish();
}

/// Keeps the rays that a path tracer asks for.
struct Recording<'a>(&'a BruteForce, RefCell<Vec<(Ray, bool)>>);

impl RayCaster for Recording<'_> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.1.borrow_mut().push((*ray, false));
        self.0.closest(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.1.borrow_mut().push((*ray, true));
        self.0.occluded(ray)
    }
}

fn room() -> SceneData {
    let mut scene = SceneData::default();
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), Material::lambert([0.7, 0.5, 0.3]));
    let lamp = quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.2; 3], [9.0, 6.0, 3.0]));
    scene
}

fn paths(c: &mut Criterion) {
    let scene = room();
    let packed = PackedScene::new(&scene).expect("the room is a valid scene");
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO, Vec3::Y, 1.0, 64, 64).expect("a valid camera");
    let camera = CameraRays::new(&camera);
    let settings = PathSettings { roulette_depth: 5, ..PathSettings::default() };
    let mut counts = RayCounts::default();
    let mut trace = |caster: &dyn Fn(&mut Sobol, &Ray, &mut RayCounts) -> Vec3| {
        let mut sum = Vec3::ZERO;
        for pixel in 0..PATHS {
            let mut sampler = Sobol::new(0, pixel_seed(pixel, 1));
            let ray = camera.ray([pixel % 64, pixel / 64], sampler.next_2d());
            sum += caster(&mut sampler, &ray, &mut counts);
        }
        sum
    };
    let recording = Recording(&caster, RefCell::default());
    trace(&|s, ray, counts| trace_path(&view, &recording, s, ray, &settings, counts).radiance());
    let rays = recording.1.into_inner();

    let mut group = c.benchmark_group("pt-integrator/trace");
    group.throughput(Throughput::Elements(u64::from(PATHS)));
    group.bench_function("rays", |b| {
        b.iter(|| {
            let hit = |(ray, shadow): &(Ray, bool)| {
                if *shadow { caster.occluded(ray) } else { caster.closest(ray).is_some() }
            };
            rays.iter().filter(|r| hit(r)).count()
        });
    });
    group.bench_function("paths", |b| {
        b.iter(|| trace(&|s, ray, counts| trace_path(&view, &caster, s, ray, &settings, counts).radiance()));
    });
    group.finish();
}

/// One sample of an emitter among few and among many, as seen from the middle of the room.
fn lights(c: &mut Criterion) {
    let mut group = c.benchmark_group("pt-integrator/sample_light");
    group.throughput(Throughput::Elements(u64::from(PATHS)));
    for (kind, side) in [("triangles/12", 2.45_f32), ("triangles/10000", 70.72)] {
        let count = (side * side * 2.0) as usize;
        let mut triangles = Vec::new();
        for i in 0..count.div_ceil(2) {
            let (x, z) = (i as f32 % side, (i as f32 / side).floor());
            triangles.extend(quad(Vec3::new(x, 40.0, z), 0.9 * Vec3::X, 0.9 * Vec3::Z));
        }
        let mut scene = SceneData::default();
        add_triangles(&mut scene, &triangles[..count], Material::emissive([0.5; 3], [3.0, 2.0, 1.0]));
        lights_row(&mut group, kind, &scene);
        scene.textures = vec![Texture::new(0, [64, 64], [Wrap::Repeat; 2])];
        scene.texels = (0..64 * 64_u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
        scene.materials[0].textures[Material::EMISSION] = 0;
        for (i, shading) in scene.triangle_shading.iter_mut().enumerate() {
            shading.uv = [[0.0, i as f32 * 0.37], [0.3, 0.5], [i as f32 * 0.11, 0.7]];
        }
        lights_row(&mut group, &format!("textured {kind}"), &scene);
    }
    for count in [1, 1000] {
        let mut scene = room();
        let light = |i: u32| PunctualLight::point(Vec3::new(i as f32 * 1e-3, 0.9, 0.0), [1.0; 3]);
        scene.punctual_lights = (0..count).map(light).collect();
        lights_row(&mut group, &format!("points/{count}"), &scene);
    }
    group.finish();
}

fn lights_row(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, scene: &SceneData) {
    let packed = PackedScene::new(scene).expect("a valid scene");
    let view = packed.view();
    let general = view.needs().intersects(Needs::GENERAL);
    group.bench_function(name, |b| {
        b.iter(|| {
            let sample = |i: u32| {
                let mut sampler = Independent::new(i, 7);
                let from = black_box(Vec3::ZERO);
                let sample = if general {
                    sample_light::<{ Needs::ALL }>(&view, &mut sampler, from)
                } else {
                    sample_light::<{ Needs::TRIANGLE_LIGHTS }>(&view, &mut sampler, from)
                };
                sample.map_or(0.0, |light| light.pdf)
            };
            (0..PATHS).map(sample).sum::<f32>()
        });
    });
}

criterion_group!(benches, samplers, paths, lights);
criterion_main!(benches);
