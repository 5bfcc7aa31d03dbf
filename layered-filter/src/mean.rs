//! The inner loop: a weighted mean of a pixel's neighbours, four at a time.

use hashcache_core::glam::{Mat4, Vec3, Vec4};

use crate::guide::PreparedGuide;
use crate::image::{LARGEST, Light, is_hole};
use crate::weights::{LuminanceAround, Weights};

/// A pixel that is being filtered, and the mean so far.
///
/// Differences to the pixel's own value are summed, so that equal values give that value to the bit. Lanes are added in
/// one order at the end.
pub(crate) struct Mean<'a> {
    weights: &'a Weights,
    guide: &'a PreparedGuide,
    around: LuminanceAround,
    base: Vec3,
    own_weight: f32,
    own_variance: f32,
    sums: [Vec4; 3],
    total: Vec4,
    variance: Vec4,
}

impl<'a> Mean<'a> {
    /// Starts with a pixel's own value at weight 1, or with nothing for a hole.
    #[inline(always)]
    pub(crate) fn new(weights: &'a Weights, guide: &'a PreparedGuide, own: &Light, around: LuminanceAround) -> Self {
        let hole = is_hole(own);
        let [r, g, b, variance] = *own;
        Self {
            weights,
            guide,
            around,
            base: if hole { Vec3::ZERO } else { Vec3::new(r, g, b) },
            own_weight: if hole { 0.0 } else { 1.0 },
            own_variance: if hole { 0.0 } else { variance },
            sums: [Vec4::ZERO; 3],
            total: Vec4::ZERO,
            variance: Vec4::ZERO,
        }
    }

    /// Adds four neighbours, each with a factor (0: none). Holes, and light that is not finite, are left out.
    #[inline(always)]
    pub(crate) fn add(&mut self, guides: [&PreparedGuide; 4], lights: [&Light; 4], factor: Vec4) {
        let [a, b, c, d] = lights.map(|light| Vec4::from_array(*light));
        let lights = Mat4::from_cols(a, b, c, d).transpose();
        let (r, g, b, variance) = (lights.x_axis, lights.y_axis, lights.z_axis, lights.w_axis);
        let luminance = r * 0.2126 + g * 0.7152 + b * 0.0722;
        let weight =
            self.weights.guides_of_four(self.guide, guides) * self.around.weight_of_four(luminance, variance) * factor;
        // All false for NaN.
        let valid = variance.cmpge(Vec4::ZERO) & luminance.abs().cmple(Vec4::splat(LARGEST)) & weight.cmpgt(Vec4::ZERO);
        // What is left out must not reach a product: 0·∞ is NaN.
        let only = |v| Vec4::select(valid, v, Vec4::ZERO);
        let weight = only(weight);
        self.sums[0] += only(r - self.base.x) * weight;
        self.sums[1] += only(g - self.base.y) * weight;
        self.sums[2] += only(b - self.base.z) * weight;
        self.total += weight;
        self.variance += only(variance) * (weight * weight);
    }

    /// The mean and the variance of it, as of independent values; `None` without any.
    #[inline(always)]
    pub(crate) fn finish(&self) -> Option<Light> {
        let total = self.own_weight + self.total.element_sum();
        // Not above 0 for NaN either.
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let recip = 1.0 / total;
        let sum = Vec3::from_array(self.sums.map(Vec4::element_sum));
        let variance = (self.own_variance + self.variance.element_sum()) * (recip * recip);
        // An unknown variance at a weight whose square is 0 gives NaN: unknown it is.
        let variance = if variance.is_nan() { f32::INFINITY } else { variance };
        // A difference of large numbers may end an ulp below 0.
        Some((self.base + sum * recip).max(Vec3::ZERO).extend(variance).to_array())
    }
}

/// Adds the neighbours at four indices.
#[inline(always)]
pub(crate) fn add_at(mean: &mut Mean<'_>, guides: &[PreparedGuide], input: &[Light], at: [usize; 4], factor: Vec4) {
    mean.add(at.map(|q| &guides[q]), at.map(|q| &input[q]), factor);
}
