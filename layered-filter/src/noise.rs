//! How wrong the light of a pixel may be, before any filter, as far as its samples and a cache's answers tell.

use bytemuck::{Pod, Zeroable};
use hashcache_core::glam::Vec3;

use crate::image::{Light, is_hole, luminance};
use crate::pixel::{Direct, LayerPixel};

/// A pixel's radiance and the variance of it, both of the luminance, added up over layers (8 bytes). All zeros is the
/// pixel without any.
///
/// The variance is that of the light at vertices: the answers' own where the cache tells it
/// ([`Estimate::variance`](hashcache_core::traits::Estimate::variance)), else that of the samples among each other, taken
/// as independent. What emitters, edges and textures inside a pixel scatter is not in it. +∞: not known, as with one or
/// two samples of a cache that tells nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct NoisePixel {
    /// Luminance of the mean radiance.
    pub radiance: f32,
    /// Variance of that, an error squared; +∞: not known.
    pub variance: f32,
}

impl NoisePixel {
    /// Adds a layer's light. An error is taken to have the colour of its light.
    ///
    /// ```
    /// use bytemuck::Zeroable;
    /// use hashcache_core::{glam::Vec3, record::VertexRecord, traits::Estimate};
    /// use layered_filter::{Direct, GatherParams, LayerPixel, NoisePixel};
    /// let params = GatherParams::new(0.001, Direct::Estimate, 1, 1)?;
    /// let vertex = VertexRecord { throughput: [0.5; 4], flags: VertexRecord::VALID, ..VertexRecord::zeroed() };
    /// let mut sums = LayerPixel::zeroed();
    /// sums.add(&params, &vertex, &Estimate { direct: Vec3::ZERO, further: Vec3::splat(2.0), samples: 9, variance: 0.04 });
    /// let mut pixel = NoisePixel::default();
    /// pixel.add(&sums, Direct::Estimate);
    /// // Half of a light of 2 ± 0.2.
    /// assert!((pixel.radiance - 1.0).abs() < 1e-6 && (pixel.variance - 0.01).abs() < 1e-6);
    /// # Ok::<(), hashcache_core::error::ParamError>(())
    /// ```
    #[inline]
    pub fn add(&mut self, sums: &LayerPixel, direct: Direct) {
        let throughput = sums.mean_throughput();
        self.radiance += luminance(sums.mean_emitted());
        self.carry(throughput, &sums.further_light());
        // Else its sums are 0, and not for lack of samples.
        if direct == Direct::Record {
            self.carry(throughput, &sums.direct_light());
        }
        self.radiance = self.radiance.min(f32::MAX);
    }

    /// Adds a light behind a throughput.
    #[inline]
    fn carry(&mut self, throughput: Vec3, light: &Light) {
        let share = luminance(throughput);
        // False for NaN.
        let passes = share > 0.0;
        if !passes {
            return;
        }
        if is_hole(light) {
            self.variance = f32::INFINITY;
            return;
        }
        let [r, g, b, variance] = *light;
        let light = Vec3::new(r, g, b);
        let (own, carried) = (luminance(light), luminance(throughput * light));
        self.radiance += carried;
        let factor = if own > 0.0 { carried / own } else { share };
        // A colour that the surface swallows leaves nothing of the error either, known or not.
        if factor > 0.0 {
            self.variance += variance * factor * factor;
        }
    }

    /// The standard error of the luminance; +∞: not known.
    #[inline]
    pub fn standard_error(&self) -> f32 {
        hashcache_core::float::sqrt(self.variance)
    }
}
