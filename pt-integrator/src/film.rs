//! Pixels that sum samples.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// A pixel's sum of radiance and number of samples, with what the additions rounded away. 32 bytes.
///
/// # Source
/// Kahan 1965: the mean of 2²⁴ samples is as exact as that of two.
///
/// ```
/// use hashcache_core::glam::Vec3;
/// use pt_integrator::film::FilmPixel;
/// let mut pixel = FilmPixel::default();
/// pixel.add(Vec3::splat(1.0));
/// pixel.add(Vec3::splat(0.5));
/// assert_eq!(pixel.mean().to_array(), [0.75, 0.75, 0.75, 2.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FilmPixel {
    /// Radiance; w: number of samples.
    pub sum: [f32; 4],
    /// What `sum` lacks.
    pub compensation: [f32; 4],
}

impl FilmPixel {
    /// Adds one sample.
    #[inline]
    pub fn add(&mut self, radiance: Vec3) {
        let sum = Vec4::from_array(self.sum);
        let term = radiance.extend(1.0) + Vec4::from_array(self.compensation);
        let next = sum + term;
        self.compensation = (term - (next - sum)).to_array();
        self.sum = next.to_array();
    }

    /// Mean radiance; w: number of samples. Black without samples.
    #[inline]
    pub fn mean(&self) -> Vec4 {
        let sum = Vec4::from_array(self.sum) + Vec4::from_array(self.compensation);
        if sum.w > 0.0 { (sum.truncate() / sum.w).extend(sum.w) } else { Vec4::ZERO }
    }
}
