//! The path vertices that tracing writes and caches consume.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::pack::octahedral_decode;

/// A path's vertex that a cache may hold, with the light that this path brought to it and the way on to the pixel.
///
/// The pixel's radiance is `emitted + throughput · (direct + further)`: *illumination* (`direct`, `further`) is
/// incident light weighted by the albedo-free BRDF times cosine (1/π·cos for Lambert), so a cache that averages it
/// over a cell needs no albedo, and `throughput` holds the vertex's own albedo as its last factor.
///
/// `[f32; 4]` and `u32` only, so the bytes are the same in WGSL (`HcVertexRecord`):
///
/// | bytes | field | meaning |
/// |---|---|---|
/// | 0..12 | `position_footprint` | position |
/// | 12..16 | `position_footprint[3]` | footprint |
/// | 16..32 | `direct` | rgb, 0 |
/// | 32..48 | `further` | rgb, 0 |
/// | 48..64 | `throughput` | rgb, shininess of the lobe by which the chain goes on |
/// | 64..80 | `emitted` | rgb, 0 |
/// | 80..84 | `normal` | octahedral: x in bits 0..16, y in bits 16..32 |
/// | 84..88 | `direction` | octahedral |
/// | 88..92 | `seed` | any 32 bits |
/// | 92..96 | `flags` | bit 0: [`VertexRecord::VALID`], 1: [`VertexRecord::SECONDARY`], 2: [`VertexRecord::VISIBLE_ONLY`], 3: [`VertexRecord::GUIDE`]; bits 8..12: [`VertexRecord::layer`]; the others are 0 |
///
/// # Mixed materials
/// A vertex splits by lobe. A record stands for the *diffuse* lobe only: `direct` and `further` are incident light
/// weighted by cos/π times what of it enters the diffuse layer, 1 − F(n·l), and `throughput` holds albedo·(1 − F(n·v)).
/// Light by all other lobes goes on along the path: to `emitted` when it meets an emitter, or to the next vertex. A
/// pixel may have several records then, one for each vertex of its chain of mirroring and transmitting lobes.
///
/// A worked example of an octahedral word stands in [`crate::pack`].
///
/// # Units
/// Positions and footprints in scene units (metres), light in radiance (linear Rec. 709).
///
/// ```
/// # use hashcache_core::{glam::Vec3, pack::octahedral_encode, record::VertexRecord};
/// let vertex = VertexRecord {
///     position_footprint: [0.0, 1.0, 0.0, 0.01],
///     direct: [0.5, 0.5, 0.5, 0.0],
///     further: [0.25, 0.25, 0.25, 0.0],
///     throughput: [0.8, 0.4, 0.4, 0.0],
///     emitted: [0.0; 4],
///     normal: octahedral_encode(Vec3::Y),
///     direction: octahedral_encode(Vec3::NEG_Y),
///     seed: 7,
///     flags: VertexRecord::VALID,
/// };
/// assert_eq!(vertex.radiance(), Vec3::new(0.6, 0.3, 0.3));
/// ```
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
    /// Product of all scattering weights from the camera to this vertex, its diffuse albedo included, over the
    /// probabilities of the choices made; w: shininess, 1 − roughness, of the lobe by which the pixel's chain goes on
    /// from here to the next layer: 1 for a perfect mirror, at least [`VertexRecord::LEAST_SHININESS`], 0 where it goes no
    /// further.
    pub throughput: [f32; 4],
    /// Light of the path that does not pass through this vertex's diffuse lobe; w is 0.
    pub emitted: [f32; 4],
    /// Shading normal on the side the path came from, octahedral ([`crate::pack::octahedral_encode`]).
    pub normal: u32,
    /// Direction of the ray that arrived here, octahedral.
    pub direction: u32,
    /// Seed of the vertex's random decisions (jitter), unique to pixel and sample.
    pub seed: u32,
    /// [`VertexRecord::VALID`], [`VertexRecord::SECONDARY`], [`VertexRecord::VISIBLE_ONLY`],
    /// [`VertexRecord::GUIDE`], and [`VertexRecord::layer`] in bits 8..12.
    pub flags: u32,
}

impl VertexRecord {
    /// Flag: the path has a vertex to cache; without it only `emitted` counts.
    pub const VALID: u32 = 1;

    /// Flag: not the path's first vertex. It feeds a cache like any other, but its light reaches the pixel through the
    /// first vertex's record already: it is no estimate of a pixel, and `throughput` is the product from the camera.
    pub const SECONDARY: u32 = 2;

    /// Flag: a vertex that asks a cache and never feeds it: `further` is not known and 0.
    pub const VISIBLE_ONLY: u32 = 4;

    /// Flag: a vertex without a diffuse lobe (mirror, glass): position, footprint and normal guide a filter, and there
    /// is nothing to cache. Never together with [`VertexRecord::VALID`]; only `emitted` counts.
    pub const GUIDE: u32 = 8;

    /// First bit of [`VertexRecord::layer`] in `flags`.
    pub const LAYER_SHIFT: u32 = 8;

    /// Largest [`VertexRecord::layer`]; deeper vertices have this one.
    pub const MAX_LAYER: u32 = 15;

    /// The bits of `flags` for a vertex behind so many scatterings by lobes that are not diffuse.
    ///
    /// ```
    /// # use hashcache_core::record::VertexRecord;
    /// assert_eq!(VertexRecord::layer_bits(2), 2 << VertexRecord::LAYER_SHIFT);
    /// assert_eq!(VertexRecord::layer_bits(100), VertexRecord::layer_bits(VertexRecord::MAX_LAYER));
    /// ```
    #[inline]
    pub const fn layer_bits(layer: u32) -> u32 {
        (if layer < Self::MAX_LAYER { layer } else { Self::MAX_LAYER }) << Self::LAYER_SHIFT
    }

    /// Number of mirroring and transmitting scatterings between the camera and the vertex, at most
    /// [`VertexRecord::MAX_LAYER`]; 0: seen directly.
    #[inline]
    pub const fn layer(&self) -> u32 {
        (self.flags >> Self::LAYER_SHIFT) & Self::MAX_LAYER
    }

    /// Least shininess of a lobe by which a chain goes on: also the roughest is told from the end of the chain.
    pub const LEAST_SHININESS: f32 = 1.0 / 256.0;

    /// Whether position, footprint and normal are those of a surface, with a diffuse lobe or without.
    #[inline]
    pub const fn is_guide(&self) -> bool {
        self.flags & (Self::VALID | Self::GUIDE) != 0
    }

    /// 1 − roughness of the lobe by which the pixel's chain goes on from here, at least [`VertexRecord::LEAST_SHININESS`];
    /// 0: it does not.
    #[inline]
    pub const fn shininess(&self) -> f32 {
        self.throughput[3]
    }

    /// Whether a cache may record the vertex: valid, and its light is known.
    #[inline]
    pub const fn is_recordable(&self) -> bool {
        self.flags & (Self::VALID | Self::VISIBLE_ONLY) == Self::VALID
    }

    /// Whether the path has a vertex to cache.
    #[inline]
    pub const fn is_valid(&self) -> bool {
        self.flags & Self::VALID != 0
    }

    /// The shading normal.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        octahedral_decode(self.normal)
    }

    /// The path's own contribution to its pixel: `emitted + throughput · (direct + further)`.
    #[inline]
    pub fn radiance(&self) -> Vec3 {
        self.radiance_with(rgb(&self.direct), rgb(&self.further))
    }

    /// The contribution with illumination from elsewhere, a cache's as a rule, instead of the path's own.
    #[inline]
    pub fn radiance_with(&self, direct: Vec3, further: Vec3) -> Vec3 {
        if self.is_valid() {
            rgb(&self.emitted) + rgb(&self.throughput) * (direct + further)
        } else {
            rgb(&self.emitted)
        }
    }
}

#[inline]
fn rgb(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
