//! Pictures beside the picture: what denoisers read, and what tells where light came from.

use hashcache_core::glam::Vec3;
use layered_filter::image::is_hole;
use layered_filter::{LayerPixel, Light};

use crate::image_file::Image;

/// A picture's name and how a pixel's sums become one of its pixels.
type Aov = (&'static str, fn(&LayerPixel) -> Vec3);

/// All of them. Those with one number a pixel hold it in all three channels.
const AOVS: &[Aov] = &[
    ("albedo", LayerPixel::mean_throughput),
    ("normal", |pixel| vec3(&pixel.normal).normalize_or_zero()),
    ("depth", |pixel| Vec3::splat(pixel.position[3] / pixel.counts[1].max(1) as f32)),
    ("emission", LayerPixel::mean_emitted),
    ("layer0_direct", |pixel| light(&pixel.direct_light())),
    ("layer0_cached", |pixel| light(&pixel.further_light())),
    ("samples", |pixel| Vec3::splat(pixel.counts[0] as f32)),
    ("holes", |pixel| Vec3::splat(pixel.counts[2] as f32)),
    ("cache_samples", |pixel| Vec3::splat(pixel.emitted[3] / pixel.normal[3].max(1.0))),
];

/// The pictures of a frame's sums.
pub(super) fn pictures(width: u32, height: u32, sums: &[u8]) -> Vec<(&'static str, Image)> {
    let pixels: Vec<LayerPixel> =
        sums.chunks_exact(size_of::<LayerPixel>()).map(bytemuck::pod_read_unaligned).collect();
    AOVS.iter()
        .map(|(name, of)| (*name, Image { width, height, pixels: pixels.iter().map(|p| of(p).to_array()).collect() }))
        .collect()
}

fn vec3(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

/// A hole is black.
fn light(light: &Light) -> Vec3 {
    if is_hole(light) { Vec3::ZERO } else { vec3(light) }
}
