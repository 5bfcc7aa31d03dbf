//! Ambient occlusion at implicit points: one ray a pixel and frame, a sphere on a plane, and a camera that comes nearer.
//! A pixel's ray goes to one of the points near it; what the points gathered over the frames is interpolated.
//! `cargo run -p hashcache-hashgrid --example points`

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::float::{cos, sin, sqrt};
use hashcache_core::glam::{Vec2, Vec3, vec2, vec3};
use hashcache_core::hash::{pcg3d, to_unit_f32};
use hashcache_core::record::VertexRecord;
use hashgrid::layout::{Layout, Minimal};
use hashgrid::merge::Merge;
use hashgrid::points::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::temporal::FixedCount;
use hashgrid::{Params, Settings, Table, Word};

const WIDTH: usize = 96;
const PIXEL_ANGLE: f32 = 1.0 / WIDTH as f32;

/// Distance and normal where a ray meets the sphere of radius 1 around (0, 1, 0) or the plane y = 0.
fn closest(origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let from = origin - Vec3::Y;
    let (b, c) = (from.dot(direction), from.length_squared() - 1.0);
    let sphere = -b - sqrt((b * b - c).max(0.0));
    if b * b > c && sphere > 1e-3 {
        return Some((sphere, from + direction * sphere));
    }
    let plane = -origin.y / direction.y;
    (direction.y < 0.0 && plane < 40.0).then_some((plane, Vec3::Y))
}

/// Where pixel `i` looks from a distance, and in how many of `rays` cosine-weighted directions the sky is seen.
fn trace(i: usize, distance: f32, seed: u32, rays: u32) -> VertexRecord {
    let pixel = vec2((i % WIDTH) as f32, (i / WIDTH) as f32) - Vec2::splat(WIDTH as f32 * 0.5);
    let (eye, direction) = (vec3(0.0, 1.5, distance), vec3(pixel.x * PIXEL_ANGLE, -pixel.y * PIXEL_ANGLE, -1.0));
    let Some((t, normal)) = closest(eye, direction.normalize()) else { return VertexRecord::zeroed() };
    let place = eye + direction.normalize() * t;
    let (u, v) = normal.any_orthonormal_pair();
    let open = (0..rays).filter(|ray| {
        let [a, b, _] = pcg3d([i as u32, seed, *ray]).map(to_unit_f32);
        let (radius, angle) = (sqrt(a), 6.283_185_5 * b);
        let way = u * radius * cos(angle) + v * radius * sin(angle) + normal * sqrt(1.0 - a);
        closest(place + normal * 1e-3, way).is_none()
    });
    let sky = open.count() as f32 / rays as f32;
    let position_footprint = place.extend(t * PIXEL_ANGLE).to_array();
    VertexRecord { position_footprint, further: [sky; 4], flags: VertexRecord::VALID, ..VertexRecord::zeroed() }
}

fn main() -> Result<(), ParamError> {
    let params = Params::new(&Settings { cell_footprints: 2.0, pixel_angle: PIXEL_ANGLE, ..Settings::default() })?;
    let words: Vec<Word> = (0..2 * 16_384 * Minimal::WORDS).map(|_| Word::new(0)).collect();
    let (lasting, frame) = words.split_at(words.len() / 2);
    let (lasting, frame) = (Table::<Minimal>::with_layout(lasting, &params)?, Table::with_layout(frame, &params)?);
    lasting.clear();
    let (mut vertices, mut distance) = (vec![], 5.0);
    for index in 0..24 {
        distance = 5.0 - 0.05 * index as f32;
        vertices = (0..WIDTH * WIDTH).map(|i| trace(i, distance, index, 1)).collect();
        frame.clear();
        claim_vertices(&frame, &params, &vertices);
        deposit_vertices::<Minimal>(&frame, &params, &vertices, &mut Counters::default());
        Merge::new(&lasting, &frame)?.all(&FixedCount { most: 256 }, index);
    }
    let (mut error, mut noise, mut counters) = (0.0, 0.0, Counters::default());
    estimate_vertices(&lasting, &params, &vertices, 1.0, 2, &mut counters, |i, estimate| {
        let truth = trace(i, distance, 99, 64).further[0];
        error += f64::from((estimate.further.x - truth).powi(2));
        noise += f64::from((vertices[i].further[0] - truth).powi(2));
    });
    let points = lasting.cells().count();
    println!("{points} points of 32 bytes; mean squared error {:.1} times below one ray's", noise / error);
    assert!(error * 20.0 < noise && counters.fallbacks == 0);
    Ok(())
}
