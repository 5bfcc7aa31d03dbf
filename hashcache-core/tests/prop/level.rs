use hashcache_core::level::{MAX_LEVEL, exponent, level_from_footprint};
use proptest::prelude::*;

use crate::{any_float, log_uniform, next_down, next_up};

/// One float below a power of two belongs to the level below, the power itself and one above to its own.
#[test]
fn borders_are_one_ulp_wide() {
    for level in 0..=40_i32 {
        let border = 2.0_f32.powi(level);
        let clamped = (level as u32).min(MAX_LEVEL);
        assert_eq!(level_from_footprint(border, 1.0), clamped);
        assert_eq!(level_from_footprint(next_up(border), 1.0), clamped);
        assert_eq!(level_from_footprint(next_down(border), 1.0), (level.max(1) as u32 - 1).min(MAX_LEVEL));
        assert_eq!(exponent(border), level);
        assert_eq!(exponent(next_down(border)), level - 1);
        assert_eq!(exponent(-border), level);
    }
}

#[test]
fn hostile_products_have_a_level() {
    let cases = [
        (f32::NAN, 1.0, 0),
        (-f32::NAN, 1.0, 0),
        (f32::INFINITY, 0.0, 0),
        (f32::INFINITY, 1.0, MAX_LEVEL),
        (f32::MAX, f32::MAX, MAX_LEVEL),
        (f32::NEG_INFINITY, 1.0, 0),
        (-1e9, 1.0, 0),
        (0.0, 1.0, 0),
        (-0.0, 1.0, 0),
        (f32::from_bits(1), 1.0, 0),
        (f32::MIN_POSITIVE, f32::MIN_POSITIVE, 0),
    ];
    for (footprint, recip, level) in cases {
        assert_eq!(level_from_footprint(footprint, recip), level, "{footprint} · {recip}");
    }
}

proptest! {
    #[test]
    fn equals_the_floored_logarithm(footprint in log_uniform(-14..24), recip in log_uniform(-14..14)) {
        // The product as it is rounded to a float, in f64 to have a logarithm of its own.
        let product = f64::from(footprint * recip);
        // log₂ in f64 may round up to an integer just below one: decide by the power instead.
        let mut expected = product.log2().floor() as i32;
        if 2.0_f64.powi(expected) > product {
            expected -= 1;
        }
        prop_assert_eq!(level_from_footprint(footprint, recip), expected.clamp(0, MAX_LEVEL as i32) as u32);
    }

    #[test]
    fn doubling_the_footprint_goes_up_one(footprint in log_uniform(0..30)) {
        let level = level_from_footprint(footprint, 1.0);
        prop_assert_eq!(level_from_footprint(footprint * 2.0, 1.0), (level + 1).min(MAX_LEVEL));
    }

    #[test]
    fn monotone_and_bounded_for_all_bits(a in any_float(), b in any_float(), recip in log_uniform(-20..20)) {
        prop_assert!(level_from_footprint(a, b) <= MAX_LEVEL);
        if a <= b {
            prop_assert!(level_from_footprint(a, recip) <= level_from_footprint(b, recip));
        }
        prop_assert!((-127..=128).contains(&exponent(a)));
    }
}
