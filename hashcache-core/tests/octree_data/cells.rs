//! Rounding by chance, and the layouts' words.

use hashcache_core::exact::Quantum;
use hashcache_core::octree::{BACK, CellRecord, ExactCell, FRONT, PaperCell, Sample, Side, Sum};
use hashcache_core::pack::half_to_f32;
use proptest::prelude::*;

fn half(bits: u32) -> f32 {
    f32::from_bits(half_to_f32(bits))
}

proptest! {
    /// Value and rest are the exact sum, in double precision at least.
    #[test]
    fn sums_lose_nothing(a in 0.0_f32..1e6, b in -1.0_f32..1.0) {
        let Sum { value, rest } = Sum::new(a, b);
        prop_assert_eq!(f64::from(value) + f64::from(rest), f64::from(a) + f64::from(b));
    }

    /// Rounding by chance is right on average: over evenly spread random words to within their spacing.
    #[test]
    fn dither_is_fair(a in 1e-3_f32..1e3, share in -1.0_f32..1.0) {
        let sum = Sum::new(a, a * share * 1e-7);
        let exact = f64::from(sum.value) + f64::from(sum.rest);
        let spread = (0..1024_u32).map(|k| f64::from(sum.dither(k << 22)));
        let mean = spread.sum::<f64>() / 1024.0;
        let last = f64::from(f32::EPSILON) * f64::from(a);
        prop_assert!((mean - exact).abs() <= 2e-3 * last, "{mean} for {exact}");
        prop_assert!((f64::from(sum.dither(17)) - exact).abs() < last);
    }

    #[test]
    fn dither_of_halves_is_fair(e in -30_i32..16, m in 1.0_f32..2.0) {
        let value = (f64::from(m) * 2.0_f64.powi(e)) as f32;
        let sum = Sum { value, rest: 0.0 };
        let spread = (0..1024_u32).map(|k| f64::from(half(sum.dither_half(k << 22))));
        let mean = spread.sum::<f64>() / 1024.0;
        let last = 2.0_f64.powi(e.max(-14) - 10);
        let exact = f64::from(value.min(65_504.0));
        prop_assert!((mean - exact).abs() <= 2e-3 * last, "{mean} for {exact}");
    }

    /// A half float stays the half float it is.
    #[test]
    fn halves_stay(bits in 0_u32..0x7c00, random: u32) {
        let sum = Sum { value: half(bits), rest: 0.0 };
        prop_assert_eq!(sum.dither_half(random), bits);
    }

    /// A sample gives back what it was made of.
    #[test]
    fn samples_come_back(place in prop::array::uniform3(0_u32..1 << 17), sums in prop::array::uniform3(0_u64..=1 << 34), normal: u32) {
        let sample = Sample::new(place, sums, normal);
        prop_assert!(sample.is_kept());
        prop_assert_eq!((sample.place(), sample.sums(), sample.normal()), (place, sums, normal));
    }

    /// Sides do not touch each other, nor normal and frame.
    #[test]
    fn sides_are_apart(bits in prop::array::uniform6(0_u32..0x7c00), counts: [u16; 2], normal: u32, wiped: u32, e in -90_i32..70) {
        let q = Quantum::new(e).expect("in range");
        let mean = |side: usize, c: usize| half(bits[3 * side + c]) * q.l0();
        let sums = |side| [0, 1, 2].map(|c| Sum { value: mean(side, c), rest: 0.0 });
        let check = |found: Side, side: usize| {
            found.mean == [0, 1, 2].map(|c| mean(side, c)) && found.count == u32::from(counts[side])
        };
        let mut paper = PaperCell::empty(normal, wiped);
        let mut exact = ExactCell::empty(normal, wiped);
        for side in [BACK, FRONT, BACK] {
            paper.put(side, q, sums(side), u32::from(counts[side]), [0; 3]);
            exact.put(side, q, sums(side), u32::from(counts[side]), [0; 3]);
        }
        for side in [FRONT, BACK] {
            prop_assert!(check(paper.side(side, q), side));
            prop_assert!(check(exact.side(side, q), side));
        }
        prop_assert_eq!((paper.normal(), paper.wiped()), (normal, wiped));
        prop_assert_eq!((exact.normal(), exact.wiped()), (normal, wiped));
    }
}

#[test]
fn samples_are_as_documented() {
    let sample = Sample::new([5, 1, 0], [(1 << 32) + 7, 0, 0], 9);
    assert_eq!(bytemuck::cast::<_, [u32; 6]>(sample), [7, 0, 0, 0x0002_0005, 0x1008_0000, 9]);
    assert!(!<Sample as bytemuck::Zeroable>::zeroed().is_kept());
}

/// The example of the documentation, and what lies beyond the range.
#[test]
fn words_are_as_documented() {
    let q = Quantum::new(3).expect("in range");
    let mut cell = PaperCell::empty(0, 0);
    let mean = [1.5, 0.0, 0.25].map(|v| Sum { value: v * q.l0(), rest: 0.0 });
    cell.put(BACK, q, mean, 3, [0; 3]);
    assert_eq!((cell.halves, cell.counts), ([0, 0x3e00_0000, 0x3400_0000], 0x0003_0000));
    for (value, bits) in [(f32::MAX, 0x7bff), (65_504.0, 0x7bff), (-1.0, 0), (0.0, 0)] {
        assert_eq!(Sum { value, rest: 0.0 }.dither_half(u32::MAX), bits);
    }
}
