//! The lanes beside the scalar key and its pieces: equal bits, at the extremes too.

use bytemuck::Zeroable;
use hashcache_core::jitter::{max_component, tangent_offset, turn};
use proptest::prelude::*;
use std::vec;

use super::*;
use crate::{Settings, jitter, key};

/// Floats of every kind, most of them of a size that a grid may hold.
fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        2 => any::<u32>().prop_map(f32::from_bits),
        6 => (-40_i32..45, -2.0_f32..2.0).prop_map(|(e, m)| m * 2.0_f32.powi(e)),
        1 => prop::sample::select(vec![0.0, -0.0, 1e-40, -1e-40, f32::MAX, f32::INFINITY, f32::NAN, -f32::MIN_POSITIVE]),
    ]
}

/// Codes of directions: any, and those along axes, diagonals, edges and corners of the octahedron.
fn any_code() -> impl Strategy<Value = u32> {
    let edge = || prop::sample::select(vec![0_i16, 1, -1, 16383, 16384, -16384, 10922, 10923, 32767, -32767, i16::MIN]);
    prop_oneof![any::<u32>(), (edge(), edge()).prop_map(|(x, y)| u32::from(x as u16) | (u32::from(y as u16) << 16))]
}

/// Numbers of any size, and those next to powers of two.
fn any_size() -> impl Strategy<Value = i32> {
    prop_oneof![any::<i32>(), (0_u32..31, -1_i32..=1).prop_map(|(k, near)| (1 << k) + near)]
}

fn any_params() -> impl Strategy<Value = Params> {
    let shape = (prop_oneof![Just(0.0_f32), Just(1.0), 0.0_f32..=1.0], 0_u32..8, any::<u32>());
    (-10_i32..=16, -30_i32..=20, 0.0_f32..4.0, shape).prop_map(|(cell, base, pixel_angle, (jitter, bins, seed))| {
        let (cell_footprints, base_size) = (2.0_f32.powi(cell), 2.0_f32.powi(base));
        let (normal_bins, default) = (2 * bins + 1, Settings::default());
        let settings = Settings { cell_footprints, base_size, pixel_angle, jitter, normal_bins, seed, ..default };
        Params::new(&settings).expect("settings of a test")
    })
}

fn any_vertex() -> impl Strategy<Value = VertexRecord> {
    let place = [any_float(), any_float(), any_float(), any_float()];
    (place, any_code(), any_code(), any::<u32>(), prop_oneof![4 => Just(VertexRecord::VALID), 1 => 0_u32..8]).prop_map(
        |(position_footprint, normal, direction, seed, flags)| VertexRecord {
            position_footprint,
            normal,
            direction,
            seed,
            flags,
            ..VertexRecord::zeroed()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1024))]

    /// Batches of any length, whole vectors or not.
    #[test]
    fn keys_are_the_scalar_keys(
        params in any_params(),
        vertices in prop::collection::vec(any_vertex(), 0..=BATCH),
        salt: u32,
    ) {
        let found = keys(&params, &vertices, salt);
        for (vertex, found) in vertices.iter().zip(found) {
            let expected = if vertex.is_valid() { key::key(&params, vertex, salt) } else { None };
            prop_assert_eq!(found, expected, "{:?}", vertex);
        }
        prop_assert!(found[vertices.len()..].iter().all(Option::is_none));
    }

    /// Rounded to a float and cut, quotients of whole numbers are the integer quotients.
    #[test]
    fn float_quotients_are_integer_quotients(p in -(1_i32 << 24)..=1 << 24, q in 1_i32 << 13..=1 << 17, near in -1_i32..=1_i32) {
        prop_assert_eq!(cut(p as f32 / q as f32) as i32, p / q);
        // Next to a multiple of the divisor, where rounding could reach it.
        let p = (p / q * q + near).clamp(-(1 << 24), 1 << 24);
        prop_assert_eq!(cut(p as f32 / q as f32) as i32, p / q);
        prop_assert_eq!(below(p.abs() as f32 / q as f32) as i32, p.abs() / q);
    }

    #[test]
    fn pieces_are_the_scalar_pieces(
        code in any_code(),
        direction in any_code(),
        u in prop_oneof![Just(-128), Just(127), -128_i32..128],
        v in prop_oneof![Just(-128), Just(127), -128_i32..128],
        lean in [-32768_i32..32768, -32768_i32..32768],
        bins in 0_u32..8,
    ) {
        let n = octahedral_decode_int(code);
        let axis = Axis::of(n.map(|c| c as f32));
        prop_assert_eq!(axis.index() as u32, max_component(n));
        let turned = axis.turn(n.map(|c| c as f32));
        prop_assert_eq!(turned.map(|c| c as i32), turn(n, max_component(n)));
        let bins = 2 * bins + 1;
        prop_assert_eq!(normal_bin(axis, turned, lean, bins), jitter::normal_bin(n, lean[0], lean[1], bins));
        let (offset, d) = (tangent_offset(n, u, v), octahedral_decode_int(direction));
        let change = path_change(offset.map(|c| c as f32), d);
        prop_assert_eq!(whole(change), jitter::path_change(offset, d));
    }

    #[test]
    fn levels_are_the_scalar_levels(cells in any_float(), lowest in 0_i32..=31, level in 0_i32..=31, size in any_size()) {
        let cells = if cells.is_finite() { cells.abs() } else { 0.0 };
        prop_assert_eq!(footprint_level(cells, lowest), key::footprint_level(cells, lowest));
        let level = level.max(lowest);
        prop_assert_eq!(moved_level(level, size, lowest), key::moved_level(level, size, lowest));
    }

    /// Down to the smallest floats, where the product is no float any more.
    #[test]
    fn coordinates_are_the_scalar_coordinates(bits: u32, e in 0_u32..30, scale in -43_i32..=38) {
        // Below 2³⁰ once scaled.
        let biased = ((bits >> 23) & 0xff).min((156 - scale) as u32);
        for biased in [biased, (156 - scale) as u32 - e, 0] {
            let x = (bits & 0x807f_ffff) | (biased << 23);
            prop_assert_eq!(fixed(x, f64::from(power(scale))), key::fixed(x, scale), "{:e}", f32::from_bits(x));
        }
    }
}

/// All remainders of the way to a coarser or finer level, and of the estimated length of a direction.
#[test]
fn lowered_numbers_round_to_the_floor() {
    for v in -4096_i32..=4096 {
        assert_eq!(whole(lowered(v as f32 / 4.0, 2)), v >> 2);
    }
    for v in (-2_100_000_i32..=7_100_000).step_by(7) {
        assert_eq!(whole(lowered(v as f32 / 1024.0, 10)), v >> 10);
    }
}
