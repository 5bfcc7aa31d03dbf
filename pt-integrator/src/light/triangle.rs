//! An emitting triangle, placed in the scene.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

use super::{LightSample, luminance};
use crate::ray::offset_origin;
use crate::sampling::sample_triangle;

/// An emissive triangle in scene space. 80 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleLight {
    /// First vertex; w: distance by which rays to the triangle end before it.
    pub vertex: [f32; 4],
    /// From the first vertex to the second; w: density of a sampled point by area, the choice of the triangle included.
    pub edge1: [f32; 4],
    /// From the first vertex to the third; w is 0.
    pub edge2: [f32; 4],
    /// Unit normal of the emitting side; w: 1 when both sides emit, else 0.
    pub normal: [f32; 4],
    /// Radiance; w is 0.
    pub radiance: [f32; 4],
}

/// Density by area of a sampled point on a triangle that emits `radiance`: the same all over the scene for equal
/// radiance, since triangles are chosen by power, which is area times radiance. `scale` is
/// [`crate::packed::SceneHeader::density_per_luminance`].
#[inline]
pub fn triangle_density(radiance: Vec3, double_sided: bool, scale: f32) -> f32 {
    let density = luminance(radiance) * scale;
    if double_sided { density * 2.0 } else { density }
}

impl TriangleLight {
    /// A point on the triangle as seen from `from`, or `None` when it shows its dark side there.
    #[inline]
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<LightSample> {
        let b = sample_triangle(u);
        let normal = xyz(&self.normal);
        let point = xyz(&self.vertex) + xyz(&self.edge1) * b.x + xyz(&self.edge2) * b.y;
        let to = point - from;
        let distance_squared = to.length_squared();
        let along = -normal.dot(to);
        if along < 0.0 && self.normal[3] == 0.0 {
            return None;
        }
        let distance = hashcache_core::float::sqrt(distance_squared);
        // Density by solid angle: density by area · distance² / cosine.
        let pdf = self.edge1[3] * distance_squared * distance / along.abs();
        if !(pdf > 0.0 && pdf <= f32::MAX) {
            return None;
        }
        let target = offset_origin(point, normal, -to, self.vertex[3]);
        Some(LightSample {
            direction: to / distance,
            target: Some(target),
            radiance: xyz(&self.radiance),
            pdf,
            is_delta: false,
        })
    }
}

#[inline]
fn xyz(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
