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
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::geometry::{Hit, Ray};
use hashcache_core::traits::{RayCaster, Sampler};
use pt_integrator::camera::CameraRays;
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts, trace_path};
use pt_integrator::sampler::{Independent, Sobol, pixel_seed};
use pt_integrator::scene::{Camera, Material, SceneData};

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

criterion_group!(benches, samplers, paths);
criterion_main!(benches);
