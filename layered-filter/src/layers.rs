//! Layer by layer: each bounce is filtered with its own guides before it is carried to the bounce in front.
//!
//! # Source
//! Roth et al. 2020, section 3.4.

use hashcache_core::glam::Vec3;

use crate::denoiser::{Denoiser, filter};
use crate::fill::{Filled, fill};
use crate::guide::{GuideRecord, PreparedGuide};
use crate::image::{Light, View, is_hole};
use crate::weights::Weights;

/// One layer of an image: the i-th vertices of all pixels' paths.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// What the vertices are: albedo Cᵢ and throughput Tᵢ are taken from here.
    pub records: &'a [GuideRecord],
    /// The guides of `records`, by [`PreparedGuide::new`].
    pub guides: &'a [PreparedGuide],
    /// Illumination Eᵢ found at the vertices themselves; black where light only passes on.
    pub illumination: &'a [Light],
}

/// Working memory of the composition: three images.
#[derive(Debug)]
pub struct Scratch<'a> {
    /// The layer at work: Aᵢ.
    pub filtered: &'a mut [Light],
    /// What the layers behind send to the one at work.
    pub carried: &'a mut [Light],
    /// What a pass writes.
    pub pass: &'a mut [Light],
}

/// Filters the layers, deepest first, and writes the radiance that leaves the first vertices to `radiance` (rgb, 0);
/// returns the number of holes that stayed holes.
///
/// Deepest first, Aᵢ = filter(Eᵢ + carriedᵢ), carriedᵢ₋₁ = Aᵢ·Cᵢ·Tᵢ₋₁; the result is A₁·C₁. `layers[0]` is the
/// first vertex. Holes in Eᵢ are filled by `weights` first; what stays a hole counts as black.
///
/// # Panics
/// When a slice has another number of pixels than `width` × `height`.
pub fn compose_layers<D: Denoiser + ?Sized>(
    denoiser: &D,
    weights: &Weights,
    [width, height]: [u32; 2],
    layers: &[Layer<'_>],
    scratch: &mut Scratch<'_>,
    radiance: &mut [Light],
) -> u32 {
    compose(denoiser, weights, [width, height], layers, scratch, radiance, layers.len())
}

/// The same light without a look behind the first vertex: layers are carried forward unfiltered, and the filter runs once,
/// with the first layer's guides. What [`compose_layers`] is compared with.
///
/// # Panics
/// When a slice has another number of pixels than `width` × `height`.
pub fn compose_screen<D: Denoiser + ?Sized>(
    denoiser: &D,
    weights: &Weights,
    [width, height]: [u32; 2],
    layers: &[Layer<'_>],
    scratch: &mut Scratch<'_>,
    radiance: &mut [Light],
) -> u32 {
    compose(denoiser, weights, [width, height], layers, scratch, radiance, 1)
}

/// Carries all layers forward; the front `filtered` of them are filtered on the way.
fn compose<D: Denoiser + ?Sized>(
    denoiser: &D,
    weights: &Weights,
    [width, height]: [u32; 2],
    layers: &[Layer<'_>],
    scratch: &mut Scratch<'_>,
    radiance: &mut [Light],
    filtered: usize,
) -> u32 {
    let mut empty = 0;
    scratch.carried.fill([0.0; 4]);
    for (i, layer) in layers.iter().enumerate().rev() {
        let view = View::new(width, height, layer.guides).expect("as many guides as pixels");
        empty += gather_layer(weights, &view, layer, scratch);
        if i < filtered {
            filter(denoiser, &view, scratch.filtered, scratch.pass);
        }
        let front = i.checked_sub(1).map(|front| layers[front].records);
        carry(layer.records, front, scratch.filtered, scratch.carried);
    }
    radiance.copy_from_slice(scratch.carried);
    empty
}

/// `filtered` = Eᵢ with its holes filled + carried.
fn gather_layer(weights: &Weights, view: &View<'_>, layer: &Layer<'_>, scratch: &mut Scratch<'_>) -> u32 {
    assert!(layer.illumination.len() == view.pixels(), "as much illumination as pixels");
    let mut empty = 0;
    let mut i = 0;
    for y in 0..view.height() {
        for x in 0..view.width() {
            let (mut light, filled) = fill(weights, view, layer.illumination, x, y);
            if filled == Filled::Empty {
                empty += 1;
                light = [0.0, 0.0, 0.0, f32::INFINITY];
            }
            let carried = &scratch.carried[i];
            for channel in 0..3 {
                light[channel] += carried[channel];
            }
            // Variances of independent parts add up.
            light[3] += carried[3];
            scratch.filtered[i] = light;
            i += 1;
        }
    }
    empty
}

/// `carried` = Aᵢ·Cᵢ·Tᵢ₋₁, with T = 1 in front of the first vertex.
fn carry(records: &[GuideRecord], front: Option<&[GuideRecord]>, filtered: &[Light], carried: &mut [Light]) {
    for (i, (record, light)) in records.iter().zip(filtered).enumerate() {
        let [r, g, b, shininess] = record.albedo_shininess;
        if shininess.is_nan() || shininess < 0.0 || is_hole(light) {
            carried[i] = [0.0; 4];
            continue;
        }
        let mut factor = Vec3::new(r, g, b);
        if let Some(front) = front {
            let [r, g, b, _] = front[i].throughput;
            factor *= Vec3::new(r, g, b);
        }
        let out = Vec3::new(light[0], light[1], light[2]) * factor;
        let scale = crate::image::luminance(factor);
        carried[i] = out.extend(if scale > 0.0 { light[3] * scale * scale } else { 0.0 }).to_array();
    }
}
