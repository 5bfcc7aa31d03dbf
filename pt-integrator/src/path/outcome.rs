//! What a path brought.

use glam::Vec3;
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;

/// The light of one path, split at its first vertex, and the vertex: a [`VertexRecord`] before it is packed.
///
/// The pixel's radiance is `emitted + throughput·(direct + further)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOutcome {
    /// Whether the path met a surface that scatters. Without it only `emitted` counts.
    pub has_vertex: bool,
    /// Position of the first vertex.
    pub position: Vec3,
    /// Length of the first segment.
    pub distance: f32,
    /// Shading normal on the side the path came from.
    pub normal: Vec3,
    /// Direction of the camera ray.
    pub direction: Vec3,
    /// Illumination by emitters that the vertex sees.
    pub direct: Vec3,
    /// Illumination after a further scattering.
    pub further: Vec3,
    /// Albedo of the first vertex.
    pub throughput: Vec3,
    /// Light that reaches the camera straight from an emitter.
    pub emitted: Vec3,
}

impl PathOutcome {
    /// A path that met nothing and saw `emitted`.
    #[inline]
    pub(crate) fn seen(direction: Vec3, emitted: Vec3) -> Self {
        Self {
            has_vertex: false,
            position: Vec3::ZERO,
            distance: 0.0,
            normal: Vec3::ZERO,
            direction,
            direct: Vec3::ZERO,
            further: Vec3::ZERO,
            throughput: Vec3::ZERO,
            emitted,
        }
    }

    /// The pixel's radiance.
    #[inline]
    pub fn radiance(&self) -> Vec3 {
        self.emitted + self.throughput * (self.direct + self.further)
    }

    /// Whether all light is finite, the sum too.
    #[inline]
    pub fn is_finite(&self) -> bool {
        // Light is never negative, so the illumination's sum is finite only if both parts are.
        self.radiance().is_finite() && (self.direct + self.further).is_finite()
    }

    /// The same vertex without light.
    #[inline]
    #[must_use]
    pub fn without_light(self) -> Self {
        Self { direct: Vec3::ZERO, further: Vec3::ZERO, emitted: Vec3::ZERO, ..self }
    }

    /// The record of the first vertex; `pixel_angle` in radians, `seed` as of [`crate::sampler::vertex_seed`].
    #[inline]
    pub fn record(&self, pixel_angle: f32, seed: u32) -> VertexRecord {
        VertexRecord {
            position_footprint: self.position.extend(self.distance * pixel_angle).to_array(),
            direct: self.direct.extend(0.0).to_array(),
            further: self.further.extend(0.0).to_array(),
            throughput: self.throughput.extend(0.0).to_array(),
            emitted: self.emitted.extend(0.0).to_array(),
            normal: octahedral_encode(self.normal),
            direction: octahedral_encode(self.direction),
            seed,
            flags: if self.has_vertex { VertexRecord::VALID } else { 0 },
        }
    }
}
