//! Sobol' points, Owen-scrambled by hashing, in two-dimensional sets.
//!
//! Every draw is a set of its own: the first two Sobol' dimensions, scrambled, in an order of their own (padding). So
//! one or two numbers drawn together are as well spread as they can be, for any number of dimensions, without tables.
//!
//! # Source
//! Burley 2020 (padding, hash-based nested uniform scrambling); Laine & Karras 2011 (the hash), with the rounds by
//! Vegdahl 2021; Ahmed 2024 (the second dimension in log₂ steps).

use glam::Vec2;
use hashcache_core::hash;
use hashcache_core::traits::Sampler;

/// An Owen-scrambled Sobol' sequence, padded: sample `index` of the sequence that `seed` names.
///
/// Consecutive indices from a multiple of 2ᵏ on, 2ᵏ of them, are stratified: in each dimension alone, and in each pair
/// drawn by one [`Sampler::next_2d`] as a (0, k, 2)-net in base 2.
///
/// ```
/// use hashcache_core::traits::Sampler;
/// use pt_integrator::sampler::Sobol;
/// // Four samples: one number in each quarter.
/// let mut quarters: Vec<u32> = (0..4).map(|i| (Sobol::new(i, 7).next_1d() * 4.0) as u32).collect();
/// quarters.sort_unstable();
/// assert_eq!(quarters, [0, 1, 2, 3]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sobol {
    index_reversed: u32,
    seed: u32,
    dimension: u32,
}

impl Sobol {
    /// The stream of sample `index`; `seed` as made by [`super::pixel_seed`].
    #[inline]
    pub const fn new(index: u32, seed: u32) -> Self {
        Self { index_reversed: index.reverse_bits(), seed, dimension: 0 }
    }
}

impl Sampler for Sobol {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        let value = sobol_value(self.index_reversed, self.seed, self.dimension);
        self.dimension += 1;
        hash::to_unit_f32(value)
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        let [x, y] = sobol_point(self.index_reversed, self.seed, self.dimension);
        self.dimension += 1;
        Vec2::new(hash::to_unit_f32(x), hash::to_unit_f32(y))
    }
}

/// The point of a two-dimensional set, as 0.32 fixed point. `dimension` names the set, `index_reversed` is the
/// sample's index with its bits reversed.
#[inline]
pub const fn sobol_point(index_reversed: u32, seed: u32, dimension: u32) -> [u32; 2] {
    let [order, seed_x, seed_y] = hash::pcg3d([seed, dimension, 0]);
    let index = laine_karras(index_reversed, order).reverse_bits();
    // The first Sobol' dimension is the index with its bits reversed, and scrambling reverses before and after.
    let x = laine_karras(index, seed_x).reverse_bits();
    let y = laine_karras(sobol_second(index), seed_y).reverse_bits();
    [x, y]
}

/// The point of a one-dimensional set, as 0.32 fixed point: the first coordinate of [`sobol_point`].
#[inline]
pub const fn sobol_value(index_reversed: u32, seed: u32, dimension: u32) -> u32 {
    let [order, seed_x, _] = hash::pcg3d([seed, dimension, 0]);
    let index = laine_karras(index_reversed, order).reverse_bits();
    laine_karras(index, seed_x).reverse_bits()
}

/// The second Sobol' dimension of `index` with its bits reversed: Pascal's triangle modulo 2 in five steps.
#[inline]
pub const fn sobol_second(index: u32) -> u32 {
    let mut v = index;
    v ^= v >> 16;
    v ^= (v & 0xff00_ff00) >> 8;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^= (v & 0xaaaa_aaaa) >> 1;
    v
}

/// A permutation of all words in which each bit depends on lower bits only: a nested uniform scramble of reversed bits.
///
/// # Source
/// Laine & Karras 2011; constants and rounds of Vegdahl 2021.
#[inline]
pub const fn laine_karras(x: u32, seed: u32) -> u32 {
    let mut v = x;
    v ^= v.wrapping_mul(0x3d20_adea);
    v = v.wrapping_add(seed);
    v = v.wrapping_mul((seed >> 16) | 1);
    v ^= v.wrapping_mul(0x0552_6c56);
    v ^= v.wrapping_mul(0x53a2_2864);
    v
}

/// Owen scrambling of a 0.32 fixed point number: each bit is flipped or not by a hash of the bits above it.
#[inline]
pub const fn nested_uniform_scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}
