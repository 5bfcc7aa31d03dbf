//! Ambient occlusion of a real scene at implicit points: one ray a pixel and frame, kept at points of space that nobody
//! stores, interpolated for the picture. Nothing of the pipeline is used: the scene's triangles, the CPU's rays, a table.
//! `cargo run --release -p hashcache --example ambient_occlusion -- builtin:interior ao.png`

use std::error::Error;
use std::path::Path;

use backend_cpu::rays::CpuScene;
use bytemuck::Zeroable;
use hashcache::{Image, image_file, scene};
use hashcache_core::counters::Counters;
use hashcache_core::geometry::{Geometry, Hit, Ray};
use hashcache_core::glam::{Vec2, Vec3};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::{RayCaster, Sampler};
use hashgrid::layout::{Layout, Minimal};
use hashgrid::{Params, Settings, Table, Word, points};
use pt_integrator::camera::CameraRays;
use pt_integrator::ray::RELATIVE_OFFSET;
use pt_integrator::sampler::{Sobol, pixel_seed};
use pt_integrator::sampling::{Basis, sample_cosine};

const WIDTH: u32 = 256;
const HEIGHT: u32 = 192;
const FRAMES: u32 = 4;
/// Occluders farther away than this do not count, in metres.
const REACH: f32 = 1.0;

/// A point of the scene and its normal on the ray's side.
fn surface(geometry: &Geometry<'_>, ray: &Ray, hit: &Hit) -> (Vec3, Vec3) {
    let instance = &geometry.instances[hit.instance as usize];
    let corner = |index: u32| instance.point(Vec3::from_array(geometry.positions[index as usize]));
    let [a, b, c] = geometry.indices[hit.triangle as usize].map(corner);
    let normal = (b - a).cross(c - a).normalize();
    let place = a + (b - a) * hit.u + (c - a) * hit.v;
    (place, if normal.dot(ray.direction) > 0.0 { -normal } else { normal })
}

/// What a pixel shows, and in how many of `rays` directions from there nothing is near.
fn look(
    geometry: &Geometry<'_>,
    rays_of: &CpuScene,
    camera: &CameraRays,
    pixel: u32,
    first: u32,
    rays: u32,
) -> VertexRecord {
    let ray = camera.ray([pixel % WIDTH, pixel / WIDTH], Vec2::splat(0.5));
    let Some(hit) = rays_of.closest(&ray) else { return VertexRecord::zeroed() };
    let (place, normal) = surface(geometry, &ray, &hit);
    let origin = place + normal * place.abs().max_element().max(1.0) * RELATIVE_OFFSET;
    let basis = Basis::new(normal);
    let open = (first..first + rays).filter(|index| {
        let local = sample_cosine(Sobol::new(*index, pixel_seed(pixel, 1)).next_2d());
        let direction = basis.to_scene(local.truncate(), local.z);
        !rays_of.occluded(&Ray { origin, t_min: 0.0, direction, t_max: REACH })
    });
    let light = open.count() as f32 / rays as f32;
    let position_footprint = place.extend(hit.t * camera.pixel_angle()).to_array();
    VertexRecord { position_footprint, further: [light; 4], flags: VertexRecord::VALID, ..VertexRecord::zeroed() }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let source = arguments.next().unwrap_or_else(|| "builtin:interior".to_owned());
    let loaded = scene::load(&source, &scene::LoadOptions::default())?;
    let camera = CameraRays::new(&loaded.view(None)?.camera(loaded.origin, WIDTH, HEIGHT)?);
    let geometry = loaded.data.geometry();
    let caster = CpuScene::build(&geometry)?;

    let angle = camera.pixel_angle();
    let params = Params::new(&Settings { cell_footprints: 6.0, pixel_angle: angle, ..Settings::default() })?;
    let storage: Vec<Word> = (0..65_536 * Minimal::WORDS).map(|_| Word::new(0)).collect();
    let table = Table::<Minimal>::with_layout(&storage, &params)?;
    table.clear();
    let (mut vertices, mut counters) = (Vec::new(), Counters::default());
    for frame in 0..FRAMES {
        vertices = (0..WIDTH * HEIGHT).map(|i| look(&geometry, &caster, &camera, i, frame, 1)).collect();
        points::claim_vertices(&table, &params, &vertices);
        points::deposit_vertices(&table, &params, &vertices, &mut counters);
    }
    let mut image = Image { width: WIDTH, height: HEIGHT, pixels: vec![[0.0; 3]; vertices.len()] };
    points::estimate_vertices(&table, &params, &vertices, 1.0, 2, &mut counters, |i, estimate| {
        image.pixels[i] = estimate.further.to_array();
    });

    let (mut shared, mut alone) = (0.0, 0.0);
    for pixel in (0..WIDTH * HEIGHT).step_by(37) {
        let truth = look(&geometry, &caster, &camera, pixel, 0, 1024).further[0];
        let traced = look(&geometry, &caster, &camera, pixel, 0, FRAMES).further[0];
        shared += f64::from((image.pixels[pixel as usize][0] - truth).powi(2));
        alone += f64::from((traced - truth).powi(2));
    }
    let (ratio, used) = (alone / shared, table.cells().count());
    println!(
        "{used} points of 32 bytes, load {:.2}; squared error {ratio:.1} times below the rays' alone",
        table.load()
    );
    assert!(counters.balance() == 0, "no light is lost unseen");
    if let Some(file) = arguments.next() {
        image_file::write(Path::new(&file), &image)?;
    }
    Ok(())
}
