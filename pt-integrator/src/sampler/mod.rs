//! Random numbers for paths: stratified ([`Sobol`]) and independent ([`Independent`]).
//!
//! Both are functions of (seed, sample, dimension): no state is shared between paths, so any thread may trace any
//! path. The pixel's number goes into the seed by [`pixel_seed`].

mod independent;
mod sobol;

pub use independent::Independent;
pub use sobol::{Sobol, laine_karras, nested_uniform_scramble, sobol_point, sobol_second, sobol_value};

use hashcache_core::hash;

/// The seed of one pixel's stream: pixels draw uncorrelated numbers, frames with another `seed` others.
#[inline]
pub const fn pixel_seed(pixel: u32, seed: u32) -> u32 {
    hash::pcg2d([pixel, seed])[0]
}

/// The seed of a vertex's own random decisions, unlike all numbers that traced the path.
#[inline]
pub const fn vertex_seed(pixel_seed: u32, sample: u32) -> u32 {
    hash::finish(hash::mix(pixel_seed, sample))
}
