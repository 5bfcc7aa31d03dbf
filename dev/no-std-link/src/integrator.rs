//! `pt-integrator`: one path over borrowed slices.

use core::hint::black_box;

use hashcache_core::glam::{Vec2, Vec3};
use hashcache_core::traits::Sampler;
use pt_integrator::camera::CameraRays;
use pt_integrator::film::FilmPixel;
use pt_integrator::light::{EnvironmentView, luminance, may_meet_emitter};
use pt_integrator::packed::{SceneHeader, SceneTriangle};
use pt_integrator::path::{DirectSettings, PathOutcome, PathSettings, RayCounts, VertexSettings, VisibleSettings};
use pt_integrator::path::{trace_path, trace_path_vertices, trace_visible};
use pt_integrator::sampler::{Independent, Sobol, pixel_seed, vertex_seed};
use pt_integrator::sampling::{Basis, cosine_pdf, power_heuristic, sample_cosine, sample_triangle};
use pt_integrator::scene::{Camera, Material, Texture, Wrap};
use pt_integrator::texture::sample_texture;
use pt_integrator::view::SceneView;

use crate::checks::Checks;
use crate::floor::{self, Floor};

/// A camera above the floor that looks down.
pub fn camera() -> Option<Camera> {
    Camera::look_at(black_box(Vec3::Y), Vec3::ZERO, Vec3::Z, 0.5, 2, 2).ok()
}

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    path(checks);
    sampling(checks);
    textures(checks);
}

/// A floor of albedo ½ under a sky of radiance 1: the illumination is 1 whatever the direction.
fn path(checks: &mut Checks) {
    let Some(camera) = camera() else { return checks.that("Camera::look_at", false) };
    let mut header: SceneHeader = bytemuck::Zeroable::zeroed();
    header.constant_environment = [1.0, 1.0, 1.0, 0.0];
    let scene = SceneView {
        header: &header,
        triangles: &[floor::triangle()] as &[SceneTriangle],
        instances: &[floor::instance()],
        materials: &[Material::lambert([0.5; 3])],
        textures: &[],
        texels: &[],
        lights: &[],
        alias: &[],
        punctual_lights: &[],
        second_uv: &[],
        emitters: &[],
        environment: EnvironmentView::NONE,
    };
    let rays = CameraRays::new(&camera);
    let mut counts = RayCounts::default();
    let mut pixel = FilmPixel::default();
    for index in 0..4 {
        let seed = pixel_seed(0, 1);
        let mut sampler = Sobol::new(index, seed);
        let ray = rays.ray([1, 1], sampler.next_2d());
        let settings = PathSettings { max_bounces: 2, ..PathSettings::default() };
        let outcome = trace_path(&scene, &Floor, &mut sampler, &ray, &settings, &mut counts);
        let record = outcome.record(rays.pixel_angle(), vertex_seed(seed, index));
        checks.that("trace_path", (record.radiance() - Vec3::splat(0.5)).abs().max_element() < 1e-5);
        pixel.add(outcome.radiance());

        let mut kept = [PathOutcome::NONE; 2];
        let mut again = Sobol::new(index, seed);
        let ray = rays.with_size([2, 2], [2, 2]).ray([1, 1], again.next_2d());
        let whole = VertexSettings::new(settings);
        trace_path_vertices(&scene, &Floor, &mut again, &ray, &whole, &mut kept, &mut counts);
        checks.that("trace_path_vertices", kept == [outcome, PathOutcome::NONE]);
        let direct = DirectSettings { samples: 1, ..DirectSettings::NONE }.for_scene(&scene);
        let numbers = |_, _, i| Sobol::new(i, seed);
        let mut layers = [PathOutcome::NONE; 2];
        let look = VisibleSettings { direct, max_bounces: 2 };
        trace_visible(&scene, &Floor, &ray, &look, &mut layers, numbers, &mut counts);
        let seen = (layers[0].direct - Vec3::ONE).abs().max_element() < 1e-5;
        checks.that("trace_visible", seen && layers[1] == PathOutcome::NONE);
        checks.that("may_meet_emitter", !may_meet_emitter(scene.lights, &ray));
    }
    checks.that("FilmPixel", (pixel.mean().x - 0.5).abs() < 1e-5);
    checks.that("RayCounts", RayCounts::from_words(counts.to_words()) == counts && counts.paths == 12);
    checks.that("luminance", (luminance(black_box(Vec3::ONE)) - 1.0).abs() < 1e-6);
}

fn sampling(checks: &mut Checks) {
    let mut sampler = Independent::new(black_box(0), 7);
    let u = sampler.next_2d();
    let direction = sample_cosine(u);
    checks.that("sample_cosine", (direction.length_squared() - 1.0).abs() < 1e-5 && cosine_pdf(direction.z) >= 0.0);
    let basis = Basis::new(Vec3::Y);
    checks.that("Basis", basis.to_scene(Vec2::ZERO, 1.0).distance(Vec3::Y) < 1e-6);
    let inside = sample_triangle(u);
    checks.that("sample_triangle", inside.x + inside.y <= 1.0 && inside.min_element() >= 0.0);
    checks.that("power_heuristic", (power_heuristic(black_box(1.0), 1.0) - 0.5).abs() < 1e-6);
}

fn textures(checks: &mut Checks) {
    let texture = Texture::new(0, [1, 1], [Wrap::Repeat; 2]);
    let white = sample_texture(&texture, &[black_box(u32::MAX)], Vec2::splat(0.3));
    checks.that("sample_texture", white.distance(Vec3::ONE) < 1e-6);
}
