use half::f16;
use hashcache_core::glam::Vec3;
use hashcache_core::pack::{
    HALF_MAX, OCTAHEDRAL_NONE, OCTAHEDRAL_ONE, half_from_f32, half_to_f32, octahedral_decode, octahedral_decode_int,
    octahedral_encode, pack_half2, unpack_half2,
};
use proptest::prelude::*;

use crate::{any_float, log_uniform};

/// Half a step of the square, 1/65534, in both axes, stretched by at most a factor of 3 where the octahedron's faces
/// are nearest to the centre (|n|₁ = √3): √2·3/65534 = 6.5·10⁻⁵ radians; floats add less than 10⁻⁶.
const ROUND_TRIP: f64 = 6.6e-5;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, cross).sqrt().atan2(dot(a, b))
}

fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn direction() -> impl Strategy<Value = Vec3> {
    let component =
        || prop_oneof![4 => -1.0_f32..1.0, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1.0), 1 => -1e-6_f32..1e-6];
    (component(), component(), component())
        .prop_map(|(x, y, z)| Vec3::new(x, y, z))
        .prop_filter("needs a direction", |v| v.abs().max_element() > 1e-30)
}

proptest! {
    #[test]
    fn directions_survive_at_any_length(n in direction(), scale in log_uniform(-90..120)) {
        let code = octahedral_encode(n * scale);
        let back = wide(octahedral_decode(code));
        prop_assert!((dot(back, back).sqrt() - 1.0).abs() < 2e-7);
        if (n * scale).abs().max_element() >= f32::MIN_POSITIVE {
            prop_assert!(angle(wide(n), back) < ROUND_TRIP, "{n} became {back:?}");
        }
        prop_assert_ne!(code, OCTAHEDRAL_NONE);
    }

    #[test]
    fn integer_directions_lie_on_the_octahedron(code: u32) {
        let v = octahedral_decode_int(code);
        prop_assert_eq!(v.iter().map(|c| c.abs()).sum::<i32>(), OCTAHEDRAL_ONE);
        let float = wide(octahedral_decode(code));
        prop_assert!(angle(float, v.map(f64::from)) < 2e-7);
    }

    /// What was packed once is not moved by packing it again.
    #[test]
    fn packing_is_idempotent(code: u32) {
        let v = octahedral_decode_int(code);
        let again = octahedral_encode(Vec3::from_array(v.map(|c| c as f32)));
        prop_assert_eq!(octahedral_decode_int(again), v);
        prop_assert_eq!(octahedral_encode(octahedral_decode(again)), again);
    }

    #[test]
    fn mirrored_directions_have_mirrored_codes(n in direction()) {
        let v = octahedral_decode_int(octahedral_encode(n));
        let flipped = octahedral_decode_int(octahedral_encode(Vec3::new(-n.x, -n.y, n.z)));
        prop_assert_eq!(flipped, [-v[0], -v[1], v[2]]);
    }

    #[test]
    fn hostile_directions_become_plus_z(x in any_float(), y in any_float(), z in any_float()) {
        let n = Vec3::new(x, y, z);
        let back = octahedral_decode(octahedral_encode(n));
        prop_assert!(back.is_finite());
        if !n.is_finite() {
            prop_assert_eq!(back, Vec3::Z);
        }
    }

    #[test]
    fn half_pairs_keep_their_order(a in -60000.0_f32..60000.0, b in -1.0_f32..1.0) {
        let [x, y] = unpack_half2(pack_half2([a, b]));
        prop_assert_eq!([x, y], [f16::from_f32(a).to_f32(), f16::from_f32(b).to_f32()]);
    }
}

#[test]
fn axes_are_exact() {
    for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        assert_eq!(octahedral_decode(octahedral_encode(axis)), axis);
        let one = OCTAHEDRAL_ONE as f32;
        assert_eq!(octahedral_decode_int(octahedral_encode(axis)), (axis * one).to_array().map(|c| c as i32));
    }
    // −0 counts as 0 on the seam below the equator.
    assert_eq!(octahedral_encode(Vec3::new(-0.0, 0.5, -0.5)), octahedral_encode(Vec3::new(0.0, 0.5, -0.5)));
    assert_eq!(octahedral_encode(Vec3::ZERO), 0);
}

#[test]
fn every_half_float_becomes_its_float() {
    for bits in 0..=u16::MAX {
        assert_eq!(half_to_f32(u32::from(bits)), f16::from_bits(bits).to_f32().to_bits(), "{bits:#06x}");
    }
}

#[test]
fn every_half_float_survives() {
    for bits in 0..=u16::MAX {
        let half = f16::from_bits(bits);
        let expected = match half {
            h if h.is_nan() => 0x7e00,
            h if h.is_infinite() => u32::from(bits & 0x8000) | HALF_MAX,
            _ => u32::from(bits),
        };
        assert_eq!(half_from_f32(half_to_f32(u32::from(bits))), expected, "{bits:#06x}");
    }
}

/// A sweep over all floats in steps of an odd number, so that every exponent and all kinds of low bits occur, and all
/// neighbours of the ties between half floats.
#[test]
fn floats_round_as_in_the_half_crate() {
    let check = |bits: u32| {
        let x = f32::from_bits(bits);
        let expected = if x.is_nan() {
            0x7e00
        } else {
            let nearest = f16::from_f32(x);
            if nearest.is_infinite() {
                u32::from(nearest.to_bits() & 0x8000) | HALF_MAX
            } else {
                u32::from(nearest.to_bits())
            }
        };
        assert_eq!(half_from_f32(bits), expected, "{x} ({bits:#010x})");
    };
    (0..=u32::MAX).step_by(4099).for_each(check);
    for half in 0..HALF_MAX {
        let (below, above) = (half_to_f32(half), half_to_f32(half + 1));
        let tie = u32::midpoint(below, above);
        // Between subnormal halves the middle of the bits is not the middle of the values; take that too.
        let middle = f32::midpoint(f32::from_bits(below), f32::from_bits(above));
        for bits in [tie, middle.to_bits()] {
            check(bits - 1);
            check(bits);
            check(bits + 1);
        }
    }
}
