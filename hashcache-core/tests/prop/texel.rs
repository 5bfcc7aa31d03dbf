//! Texels beside a coordinate, and the alpha between them.

use hashcache_core::geometry::OpacityMask;
use hashcache_core::glam::Vec2;
use hashcache_core::texel::{Wrap, texel_pair};
use proptest::prelude::*;

use crate::{any_float, log_uniform};

fn model(i: i64, n: i64, wrap: u32) -> i64 {
    match wrap {
        1 => i.clamp(0, n - 1),
        2 => {
            let j = i.rem_euclid(2 * n);
            if j < n { j } else { 2 * n - 1 - j }
        }
        _ => i.rem_euclid(n),
    }
}

proptest! {
    #[test]
    fn every_coordinate_names_texels(x in any_float(), size in 1u32..1 << 30, wrap in any::<u32>()) {
        let pair = texel_pair(x, size, wrap);
        prop_assert!(pair.first < size && pair.second < size);
        prop_assert!((0.0..=1.0).contains(&pair.fraction));
    }

    #[test]
    fn texels_are_those_of_the_endless_image(k in -4000i64..4000, size in 1u32..300, wrap in 0u32..3) {
        // Sixteenths of a texel away from centres and borders; the image period is a power of two, so all is exact.
        let n = i64::from(size.next_power_of_two());
        let x = (k as f32 + 0.25) / 16.0;
        let pair = texel_pair(x / n as f32, n as u32, wrap);
        let at = f64::from(x) - 0.5;
        let expected = [at.floor() as i64, at.floor() as i64 + 1].map(|i| model(i, n, wrap));
        let outside = wrap == 1 && !(0.0..=n as f64 - 1.0).contains(&at);
        prop_assert_eq!([i64::from(pair.first), i64::from(pair.second)], expected);
        prop_assert!(outside || (f64::from(pair.fraction) - (at - at.floor())).abs() < 1e-4);
    }

    #[test]
    fn an_even_image_has_its_own_alpha(
        bits in prop::array::uniform8(any_float()), side in 1u32..5, alpha in any::<u8>(), wrap in 0u32..16,
    ) {
        let [a, b, c, d, e, f, u, v] = bits;
        let uv_rows = [[a, b, c, 0.0], [d, e, f, 0.0]];
        let at = |cutoff: f32| {
            let mask = OpacityMask {
                first_alpha: 0, width: side, height: side, wrap, uv_rows, cutoff, factor: 1.0, reserved: [0; 2],
            };
            mask.passes(&vec![alpha; (side * side) as usize], Vec2::new(u, v))
        };
        prop_assert!(!at(f32::from(alpha) / 255.0));
        prop_assert!(at(f32::from(alpha) / 255.0 + 1e-6));
    }

    #[test]
    fn alpha_lies_between_its_texels(
        u in any_float(), v in log_uniform(-20..30), alpha in prop::array::uniform9(any::<u8>()), cutoff in 0.0f32..1.0,
    ) {
        let mask = OpacityMask {
            first_alpha: 0, width: 3, height: 3, wrap: Wrap::word(Wrap::Mirror, Wrap::Repeat),
            uv_rows: OpacityMask::IDENTITY, cutoff, factor: 1.0, reserved: [0; 2],
        };
        let passes = mask.passes(&alpha, Vec2::new(u, v));
        let values = alpha.map(|a| f32::from(a) / 255.0);
        if values.iter().all(|&a| a < cutoff - 1e-6) {
            prop_assert!(passes);
        }
        if values.iter().all(|&a| a > cutoff + 1e-6) {
            prop_assert!(!passes && !mask.has_holes(&alpha));
        }
        prop_assert!(!passes || mask.has_holes(&alpha));
    }
}
