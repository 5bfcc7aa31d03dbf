//! The path vertices that tracing writes and caches consume.

use bytemuck::{Pod, Zeroable};

/// A path's vertex that a cache may hold, with the light that this path brought to it and the way on to the pixel.
///
/// The pixel's radiance is `emitted + throughput · (direct + further)`: *illumination* (`direct`, `further`) is
/// incident light weighted by the albedo-free BRDF times cosine (1/π·cos for Lambert), so a cache that averages it
/// over a cell needs no albedo, and `throughput` holds the vertex's own albedo as its last factor.
///
/// 96 bytes; `[f32; 4]` and `u32` only, so the bytes are the same in WGSL (`HcVertexRecord`).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VertexRecord {
    /// Position relative to the scene's origin, and the footprint: path length × the pixel's angle, in scene units.
    pub position_footprint: [f32; 4],
    /// Illumination by emitters that the vertex sees directly (next event and emission met by its own ray, weighted
    /// by MIS); w is 0.
    pub direct: [f32; 4],
    /// Illumination that arrives after a further scattering; w is 0.
    pub further: [f32; 4],
    /// Product of all scattering weights from the camera to this vertex, its albedo included; w is 0.
    pub throughput: [f32; 4],
    /// Light of the path that does not pass through this vertex's diffuse lobe; w is 0.
    pub emitted: [f32; 4],
    /// Shading normal on the side the path came from, octahedral (`pack::octahedral`).
    pub normal: u32,
    /// Direction of the ray that arrived here, octahedral.
    pub direction: u32,
    /// Seed of the vertex's random decisions (jitter), unique to pixel and sample.
    pub seed: u32,
    /// [`VertexRecord::VALID`] and, later, further bits.
    pub flags: u32,
}

impl VertexRecord {
    /// Flag: the path has a vertex to cache; without it only `emitted` counts.
    pub const VALID: u32 = 1;
}
