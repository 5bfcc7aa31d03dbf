//! Layers in front: the vertices through whose mirroring and transmitting lobes a pixel sees the layers behind, and the
//! light that comes from there.

use bytemuck::{Pod, Zeroable};
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;

use crate::guide::{GuideScale, PreparedGuide};
use crate::image::Light;
use crate::pixel::{GatherParams, LayerPixel, accumulate, is_light, xyz};

/// Roughness from which on light that passes a vertex is filtered once more with that vertex's guides. Below, the lobe is
/// so narrow that neighbours see different things, and caches trace it on for the same reason.
pub const LEAST_ROUGHNESS: f32 = 0.2;

/// Sums over a pixel's vertices of one layer that the pixel's chains go on from (48 bytes). All zeros is the empty sum.
///
/// | bytes | field | xyz | w |
/// |---|---|---|---|
/// | 0..16 | `normal` | Σ normal | number of vertices |
/// | 16..32 | `position` | Σ position | Σ path length |
/// | 32..48 | `lobe` | Σ shininess, 0, 0 | 0 |
///
/// Sums are f32, as those of [`LayerPixel`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrontPixel {
    /// Σ of unit normals; w: number of vertices.
    pub normal: [f32; 4],
    /// Σ of positions in scene units; w: Σ of path lengths.
    pub position: [f32; 4],
    /// Σ of shininess, 1 − roughness, of the lobes that the chains go on by; the rest is 0.
    pub lobe: [f32; 4],
}

impl FrontPixel {
    /// Adds a sample's vertex if its chain goes on from there. What is not finite is left out.
    #[inline]
    pub fn add(&mut self, params: &GatherParams, record: &VertexRecord) {
        let shininess = record.throughput[3];
        // False for NaN.
        let shines = shininess > 0.0 && shininess <= 1.0;
        let is_guide = record.flags & VertexRecord::GUIDE != 0;
        if !(is_guide || record.is_valid() && shines) {
            return;
        }
        let position = xyz(&record.position_footprint);
        let distance = params.distance(record);
        if !position.is_finite() || !(0.0..=f32::MAX).contains(&distance) {
            return;
        }
        accumulate(&mut self.normal, record.normal(), 1.0);
        accumulate(&mut self.position, position, distance);
        accumulate(&mut self.lobe, Vec3::new(if shines { shininess } else { 0.0 }, 0.0, 0.0), 0.0);
    }

    /// Whether the pixel sees something through this layer.
    #[inline]
    pub fn has_vertex(&self) -> bool {
        self.normal[3] > 0.0
    }

    /// Whether the lobes are so wide, on average, that neighbours see the same: [`LEAST_ROUGHNESS`] and above.
    #[inline]
    pub fn is_rough(&self) -> bool {
        self.has_vertex() && self.lobe[0] <= (1.0 - LEAST_ROUGHNESS) * self.normal[3]
    }
}

impl PreparedGuide {
    /// The guide of a pixel's vertices that its chains go on from: means, the normal made unit again. Without a colour,
    /// since what is behind is not modulated by it. The samples behind the light are the pixel's own.
    pub fn of_front(scale: &GuideScale, front: &FrontPixel) -> Self {
        if !front.has_vertex() {
            return Self::NONE;
        }
        let recip = 1.0 / front.normal[3];
        let ([px, py, pz, path], s) = (front.position, scale.recip_radius() * recip);
        let length = path * s;
        Self {
            normal_path: xyz(&front.normal).normalize_or_zero().extend(length).to_array(),
            position_segment: [px * s, py * s, pz * s, length],
            lab_shininess: [0.0, 0.0, 0.0, front.lobe[0] * recip],
            support: [front.normal[3], 0.0, 0.0, 0.0],
        }
    }
}

/// What of the light behind a layer is filtered with that layer's guides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carry {
    /// All that passes rough lobes ([`FrontPixel::is_rough`]), emission too.
    Rough,
    /// All scattered light, and what is emitted where lobes are rough.
    All,
}

/// Radiance of the layers behind the one at work, as the camera sees it through those in front (32 bytes).
///
/// Light and emission are apart because a lamp in a mirror has a sharp edge and no noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Behind {
    /// Light that surfaces scatter or that was filtered already, rgb; w is 0.
    pub light: [f32; 4],
    /// Emission, rgb; w is 0.
    pub emitted: [f32; 4],
}

impl Behind {
    /// Takes out what is to be filtered with the front's guides; `None` when nothing is.
    #[inline]
    pub fn take(&mut self, front: &FrontPixel, carry: Carry) -> Option<Light> {
        let rough = front.is_rough();
        if !front.has_vertex() || (carry == Carry::Rough && !rough) {
            return None;
        }
        let mut taken = xyz(&self.light);
        self.light = [0.0; 4];
        if rough {
            taken += xyz(&self.emitted);
            self.emitted = [0.0; 4];
        }
        Some(taken.min(Vec3::MAX).extend(f32::INFINITY).to_array())
    }

    /// Adds a layer's own: its illumination times throughput, and what is emitted there.
    #[inline]
    pub fn add(&mut self, pixel: &LayerPixel, illumination: Vec3) {
        accumulate(&mut self.light, pixel.mean_throughput() * illumination, 0.0);
        accumulate(&mut self.emitted, pixel.mean_emitted(), 0.0);
    }

    /// Adds light that was filtered.
    #[inline]
    pub fn give(&mut self, light: Vec3) {
        if is_light(light) {
            accumulate(&mut self.light, light, 0.0);
        }
    }

    /// The radiance.
    #[inline]
    pub fn radiance(&self) -> Vec3 {
        xyz(&self.light) + xyz(&self.emitted)
    }
}
