//! Independent random numbers by hashing a counter.

use glam::Vec2;
use hashcache_core::hash;
use hashcache_core::traits::Sampler;

/// Independent uniform numbers: the hash of (seed, sample, dimension). The baseline that [`super::Sobol`] is compared
/// with.
///
/// # Source
/// Jarzynski & Olano 2020, `pcg4d`.
#[derive(Clone, Copy, Debug)]
pub struct Independent {
    index: u32,
    seed: u32,
    dimension: u32,
}

impl Independent {
    /// The stream of sample `index`; `seed` as made by [`super::pixel_seed`].
    #[inline]
    pub const fn new(index: u32, seed: u32) -> Self {
        Self { index, seed, dimension: 0 }
    }

    #[inline]
    fn next(&mut self) -> [u32; 4] {
        let words = hash::pcg4d([self.index, self.seed, self.dimension, 0]);
        self.dimension += 1;
        words
    }
}

impl Sampler for Independent {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        hash::to_unit_f32(self.next()[0])
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        let [x, y, ..] = self.next();
        Vec2::new(hash::to_unit_f32(x), hash::to_unit_f32(y))
    }
}
