//! A pixel's sums over its samples: what tracing and the cache told about it, until the filter runs.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::image::{HOLE, Light, luminance};

/// The least throughput with which illumination is weighted inside a pixel, 2⁻²⁰: a channel that reflects nothing
/// keeps an illumination that its neighbours can use, and adds less than a millionth of it to its own pixel's mean.
pub const LEAST_THROUGHPUT: f32 = 1.0 / 1_048_576.0;

/// Samples from which on a pixel's own variance is believed; below, it counts as unknown. Three differences of four
/// samples know the variance to about ±80 %, fewer tell almost nothing (SVGF draws the line at four, too).
pub const LEAST_VARIANCE_SAMPLES: f32 = 4.0;

/// Where a pixel's direct light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direct {
    /// [`VertexRecord::direct`], traced for this sample: an image of its own.
    Record,
    /// The estimate's: added to the further light, one image for all.
    Estimate,
}

/// How records and estimates are read; the parameter block of the kernel `lf.gather` (16 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GatherParams {
    recip_pixel_angle: f32,
    record_stride: u32,
    estimate_stride: u32,
    /// Bit 0: direct light from the record; from bit 8 on: the layer.
    direct_layer: u32,
}

/// First bit of the layer in [`GatherParams`]' last word.
const LAYER_SHIFT: u32 = 8;

impl GatherParams {
    /// Parameters for records of a camera whose pixels have the angle `pixel_angle` = 2·tan(`fov_y`/2)/height, where
    /// item i reads record i·`record_stride` and estimate i·`estimate_stride`, in the first layer.
    ///
    /// # Errors
    /// [`ParamError`] when the angle is not between 10⁻⁹ and 4 or a stride is 0.
    pub fn new(pixel_angle: f32, direct: Direct, record_stride: u32, estimate_stride: u32) -> Result<Self, ParamError> {
        ParamError::check_range("pixel_angle", f64::from(pixel_angle), 1e-9, 4.0)?;
        let most = f64::from(u32::MAX);
        ParamError::check_range("record_stride", f64::from(record_stride), 1.0, most)?;
        ParamError::check_range("estimate_stride", f64::from(estimate_stride), 1.0, most)?;
        let direct_layer = u32::from(direct == Direct::Record);
        Ok(Self { recip_pixel_angle: 1.0 / pixel_angle, record_stride, estimate_stride, direct_layer })
    }

    /// Index of item `item`'s record.
    #[inline]
    pub const fn record_of(&self, item: u32) -> usize {
        item as usize * self.record_stride as usize + self.layer() as usize
    }

    /// Index of item `item`'s estimate.
    #[inline]
    pub const fn estimate_of(&self, item: u32) -> usize {
        item as usize * self.estimate_stride as usize + self.layer() as usize
    }

    /// The layer that is read: records and estimates are those so many behind the item's first.
    #[inline]
    pub const fn layer(&self) -> u32 {
        self.direct_layer >> LAYER_SHIFT
    }

    /// The same for another layer, at most 2²⁴ − 1.
    #[must_use]
    pub const fn with_layer(mut self, layer: u32) -> Self {
        self.direct_layer = (self.direct_layer & 1) | (layer << LAYER_SHIFT);
        self
    }

    /// Path length of a record's vertex in scene units.
    #[inline]
    pub(crate) fn distance(&self, record: &VertexRecord) -> f32 {
        record.position_footprint[3] * self.recip_pixel_angle
    }

    /// The same with other strides; 0 counts as 1.
    #[must_use]
    pub const fn with_strides(mut self, record_stride: u32, estimate_stride: u32) -> Self {
        self.record_stride = if record_stride == 0 { 1 } else { record_stride };
        self.estimate_stride = if estimate_stride == 0 { 1 } else { estimate_stride };
        self
    }

    /// Where direct light comes from.
    pub const fn direct(&self) -> Direct {
        if self.direct_layer & 1 == 0 { Direct::Estimate } else { Direct::Record }
    }
}

/// Sums over a pixel's samples (128 bytes). All zeros is the empty sum.
///
/// C is a sample's throughput, at least [`LEAST_THROUGHPUT`]; E its illumination; Y(E) the luminance of that.
/// A *hole* is a vertex that a cache was asked for in vain and that brought no light of its own: it adds guides
/// and, where that was traced, direct light.
///
/// | bytes | field | xyz | w |
/// |---|---|---|---|
/// | 0..16 | `direct` | Σ C·E of direct light | Σ Y(E)² |
/// | 16..32 | `further` | Σ C·E of the cache's light (all light, when none is apart) | Σ Y(E)², or of the variances told |
/// | 32..48 | `throughput` | Σ C of vertices | Σ Y(E) of direct light |
/// | 48..64 | `answered` | Σ C of vertices with an answer | Σ Y(E) of the cache's light |
/// | 64..80 | `emitted` | Σ emitted | Σ samples behind the answers |
/// | 80..96 | `normal` | Σ normal | number of answers |
/// | 96..112 | `position` | Σ position | Σ path length |
/// | 112..128 | `counts` | samples, vertices, holes | values left out; bit 31: [`LayerPixel::TOLD`] |
///
/// Sums are f32: after n samples they are off by about √n·2⁻²⁵ of themselves (10⁻⁵ after 10⁵ samples).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LayerPixel {
    /// Σ C·E of light traced directly; w: Σ Y(E)².
    pub direct: [f32; 4],
    /// Σ C·E of the cache's light; w: Σ Y(E)², or the sum of the variances that the cache told.
    pub further: [f32; 4],
    /// Σ C over the vertices; w: Σ Y(E) of `direct`.
    pub throughput: [f32; 4],
    /// Σ C over the vertices with an answer; w: Σ Y(E) of `further`.
    pub answered: [f32; 4],
    /// Σ of the light that bypasses the vertices; w: Σ of the samples behind the cache's answers.
    pub emitted: [f32; 4],
    /// Σ of unit normals; w: number of vertices with an answer.
    pub normal: [f32; 4],
    /// Σ of positions in scene units; w: Σ of path lengths.
    pub position: [f32; 4],
    /// Number of samples, of vertices among them, of holes among those, and of values that were left out because they
    /// were NaN, infinite or negative, with [`LayerPixel::TOLD`].
    pub counts: [u32; 4],
}

impl LayerPixel {
    /// Bit of the last count: the cache told variances ([`Estimate::variance`]), and what stands in place of Σ Y(E)² is their
    /// sum. An answer without one among them adds Y(E)², more than its variance as a rule.
    pub const TOLD: u32 = 1 << 31;

    /// Adds a sample. Values that are NaN, infinite or negative are left out and counted; returns whether all were fine.
    #[inline]
    pub fn add(&mut self, params: &GatherParams, record: &VertexRecord, estimate: &Estimate) -> bool {
        let before = self.left_out();
        self.counts[0] = self.counts[0].saturating_add(1);
        self.add_emitted(record);
        if record.is_valid() {
            self.add_vertex(params, record, estimate);
        }
        self.left_out() == before
    }

    #[inline]
    fn add_emitted(&mut self, record: &VertexRecord) {
        let emitted = xyz(&record.emitted);
        if is_light(emitted) {
            accumulate(&mut self.emitted, emitted, 0.0);
        } else {
            self.leave_out();
        }
    }

    #[inline]
    fn add_vertex(&mut self, params: &GatherParams, record: &VertexRecord, estimate: &Estimate) {
        let (throughput, position) = (xyz(&record.throughput), xyz(&record.position_footprint));
        let distance = params.distance(record);
        // A vertex without a place or with a broken throughput is no guide and cannot be weighted.
        if !is_light(throughput) || !position.is_finite() || !(0.0..=f32::MAX).contains(&distance) {
            return self.leave_out();
        }
        let c = throughput.max(Vec3::splat(LEAST_THROUGHPUT));
        self.counts[1] = self.counts[1].saturating_add(1);
        accumulate(&mut self.normal, record.normal(), 0.0);
        accumulate(&mut self.position, position, distance);

        let (direct, light) = match params.direct() {
            Direct::Record => (xyz(&record.direct), estimate.further),
            Direct::Estimate => (Vec3::ZERO, estimate.direct + estimate.further),
        };
        // A direct light that is broken counts as black: the vertex's throughput stands for both images.
        let direct = if is_light(direct) {
            direct
        } else {
            self.leave_out();
            Vec3::ZERO
        };
        let y = luminance(direct);
        accumulate(&mut self.direct, c * direct, y * y);
        accumulate(&mut self.throughput, c, y);

        if estimate.samples == 0 && record.flags & VertexRecord::VISIBLE_ONLY != 0 {
            self.counts[2] = self.counts[2].saturating_add(1);
        } else if is_light(light) {
            let y = luminance(light);
            // False for NaN.
            let told = estimate.variance > 0.0;
            self.counts[3] |= if told { Self::TOLD } else { 0 };
            accumulate(&mut self.further, c * light, if told { estimate.variance } else { y * y });
            accumulate(&mut self.answered, c, y);
            self.normal[3] += 1.0;
            self.emitted[3] += estimate.samples as f32;
        } else {
            self.leave_out();
        }
    }

    fn leave_out(&mut self) {
        let most = Self::TOLD - 1;
        self.counts[3] += u32::from(self.left_out() < most);
    }

    /// Number of values that were left out because they were NaN, infinite or negative.
    #[inline]
    pub const fn left_out(&self) -> u32 {
        self.counts[3] & !Self::TOLD
    }

    /// Whether any sample met a vertex.
    #[inline]
    pub const fn has_vertex(&self) -> bool {
        self.counts[1] > 0
    }

    /// Mean direct illumination, weighted by throughput, and the variance of that mean's luminance; black with an
    /// unknown variance without a vertex.
    #[inline]
    pub fn direct_light(&self) -> Light {
        mean_light(&self.direct, &self.throughput, self.counts[1] as f32)
    }

    /// Mean illumination by the cache, weighted by throughput, and the variance of that mean's luminance;
    /// a hole ([`HOLE`]) when vertices were met and none got an answer.
    ///
    /// A variance that the cache told is the mean of its answers' variances and does not shrink with their number: answers
    /// inside a pixel read the same cells. Else it is that of the answers among each other, taken as independent.
    #[inline]
    pub fn further_light(&self) -> Light {
        if self.has_vertex() && self.normal[3] == 0.0 {
            return [0.0, 0.0, 0.0, HOLE];
        }
        let n = self.normal[3];
        let mut light = mean_light(&self.further, &self.answered, n);
        if self.counts[3] & Self::TOLD != 0 && n > 0.0 {
            light[3] = self.further[3] / n;
        }
        light
    }

    /// Mean throughput over all samples, those without a vertex included: what the filtered illumination is
    /// multiplied by. A channel of nothing but [`LEAST_THROUGHPUT`] is 0.
    #[inline]
    pub fn mean_throughput(&self) -> Vec3 {
        let least = self.counts[1] as f32 * (LEAST_THROUGHPUT * 1.001);
        let sum = xyz(&self.throughput);
        let sum = Vec3::select(sum.cmpgt(Vec3::splat(least)), sum, Vec3::ZERO);
        sum / (self.counts[0].max(1) as f32)
    }

    /// Mean number of the cache's samples behind an answer; 0 without one.
    #[inline]
    pub const fn support(&self) -> f32 {
        if self.normal[3] > 0.0 { self.emitted[3] / self.normal[3] } else { 0.0 }
    }

    /// Mean of the light that bypasses the vertices, over all samples.
    #[inline]
    pub fn mean_emitted(&self) -> Vec3 {
        xyz(&self.emitted) / (self.counts[0].max(1) as f32)
    }
}

/// Σ C·E / Σ C, and the variance of the mean of `n` luminances.
#[inline]
fn mean_light(sums: &[f32; 4], weights: &[f32; 4], n: f32) -> Light {
    if n == 0.0 {
        return [0.0, 0.0, 0.0, f32::INFINITY];
    }
    let mean = xyz(sums) / xyz(weights);
    let y = weights[3] / n;
    let variance = if n < LEAST_VARIANCE_SAMPLES {
        f32::INFINITY
    } else {
        // NaN, from sums beyond f32, becomes 0 by `max`.
        (sums[3] / n - y * y).max(0.0) / (n - 1.0)
    };
    mean.extend(variance).to_array()
}

/// Adds, and stays finite: light of 10¹⁹ has a square beyond f32.
#[inline]
pub(crate) fn accumulate(sum: &mut [f32; 4], v: Vec3, w: f32) {
    let next = xyz(sum) + v;
    *sum = next.extend(sum[3] + w).min(hashcache_core::glam::Vec4::splat(f32::MAX)).to_array();
}

/// Finite and not negative.
#[inline]
pub(crate) fn is_light(v: Vec3) -> bool {
    v.is_finite() && v.min_element() >= 0.0
}

#[inline]
pub(crate) fn xyz(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
