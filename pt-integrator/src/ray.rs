//! Rays that leave surfaces without meeting them again.
//!
//! A hit's position is computed from the triangle's corners, not from the ray, so its error is some units in the last
//! place of the corners' coordinates however long the ray was. Origins are moved off the face by a multiple of that.
//!
//! # Source
//! Wächter & Binder 2019 for the problem and the position by barycentric coordinates; Pharr et al. 2023, 6.8.
//!
//! # Deviation
//! Wächter and Binder add a fixed number of units in the last place to each coordinate, and below 1/32 a fixed
//! distance that fits scenes a metre large. Here the distance is relative to the corners' largest coordinate, so it
//! suits scenes of any size and planes through the origin.

use glam::Vec3;
use hashcache_core::geometry::Ray;

/// Offset relative to the largest coordinate of the triangle's corners: 64 units of 2⁻²⁴. The position's own error is
/// below 4 of them and a ray caster's error in distance is about 5 by the inverse sine of the triangle's sharpest
/// angle; the rest is reserve for sharp ones. Smaller: surfaces shade themselves. Larger: contacts leak light.
pub const RELATIVE_OFFSET: f32 = 1.0 / 262_144.0;

/// Part of a shadow ray that is traced: 1 − 2⁻²⁰, so that rounding its length does not reach the emitter.
const SHADOW_LENGTH: f32 = 1.0 - 1.0 / 1_048_576.0;

/// `position` moved by `distance` to the side of the face with unit normal `face` to which `direction` points.
#[inline]
pub fn offset_origin(position: Vec3, face: Vec3, direction: Vec3, distance: f32) -> Vec3 {
    let distance = if face.dot(direction) < 0.0 { -distance } else { distance };
    position + face * distance
}

/// The ray from `origin` to infinity.
#[inline]
pub fn ray_towards(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, t_min: 0.0, direction, t_max: f32::MAX }
}

/// The open segment between two points.
#[inline]
pub fn segment(origin: Vec3, target: Vec3) -> Ray {
    let to = target - origin;
    let distance = hashcache_core::float::sqrt(to.length_squared());
    // Coinciding points: a ray of length 0 meets nothing.
    let direction = if distance > 0.0 { to / distance } else { Vec3::X };
    Ray { origin, t_min: 0.0, direction, t_max: distance * SHADOW_LENGTH }
}
