//! Pixels that sum samples.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::light::luminance;

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

/// A [`FilmPixel`] that also knows how its samples' luminances scatter. 48 bytes.
///
/// # Source
/// Welford 1962: nothing cancels, however small the scatter beside the mean.
///
/// ```
/// use hashcache_core::glam::Vec3;
/// use pt_integrator::film::MomentPixel;
/// let mut pixel = MomentPixel::default();
/// for radiance in [1.0, 3.0] {
///     pixel.add(Vec3::splat(radiance));
/// }
/// // Samples of variance 2, and the mean of two of them.
/// assert!((pixel.variance() - 1.0).abs() < 1e-6);
/// assert_eq!(pixel.film.mean().to_array(), [2.0, 2.0, 2.0, 2.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MomentPixel {
    /// Sum and number of samples.
    pub film: FilmPixel,
    /// Mean luminance; sum of its squared deviations from that; zero; zero.
    pub luminance: [f32; 4],
}

impl MomentPixel {
    /// Adds one sample.
    #[inline]
    pub fn add(&mut self, radiance: Vec3) {
        self.film.add(radiance);
        let [mean, squares, ..] = &mut self.luminance;
        let y = luminance(radiance);
        let off = y - *mean;
        *mean += off / self.film.sum[3];
        // Light of 10¹⁹ and more: the sum stays finite.
        *squares = (*squares + off * (y - *mean)).min(f32::MAX);
    }

    /// Variance of the mean's luminance, taking samples as independent; +∞ with fewer than two, which cannot tell.
    ///
    /// Stratified samples are better than independent ones, so that this is rather too large for them.
    #[inline]
    pub fn variance(&self) -> f32 {
        let n = self.film.sum[3];
        if n < 2.0 { f32::INFINITY } else { self.luminance[1] / (n * (n - 1.0)) }
    }
}

/// A pixel of its own choice with two sums of paths that know nothing of each other: half the squared difference of the
/// two means is an estimate of a mean's variance that stratification cannot spoil. 80 bytes.
///
/// ```
/// use hashcache_core::glam::Vec3;
/// use pt_integrator::film::PairedPixel;
/// let mut pixel = PairedPixel::new(7);
/// pixel.halves[0].add(Vec3::splat(1.0));
/// pixel.halves[1].add(Vec3::splat(2.0));
/// assert_eq!(pixel.means(), [Vec3::splat(1.0), Vec3::splat(2.0)]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PairedPixel {
    /// The two sums.
    pub halves: [FilmPixel; 2],
    /// Index of the pixel in the picture, by rows from the upper left.
    pub pixel: u32,
    /// Zero.
    pub reserved: [u32; 3],
}

impl PairedPixel {
    /// A pixel without samples.
    pub const fn new(pixel: u32) -> Self {
        let empty = FilmPixel { sum: [0.0; 4], compensation: [0.0; 4] };
        Self { halves: [empty; 2], pixel, reserved: [0; 3] }
    }

    /// Both means of radiance; black without samples.
    #[inline]
    pub fn means(&self) -> [Vec3; 2] {
        self.halves.each_ref().map(|half| half.mean().truncate())
    }
}
