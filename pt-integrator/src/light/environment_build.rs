//! The tables behind [`EnvironmentView`](super::EnvironmentView).

use alloc::vec::Vec;

use glam::Vec3;
use hashcache_core::float;

use super::{EnvironmentView, guide_buckets, luminance};
use crate::scene::EnvironmentImage;

/// Cumulative probabilities of an environment image's patches.
#[derive(Clone, Debug, Default)]
pub struct EnvironmentTables {
    /// See [`EnvironmentView::row_density`].
    pub row_density: Vec<f32>,
    /// See [`EnvironmentView::rows`].
    pub rows: Vec<f32>,
    /// See [`EnvironmentView::columns`].
    pub columns: Vec<f32>,
    /// See [`EnvironmentView::guides`].
    pub guides: Vec<u32>,
    /// Integral of the luminance over all directions (times the sine's mean over rows), in the image's unit times
    /// steradian.
    pub flux: f64,
}

impl EnvironmentTables {
    /// The tables of an image, or `None` when it is black, is empty, or has another number of texels than
    /// `width · height`.
    pub fn new(image: &EnvironmentImage) -> Option<Self> {
        let (width, height) = (image.width as usize, image.height as usize);
        if width == 0 || height == 0 || image.texels.len() != width * height {
            return None;
        }
        let light = |x: usize, y: usize| {
            let t = image.texels[y * width + x];
            let l = luminance(Vec3::new(t[0], t[1], t[2]));
            if l.is_finite() { f64::from(l.max(0.0)) } else { 0.0 }
        };
        let mut columns = Vec::with_capacity(width * (height + 1));
        let mut row_weights = Vec::with_capacity(height + 1);
        let mut mean_sines = Vec::with_capacity(height + 1);
        let mut weights = Vec::with_capacity(width);
        for row in 0..=height {
            let (upper, lower) = (row.max(1) - 1, row.min(height - 1));
            weights.clear();
            weights.extend((0..width).map(|x| {
                let right = if x + 1 == width { 0 } else { x + 1 };
                (light(x, upper) + light(right, upper) + light(x, lower) + light(right, lower)) / 4.0
            }));
            let sum = cumulate(&weights, &mut columns);
            // The sine's integral over the row's span of v ∈ [0, 1], and the span.
            let border = |y: f64| (y / height as f64).clamp(0.0, 1.0);
            let (top, bottom) = (border(row as f64 - 0.5), border(row as f64 + 0.5));
            let sine = sine_integral(top, bottom);
            mean_sines.push(sine / (bottom - top));
            row_weights.push(sum / width as f64 * sine);
        }
        let mut rows = Vec::with_capacity(height + 1);
        let total = cumulate(&row_weights, &mut rows);
        if total <= 0.0 {
            return None;
        }
        let flux = total * 2.0 * core::f64::consts::PI * core::f64::consts::PI;
        let row_density = mean_sines.iter().map(|s| (s / flux) as f32).collect();
        let buckets = guide_buckets(width);
        let mut guides = Vec::with_capacity(buckets * (height + 2));
        for table in columns.chunks_exact(width).chain([rows.as_slice()]) {
            guide(table, buckets, &mut guides);
        }
        Some(Self { row_density, rows, columns, guides, flux })
    }

    /// The image with its tables, ready to be sampled.
    pub fn view<'a>(&'a self, image: &'a EnvironmentImage) -> EnvironmentView<'a> {
        EnvironmentView {
            width: image.width,
            height: image.height,
            texels: &image.texels,
            row_density: &self.row_density,
            rows: &self.rows,
            columns: &self.columns,
            guides: &self.guides,
            rotation: [1.0, 0.0],
        }
    }
}

/// ∫ sin(πv) dv from `top` to `bottom`: (cos πa − cos πb)/π as a product, which keeps thin rows exact.
fn sine_integral(top: f64, bottom: f64) -> f64 {
    let half = core::f64::consts::FRAC_PI_2;
    let sin = |x: f64| f64::from(float::sin(x as f32));
    2.0 * sin((top + bottom) * half) * sin((bottom - top) * half) / core::f64::consts::PI
}

/// Appends, for each of `buckets` equal parts of `[0, 1)`, the first entry of a cumulative table that is above the
/// part's start.
fn guide(cumulative: &[f32], buckets: usize, guides: &mut Vec<u32>) {
    let mut entry = 0;
    for bucket in 0..buckets {
        let start = bucket as f32 / buckets as f32;
        // The last entry is 1, above every start.
        while cumulative[entry] <= start {
            entry += 1;
        }
        guides.push(entry as u32);
    }
}

/// Appends the weights' running sums over their total and returns the total.
fn cumulate(weights: &[f64], table: &mut Vec<f32>) -> f64 {
    let total: f64 = weights.iter().sum();
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    let mut sum = 0.0;
    let last = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
    table.extend(weights.iter().enumerate().map(|(i, weight)| {
        sum += weight;
        // 1 from the last weight above 0 on: no number below 1 may choose an entry behind it.
        if i >= last { 1.0 } else { ((sum * scale) as f32).min(1.0) }
    }));
    total
}
