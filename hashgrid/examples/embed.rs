//! A program with its own ray caster (a sphere on a plane) and its own loop keeps its light in a grid: the grid's
//! storage is an array, and nothing of hashcache but the grid is used. `cargo run --example embed --no-default-features`

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::glam::{Vec2, Vec3, vec2, vec3};
use hashcache_core::hash::{pcg2d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{CELL_WORDS, Params, Settings, Table, Word};

const WIDTH: usize = 64;
const PIXELS: usize = WIDTH * WIDTH;
const PIXEL_ANGLE: f32 = 1.0 / WIDTH as f32;
const LAMP: Vec3 = vec3(2.0, 4.0, 1.0);

static STORAGE: [Word; 8192 * CELL_WORDS] = [const { Word::new(0) }; 8192 * CELL_WORDS];

/// Distance and normal where a ray meets the sphere of radius 1 around (0, 1, 0) or the plane y = 0.
fn closest(origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let from = origin - Vec3::Y;
    let (b, c) = (from.dot(direction), from.length_squared() - 1.0);
    let sphere = -b - (b * b - c).max(0.0).sqrt();
    if b * b > c && sphere > 1e-3 {
        return Some((sphere, from + direction * sphere));
    }
    let plane = -origin.y / direction.y;
    (direction.y < 0.0 && plane < 40.0).then_some((plane, Vec3::Y))
}

/// Light at pixel `i` by one sample of a round lamp, as a vertex that a cache can hold.
fn trace(i: usize) -> VertexRecord {
    let pixel = vec2((i % WIDTH) as f32, (i / WIDTH) as f32) - Vec2::splat(WIDTH as f32 * 0.5);
    let (eye, direction) = (vec3(0.0, 1.5, 5.0), vec3(pixel.x * PIXEL_ANGLE, -pixel.y * PIXEL_ANGLE, -1.0).normalize());
    let Some((t, normal)) = closest(eye, direction) else { return VertexRecord::zeroed() };
    let place = eye + direction * t;
    let random = pcg2d([i as u32, 1]).map(to_unit_f32);
    let way = LAMP + vec3(random[0], 0.0, random[1]) * 2.0 - place;
    let shadowed = closest(place + normal * 1e-3, way.normalize()).is_some();
    let light = if shadowed { 0.0 } else { 20.0 * way.normalize().dot(normal).max(0.0) / way.length_squared() };
    VertexRecord {
        position_footprint: place.extend(t * PIXEL_ANGLE).to_array(),
        direct: [light, light, light, 0.0],
        normal: octahedral_encode(normal),
        direction: octahedral_encode(direction),
        seed: i as u32,
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    }
}

fn main() -> Result<(), ParamError> {
    let params = Params::new(&Settings { cell_footprints: 6.0, pixel_angle: PIXEL_ANGLE, ..Settings::default() })?;
    let table = Table::new(&STORAGE, &params)?;
    table.clear();

    let vertices: [VertexRecord; PIXELS] = std::array::from_fn(trace);
    let mut counters = Counters::default();
    claim_vertices(&table, &params, &vertices);
    deposit_vertices(&table, &params, &vertices, &mut counters);
    let mut image = [0.0; PIXELS];
    estimate_vertices(&table, &params, &vertices, &mut counters, |i, estimate| image[i] = estimate.direct.x);

    let sum = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>();
    let (traced, filtered) = (sum(&mut vertices.iter().map(|v| v.direct[0])), sum(&mut image.iter().copied()));
    println!("load {:.2}, {} hits, light {traced:.1} traced, {filtered:.1} filtered", table.load(), counters.hits);
    assert!((filtered / traced - 1.0).abs() < 0.05, "filtering moves light, it makes none");
    assert!(counters.balance() == 0 && counters.refusals == 0 && table.validate().is_ok());
    Ok(())
}
