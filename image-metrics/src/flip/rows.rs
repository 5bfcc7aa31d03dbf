//! One image as the eye sees it, row by row.

use super::color::{Hunt, Opponent, to_hunt};
use super::kernels::{BLUR_RADIUS, FEATURE_RADIUS, Kernels};
use crate::ImageView;

/// A pixel as the eye sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    /// The blurred colour.
    pub color: Hunt,
    /// Strength of an edge, of luminance 0 to 1.
    pub edge: f64,
    /// Strength of a point or line, of luminance 0 to 1.
    pub point: f64,
}

/// Quantities filtered sideways: four blurs (Y, Cx, Cz twice), luminance by a Gaussian and its two derivatives.
const CHANNELS: usize = 7;
/// Rows that a vertical filter reads.
const RING: usize = 2 * BLUR_RADIUS + 1;

/// Filters an image by separable kernels. Each row is filtered sideways once and kept while a vertical filter needs
/// it, so memory goes by the width.
pub(super) struct FilteredRows<'a> {
    image: ImageView<'a>,
    kernels: Kernels,
    /// Row y filtered sideways, at y modulo [`RING`]: a run of the width for each channel.
    ring: Vec<f64>,
    /// The next row to filter sideways.
    next_input: usize,
    /// The next row to give out.
    next_output: usize,
    /// Y, Cx, Cz, luminance of a row whose ends are repeated on both sides.
    padded: [Vec<f64>; 4],
    /// The vertical sums: as many runs as there are quantities in the end.
    sums: Vec<f64>,
    seen: Vec<Seen>,
}

/// Vertical sums: Y, Cx, Cz; edge sideways, edge upwards, point sideways, point upwards.
const SUMS: usize = 7;

impl<'a> FilteredRows<'a> {
    pub fn new(image: ImageView<'a>) -> Self {
        let width = image.width();
        Self {
            image,
            kernels: Kernels::new(),
            ring: vec![0.0; RING * CHANNELS * width],
            next_input: 0,
            next_output: 0,
            padded: core::array::from_fn(|_| vec![0.0; width + 2 * BLUR_RADIUS]),
            sums: vec![0.0; SUMS * width],
            seen: vec![Seen::default(); width],
        }
    }

    /// The next row from the top, or `None` below the last.
    pub fn next_row(&mut self) -> Option<&[Seen]> {
        let (y, height) = (self.next_output, self.image.height());
        if y == height {
            return None;
        }
        while self.next_input < height.min(y + BLUR_RADIUS + 1) {
            self.filter_sideways();
        }
        self.filter_upwards();
        self.next_output += 1;
        Some(&self.seen)
    }

    fn filter_sideways(&mut self) {
        let (y, width) = (self.next_input, self.image.width());
        let row = &self.image.pixels()[y * width..][..width];
        for (x, pixel) in row.iter().enumerate() {
            let color = Opponent::from_linear(pixel.map(|c| f64::from(c).clamp(0.0, 1.0)));
            let [luma, red_green, blue_yellow] = color.0;
            for (out, value) in self.padded.iter_mut().zip([luma, red_green, blue_yellow, color.luminance()]) {
                out[BLUR_RADIUS + x] = value;
            }
        }
        for run in &mut self.padded {
            let (first, last) = (run[BLUR_RADIUS], run[BLUR_RADIUS + width - 1]);
            run[..BLUR_RADIUS].fill(first);
            run[BLUR_RADIUS + width..].fill(last);
        }
        let slot = &mut self.ring[y % RING * CHANNELS * width..][..CHANNELS * width];
        let (blurs, features) = slot.split_at_mut(4 * width);
        for ((run, blur), channel) in blurs.chunks_exact_mut(width).zip(&self.kernels.blurs).zip([0, 1, 2, 2]) {
            convolve(run, &self.padded[channel], blur);
        }
        let luminance = &self.padded[3][BLUR_RADIUS - FEATURE_RADIUS..];
        for (run, feature) in features.chunks_exact_mut(width).zip(&self.kernels.features) {
            convolve(run, luminance, feature);
        }
        self.next_input += 1;
    }

    fn filter_upwards(&mut self) {
        let (y, width, last) = (self.next_output, self.image.width(), self.image.height() - 1);
        let Kernels { blurs, blue_yellow, features } = &self.kernels;
        let [gaussian, first, second] = features;
        // From which channel, by which kernel, scaled by what, to which sum.
        let steps: [(usize, &[f64], f64, usize); 8] = [
            (0, &blurs[0], 1.0, 0),
            (1, &blurs[1], 1.0, 1),
            (2, &blurs[2], blue_yellow[0], 2),
            (3, &blurs[3], blue_yellow[1], 2),
            (5, gaussian, 1.0, 3),
            (4, first, 1.0, 4),
            (6, gaussian, 1.0, 5),
            (4, second, 1.0, 6),
        ];
        self.sums.fill(0.0);
        for (channel, kernel, scale, sum) in steps {
            let out = &mut self.sums[sum * width..][..width];
            for (i, k) in kernel.iter().enumerate() {
                let source = (y + i).saturating_sub(kernel.len() / 2).min(last);
                let run = &self.ring[(source % RING * CHANNELS + channel) * width..][..width];
                add_scaled(out, run, k * scale);
            }
        }
        for (x, seen) in self.seen.iter_mut().enumerate() {
            let sum = |i: usize| self.sums[i * width + x];
            *seen = Seen {
                color: to_hunt(Opponent([sum(0), sum(1), sum(2)])),
                edge: sum(3).hypot(sum(4)),
                point: sum(5).hypot(sum(6)),
            };
        }
    }
}

/// `out[x]` = Σ kernel[i]·padded[x + i].
fn convolve(out: &mut [f64], padded: &[f64], kernel: &[f64]) {
    out.fill(0.0);
    for (i, k) in kernel.iter().enumerate() {
        add_scaled(out, &padded[i..], *k);
    }
}

/// Adds `factor` times each value.
fn add_scaled(out: &mut [f64], values: &[f64], factor: f64) {
    for (out, value) in out.iter_mut().zip(values) {
        *out += factor * value;
    }
}
