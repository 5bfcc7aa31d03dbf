//! Pictures beside the picture: what denoisers read, and what tells where light came from.

use hashcache_core::glam::Vec3;
use layered_filter::image::is_hole;
use layered_filter::{LayerPixel, Light, MAX_LAYERS, NoisePixel};

use crate::image_file::Image;

/// How a pixel's sums become one of a picture's pixels.
type Of = fn(&LayerPixel) -> Vec3;

/// Pictures of the first layer. Those with one number a pixel hold it in all three channels.
const FIRST: &[(&str, Of)] = &[
    ("albedo", LayerPixel::mean_throughput),
    ("normal", normal),
    ("depth", depth),
    ("emission", LayerPixel::mean_emitted),
    ("layer0_direct", |pixel| light(&pixel.direct_light())),
    ("layer0_cached", |pixel| light(&pixel.further_light())),
    ("samples", |pixel| Vec3::splat(pixel.counts[0] as f32)),
    ("holes", |pixel| Vec3::splat(pixel.counts[2] as f32)),
    ("cache_samples", cache_samples),
];

/// What each further layer has, in the order of [`NAMES`].
const FURTHER: [Of; 6] = [
    LayerPixel::mean_throughput,
    normal,
    depth,
    LayerPixel::mean_emitted,
    |pixel| light(&pixel.direct_light()),
    |pixel| light(&pixel.further_light()),
];

macro_rules! names {
    ($($layer:literal),*) => {
        [$([
            concat!("layer", $layer, "_albedo"),
            concat!("layer", $layer, "_normal"),
            concat!("layer", $layer, "_depth"),
            concat!("layer", $layer, "_emission"),
            concat!("layer", $layer, "_direct"),
            concat!("layer", $layer, "_cached"),
        ]),*]
    };
}

/// Names of the further layers' pictures.
const NAMES: [[&str; FURTHER.len()]; MAX_LAYERS as usize - 1] = names!(1, 2, 3, 4, 5, 6, 7);

/// The pictures of a frame's sums, the first layer's first.
pub(super) fn pictures(width: u32, height: u32, layers: &[Vec<u8>]) -> Vec<(&'static str, Image)> {
    let mut pictures = Vec::new();
    for (layer, sums) in layers.iter().enumerate() {
        let pixels: Vec<LayerPixel> =
            sums.chunks_exact(size_of::<LayerPixel>()).map(bytemuck::pod_read_unaligned).collect();
        let mut push = |name: &'static str, of: Of| {
            let pixels = pixels.iter().map(|pixel| of(pixel).to_array()).collect();
            pictures.push((name, Image { width, height, pixels }));
        };
        match layer.checked_sub(1) {
            None => FIRST.iter().for_each(|(name, of)| push(name, *of)),
            Some(further) => NAMES[further].iter().zip(FURTHER).for_each(|(name, of)| push(name, of)),
        }
    }
    pictures
}

/// Each pixel's standard error; +∞ where it is not known.
pub(super) fn standard_errors(width: u32, height: u32, noise: &[NoisePixel]) -> (&'static str, Image) {
    let pixels = noise.iter().map(|pixel| [pixel.standard_error(); 3]).collect();
    ("stderr", Image { width, height, pixels })
}

fn vec3(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

fn normal(pixel: &LayerPixel) -> Vec3 {
    vec3(&pixel.normal).normalize_or_zero()
}

fn depth(pixel: &LayerPixel) -> Vec3 {
    Vec3::splat(pixel.position[3] / pixel.counts[1].max(1) as f32)
}

fn cache_samples(pixel: &LayerPixel) -> Vec3 {
    Vec3::splat(pixel.emitted[3] / pixel.normal[3].max(1.0))
}

/// A hole is black.
fn light(light: &Light) -> Vec3 {
    if is_hole(light) { Vec3::ZERO } else { vec3(light) }
}
