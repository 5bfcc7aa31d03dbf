//! Laws of keys, tables and energies, at the extremes and beside models.
#![expect(clippy::float_cmp, reason = "the laws state equal bits")]

#[path = "prop/claims.rs"]
mod claims;
#[path = "prop/energy.rs"]
mod energy;
#[path = "prop/hashes.rs"]
mod hashes;
#[path = "prop/jitter.rs"]
mod jitter;
#[path = "prop/key.rs"]
mod key;
#[path = "prop/layouts.rs"]
mod layouts;
#[path = "prop/names.rs"]
mod names;
#[path = "prop/validate.rs"]
mod validate;

use bytemuck::Zeroable;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::{CELL_WORDS, Params, Settings, Table, Word};
use proptest::prelude::*;

/// Settings with exact numbers: cells of 8 footprints, 2⁻¹⁰ m and larger, no jitter.
fn still() -> Settings {
    Settings { jitter: 0.0, ..Settings::default() }
}

fn params(settings: Settings) -> Params {
    Params::new(&settings).expect("settings of a test")
}

/// Storage of `cells` empty cells.
fn storage(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * CELL_WORDS).map(|_| Word::new(0xdead_beef)).collect();
    Table::new(&words, params).expect("storage of a test").clear();
    words
}

/// The words of a table.
fn bits(words: &[Word]) -> Vec<u64> {
    words.iter().map(|word| word.load(std::sync::atomic::Ordering::Relaxed)).collect()
}

/// A vertex with a level-0 footprint at a place.
fn vertex(position: [f32; 3], normal: Vec3) -> VertexRecord {
    let [x, y, z] = position;
    VertexRecord {
        position_footprint: [x, y, z, 1.0 / 8192.0],
        normal: octahedral_encode(normal),
        direction: octahedral_encode(Vec3::NEG_Z),
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    }
}

/// `count` vertices on the six walls of a room of 4 m, seen from its middle, with some light.
fn room(count: u32, seed: u32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let r = pcg4d([i, seed, 0, 1]).map(to_unit_f32);
            let (u, v) = (4.0 * r[0] - 2.0, 4.0 * r[1] - 2.0);
            let wall = (r[2] * 6.0) as usize % 6;
            let side = if wall.is_multiple_of(2) { 2.0 } else { -2.0 };
            let mut position = [u, v, side];
            let mut normal = [0.0, 0.0, -side.signum()];
            position.rotate_right(wall / 2);
            normal.rotate_right(wall / 2);
            let place = Vec3::from_array(position);
            VertexRecord {
                position_footprint: [position[0], position[1], position[2], place.length() * 0.002],
                direct: [r[3], 0.5 * r[3], 0.0, 0.0],
                further: [0.1 * r[0], 0.2, 0.3 * r[1], 0.0],
                normal: octahedral_encode(Vec3::from_array(normal)),
                direction: octahedral_encode(place),
                seed: i ^ seed,
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

/// Floats of every kind: all bit patterns, so NaN, infinities, subnormal numbers and both zeros too.
fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        (-14_i32..25, -1.0_f32..1.0).prop_map(|(e, m)| m * 2.0_f32.powi(e)),
        prop::sample::select(vec![0.0, -0.0, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN, 1e-12, 1e12, 1e7]),
    ]
}

/// Vertices with any bits in every field.
fn any_vertex() -> impl Strategy<Value = VertexRecord> {
    let four = || [any_float(), any_float(), any_float(), any_float()];
    (four(), four(), four(), any::<[u32; 3]>(), 0_u32..4).prop_map(|(place, direct, further, [n, d, s], flags)| {
        VertexRecord {
            position_footprint: place,
            direct,
            further,
            normal: n,
            direction: d,
            seed: s,
            flags,
            ..VertexRecord::zeroed()
        }
    })
}

/// Any settings that are accepted.
fn any_settings() -> impl Strategy<Value = Settings> {
    let sizes = (-10_i32..=16, -30_i32..=20, 0.0_f32..4.0);
    let shape = (0.0_f32..=1.0, 0_u32..8, 1_u32..=64, any::<u32>());
    (sizes, shape).prop_map(|((c, b, angle), (jitter, bins, probes, seed))| Settings {
        cell_footprints: 2.0_f32.powi(c),
        base_size: 2.0_f32.powi(b),
        pixel_angle: angle,
        jitter,
        normal_bins: 2 * bins + 1,
        max_probes: probes,
        seed,
        ..Settings::default()
    })
}
