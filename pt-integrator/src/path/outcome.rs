//! What a path brought.

use glam::Vec3;
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;

use crate::surface::Surface;

/// One vertex of a path and the light that the path brought to it: a [`VertexRecord`] before it is packed.
///
/// For the first vertex the pixel's radiance is `emitted + throughput·(direct + further)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOutcome {
    /// Whether the path met a surface that scatters. Without it only `emitted` counts.
    pub has_vertex: bool,
    /// Whether this is not the path's first vertex; its light is part of the first vertex's `further` then, as far as
    /// path lengths allow, and `emitted` is 0.
    pub is_secondary: bool,
    /// Position of the vertex.
    pub position: Vec3,
    /// Length of the path from the camera to the vertex.
    pub distance: f32,
    /// Shading normal on the side the path came from.
    pub normal: Vec3,
    /// Direction of the ray that arrived here.
    pub direction: Vec3,
    /// Illumination by emitters that the vertex sees.
    pub direct: Vec3,
    /// Illumination after a further scattering.
    pub further: Vec3,
    /// Product of all scattering weights from the camera to this vertex, its diffuse albedo included, over the
    /// probabilities of the lobes chosen and of having survived roulette.
    pub throughput: Vec3,
    /// Light that reaches the camera without a scattering by a diffuse lobe.
    pub emitted: Vec3,
    /// Whether there is a surface, but without a diffuse lobe: position, distance, normal and direction are its, and
    /// there is nothing to cache. Never together with `has_vertex`.
    pub is_guide: bool,
    /// Scatterings between the camera and the vertex by lobes that are not diffuse.
    pub layer: u32,
    /// 1 − roughness of the lobe by which the chain of [`super::trace_visible`] goes on from here; 0 where it does not.
    pub shininess: f32,
}

impl PathOutcome {
    /// No vertex and no light: what stands behind a path's end.
    pub const NONE: Self = Self {
        has_vertex: false,
        is_secondary: false,
        position: Vec3::ZERO,
        distance: 0.0,
        normal: Vec3::ZERO,
        direction: Vec3::ZERO,
        direct: Vec3::ZERO,
        further: Vec3::ZERO,
        throughput: Vec3::ZERO,
        emitted: Vec3::ZERO,
        is_guide: false,
        layer: 0,
        shininess: 0.0,
    };

    /// A path that met nothing and saw `emitted`.
    #[inline]
    pub(crate) fn seen(direction: Vec3, emitted: Vec3) -> Self {
        Self { direction, emitted, ..Self::NONE }
    }

    /// Becomes a vertex on this surface, behind `layer` scatterings by lobes that are not diffuse.
    #[inline]
    pub(crate) fn arrive(&mut self, surface: &Surface<'_>, distance: f32, layer: u32, throughput: Vec3) {
        self.has_vertex = true;
        self.throughput = throughput;
        self.stand(surface, distance, layer);
    }

    /// Becomes a guide: a surface that is seen, and has nothing to cache.
    #[inline]
    pub(crate) fn guide(&mut self, surface: &Surface<'_>, distance: f32, layer: u32) {
        self.is_guide = true;
        self.stand(surface, distance, layer);
    }

    #[inline]
    fn stand(&mut self, surface: &Surface<'_>, distance: f32, layer: u32) {
        self.position = surface.position;
        self.distance = distance;
        self.normal = surface.normal;
        self.direction = surface.direction;
        self.layer = layer;
    }

    /// Light from an emitter that the vertex sees itself (`own`), or from further on.
    #[inline]
    pub(crate) fn receive(&mut self, own: bool, illumination: Vec3) {
        let light = if own { &mut self.direct } else { &mut self.further };
        *light += illumination;
    }

    /// The pixel's radiance, if this is the path's first vertex.
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

    /// The vertex's record; `pixel_angle` in radians, `seed` as of [`crate::sampler::vertex_seed`].
    #[inline]
    pub fn record(&self, pixel_angle: f32, seed: u32) -> VertexRecord {
        let valid = if self.has_vertex { VertexRecord::VALID } else { 0 };
        let secondary = if self.is_secondary { VertexRecord::SECONDARY } else { 0 };
        let guide = if self.is_guide { VertexRecord::GUIDE } else { 0 };
        VertexRecord {
            position_footprint: self.position.extend(self.distance * pixel_angle).to_array(),
            direct: self.direct.extend(0.0).to_array(),
            further: self.further.extend(0.0).to_array(),
            throughput: self.throughput.extend(self.shininess).to_array(),
            emitted: self.emitted.extend(0.0).to_array(),
            normal: octahedral_encode(self.normal),
            direction: octahedral_encode(self.direction),
            seed,
            flags: valid | secondary | guide | VertexRecord::layer_bits(self.layer),
        }
    }
}
