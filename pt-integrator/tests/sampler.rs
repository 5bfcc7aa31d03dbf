//! Point sets: nets, direction numbers, agreement with a published crate.

use hashcache_core::traits::Sampler;
use proptest::prelude::*;
use pt_integrator::sampler::{
    Independent, Sobol, laine_karras, nested_uniform_scramble, sobol_point, sobol_second, sobol_value,
};

/// Joe & Kuo 2010, `new-joe-kuo-6.21201`, dimension 2: s = 1, a = 0, m = (1). Column k of its matrix.
fn joe_kuo_second(k: usize) -> u32 {
    let mut v = [0_u32; 32];
    v[0] = 1 << 31;
    for i in 1..32 {
        v[i] = v[i - 1] ^ (v[i - 1] >> 1);
    }
    v[k]
}

#[test]
fn plain_dimensions_are_joe_and_kuos() {
    for index in (0..4096).chain((0..32).map(|b| 1_u32 << b)).chain([u32::MAX, 0xdead_beef]) {
        let by_table = (0..32).filter(|k| index >> k & 1 == 1).fold(0, |x, k| x ^ joe_kuo_second(k));
        assert_eq!(sobol_second(index).reverse_bits(), by_table, "index {index}");
    }
}

#[test]
fn plain_dimensions_and_scramble_are_those_of_sobol_burley() {
    use sobol_burley::parts::{owen_scramble_rev, sobol_rev};
    for index in 0..1_u32 << 16 {
        let reversed = index.reverse_bits();
        assert_eq!(sobol_rev(reversed, 0), index);
        assert_eq!(sobol_rev(reversed, 1), sobol_second(index));
        assert_eq!(owen_scramble_rev(reversed, index ^ 0x1234_5678), laine_karras(reversed, index ^ 0x1234_5678));
    }
}

/// Every elementary interval of area 2⁻ᵏ holds exactly one of 2ᵏ points.
fn assert_net(points: &[[u32; 2]], k: u32) {
    for columns in 0..=k {
        let mut taken = vec![false; 1 << k];
        for [x, y] in points {
            let cell = |v: u32, bits: u32| if bits == 0 { 0 } else { v >> (32 - bits) };
            let index = (cell(*x, columns) << (k - columns)) | cell(*y, k - columns);
            assert!(
                !std::mem::replace(&mut taken[index as usize], true),
                "two points in one interval of {columns}+{}",
                k - columns
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn aligned_runs_are_nets(seed: u32, dimension in 0_u32..64, k in 0_u32..10, run in 0_u32..1000) {
        let points: Vec<_> =
            (0..1 << k).map(|i| sobol_point(((run << k) + i).reverse_bits(), seed, dimension)).collect();
        assert_net(&points, k);
    }

    #[test]
    fn values_are_the_first_coordinate(index: u32, seed: u32, dimension: u32) {
        prop_assert_eq!(sobol_value(index, seed, dimension), sobol_point(index, seed, dimension)[0]);
    }

    #[test]
    fn scrambling_keeps_common_prefixes(a: u32, b: u32, seed: u32) {
        let common = (a ^ b).leading_zeros();
        let scrambled = nested_uniform_scramble(a, seed) ^ nested_uniform_scramble(b, seed);
        prop_assert_eq!(scrambled.leading_zeros(), common);
    }

    #[test]
    fn numbers_are_below_one_and_repeat(index: u32, seed: u32) {
        let draw = |mut s: Sobol| (0..32).map(|_| (s.next_1d(), s.next_2d())).collect::<Vec<_>>();
        let numbers = draw(Sobol::new(index, seed));
        for (a, b) in &numbers {
            prop_assert!([*a, b.x, b.y].iter().all(|x| (0.0..1.0).contains(x)));
        }
        prop_assert_eq!(numbers, draw(Sobol::new(index, seed)));
        let mut independent = Independent::new(index, seed);
        for _ in 0..32 {
            prop_assert!((0.0..1.0).contains(&independent.next_1d()));
        }
    }
}

/// Sets are independent of each other: the product of two numbers from different sets, or from neighbouring pixels,
/// has the mean of the product over seeds. Its standard error is below 1/12/√(64·4096)·2.
#[test]
fn sets_and_pixels_are_uncorrelated() {
    let mean = |f: &dyn Fn(u32, u32) -> f64| {
        let sum: f64 = (0..4096).flat_map(|seed| (0..64).map(move |i| (seed, i))).map(|(s, i)| f(s, i)).sum();
        sum / (64.0 * 4096.0)
    };
    let centred = |i: u32, seed: u32, dimension: u32, axis: usize| {
        f64::from(sobol_point(i.reverse_bits(), seed, dimension)[axis]) / 4_294_967_296.0 - 0.5
    };
    let seed = |s: u32| pt_integrator::sampler::pixel_seed(s, 9);
    for (d, axis, e, other) in [(0, 0, 1, 0), (0, 0, 1, 1), (2, 1, 5, 1), (3, 0, 3, 1)] {
        let product = mean(&|s, i| centred(i, seed(s), d, axis) * centred(i, seed(s), e, other));
        assert!(product.abs() < 1e-3, "sets {d}.{axis} and {e}.{other}: {product}");
        let pixels = mean(&|s, i| centred(i, seed(s), d, axis) * centred(i, seed(s + 1), d, axis));
        assert!(pixels.abs() < 1e-3, "neighbouring pixels, set {d}: {pixels}");
    }
}
