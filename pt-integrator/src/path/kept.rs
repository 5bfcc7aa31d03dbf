//! The vertices of a path that are kept, as far as the loop needs them.

use core::ops::Range;

use glam::Vec3;

/// How light found further on is weighted: at the camera, and at up to `STORE` kept vertices.
// An array of one lives in registers.
pub(super) struct Kept<const STORE: usize> {
    /// From the camera to the first kept vertex, or to the path's end as long as none is kept; over the probabilities of
    /// all choices.
    throughput: Vec3,
    /// For each kept vertex, the product of the albedos behind it, over the probabilities of all choices.
    weights: [Vec3; STORE],
    /// The scattering at which each was kept.
    at: [usize; STORE],
    count: usize,
}

impl<const STORE: usize> Kept<STORE> {
    /// No vertex yet.
    #[inline(always)]
    pub fn new(throughput: Vec3) -> Self {
        Self { throughput, weights: [Vec3::ONE; STORE], at: [0; STORE], count: 0 }
    }

    /// How many are kept.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Multiplies all that is found from now on.
    #[inline(always)]
    pub fn scale(&mut self, factor: Vec3) {
        if self.count == 0 {
            self.throughput *= factor;
        }
        for weight in self.weights.iter_mut().take(self.count) {
            *weight *= factor;
        }
    }

    /// Divides all that is found from now on.
    // Not the product with the inverse: that rounds twice.
    #[inline(always)]
    pub fn divide(&mut self, divisor: f32) {
        if self.count == 0 {
            self.throughput /= divisor;
        }
        for weight in self.weights.iter_mut().take(self.count) {
            *weight /= divisor;
        }
    }

    /// Keeps the vertex of scattering `depth`; returns its place and its throughput from the camera.
    #[inline(always)]
    pub fn keep(&mut self, depth: usize) -> (usize, Vec3) {
        let place = if STORE == 1 { 0 } else { self.count };
        self.at[place] = depth;
        self.count += 1;
        (place, if place == 0 { self.throughput } else { self.throughput * self.weights[0] })
    }

    /// Weight of light at the last kept vertex, the largest of all; at the camera as long as none is kept.
    #[inline(always)]
    pub fn last(&self) -> Vec3 {
        match self.count {
            0 => self.throughput,
            _ if STORE == 1 => self.weights[0],
            count => self.weights[count - 1],
        }
    }

    /// Weight of light at the camera.
    #[inline(always)]
    pub fn at_camera(&self) -> Vec3 {
        if self.count == 0 { self.throughput } else { self.throughput * self.weights[0] }
    }

    /// The kept vertices that light found at scattering `depth` still reaches, through `length` scatterings.
    #[inline(always)]
    pub fn reached(&self, depth: usize, length: usize) -> Range<usize> {
        if STORE == 1 {
            return 0..self.count.min(1);
        }
        let kept = &self.at[..self.count];
        kept.iter().position(|&at| depth - at <= length).unwrap_or(kept.len())..kept.len()
    }

    /// Weight of light at a kept vertex, and whether the vertex of scattering `depth` is the same.
    #[inline(always)]
    pub fn of(&self, place: usize, depth: usize) -> (Vec3, bool) {
        (self.weights[place], self.at[place] == depth)
    }
}
