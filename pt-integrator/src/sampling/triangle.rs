//! Points on triangles, uniform by area.

use glam::Vec2;

/// Barycentric weights of a triangle's second and third vertex for a point of the unit square, uniform by area.
///
/// Neighbours stay neighbours, which keeps the square's stratification, and no root is taken.
///
/// # Source
/// Heitz 2019.
///
/// ```
/// use hashcache_core::glam::Vec2;
/// use pt_integrator::sampling::sample_triangle;
/// assert_eq!(sample_triangle(Vec2::new(0.5, 0.5)), Vec2::new(0.25, 0.25));
/// ```
#[inline]
pub fn sample_triangle(u: Vec2) -> Vec2 {
    if u.y > u.x {
        let half = u.x * 0.5;
        Vec2::new(half, u.y - half)
    } else {
        let half = u.y * 0.5;
        Vec2::new(u.x - half, half)
    }
}
