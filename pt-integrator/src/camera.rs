//! Rays through pixels.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use hashcache_core::float;
use hashcache_core::geometry::Ray;

use crate::ray::ray_towards;
use crate::scene::Camera;

/// A camera made ready to send rays. 64 bytes.
///
/// The ray through pixel (x, y), counted from the upper left, and the point `u` of its square goes along
/// `corner + (x + u.x)·step_right + (y + u.y)·step_down`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraRays {
    /// The pinhole; w: the angle of a pixel in radians, `2·tan(fov_y/2)/height`.
    pub position_pixel_angle: [f32; 4],
    /// From the pinhole to the picture's upper left corner, at distance 1; w is 0.
    pub corner: [f32; 4],
    /// One pixel to the right; w is 0.
    pub step_right: [f32; 4],
    /// One pixel down; w is 0.
    pub step_down: [f32; 4],
}

impl CameraRays {
    /// The rays of a camera.
    ///
    /// ```
    /// use hashcache_core::glam::{Vec2, Vec3};
    /// use pt_integrator::camera::CameraRays;
    /// use pt_integrator::scene::Camera;
    /// let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 3, 3)?;
    /// let ray = CameraRays::new(&camera).ray([1, 1], Vec2::splat(0.5));
    /// assert!(ray.direction.distance(Vec3::NEG_Z) < 1e-6);
    /// # Ok::<(), pt_integrator::scene::CameraError>(())
    /// ```
    pub fn new(camera: &Camera) -> Self {
        let half_height = float::tan(camera.fov_y * 0.5);
        let pixel = 2.0 * half_height / camera.height as f32;
        let half_width = half_height * (camera.width as f32 / camera.height as f32);
        let corner = camera.forward - camera.right * half_width + camera.up * half_height;
        Self {
            position_pixel_angle: camera.position.extend(pixel).to_array(),
            corner: corner.extend(0.0).to_array(),
            step_right: (camera.right * pixel).extend(0.0).to_array(),
            step_down: (camera.up * -pixel).extend(0.0).to_array(),
        }
    }

    /// The same picture cut into another number of pixels, `width` × `height`, both above 0; the pixel's angle stays.
    ///
    /// Paths of a coarser or finer picture than the one shown then have the footprints of the picture shown.
    ///
    /// ```
    /// use hashcache_core::glam::{Vec2, Vec3};
    /// use pt_integrator::camera::CameraRays;
    /// use pt_integrator::scene::Camera;
    /// let full = CameraRays::new(&Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 8, 6)?);
    /// let half = full.with_size([8, 6], [4, 3]);
    /// let (a, b) = (full.ray([5, 4], Vec2::ZERO), half.ray([2, 2], Vec2::new(0.5, 0.0)));
    /// assert!(a.direction.distance(b.direction) < 1e-6);
    /// assert_eq!(half.pixel_angle(), full.pixel_angle());
    /// # Ok::<(), pt_integrator::scene::CameraError>(())
    /// ```
    #[must_use]
    pub fn with_size(self, [width, height]: [u32; 2], to: [u32; 2]) -> Self {
        let stretch = |step: &[f32; 4], ratio: f32| (xyz(step) * ratio).extend(0.0).to_array();
        Self {
            step_right: stretch(&self.step_right, width as f32 / to[0] as f32),
            step_down: stretch(&self.step_down, height as f32 / to[1] as f32),
            ..self
        }
    }

    /// The angle of a pixel in radians: a path's footprint is its length times this.
    #[inline]
    pub fn pixel_angle(&self) -> f32 {
        self.position_pixel_angle[3]
    }

    /// The ray through the point `u` (from the upper left) of a pixel; its direction has unit length.
    #[inline]
    pub fn ray(&self, pixel: [u32; 2], u: Vec2) -> Ray {
        let [x, y] = [pixel[0] as f32 + u.x, pixel[1] as f32 + u.y];
        let direction = xyz(&self.corner) + xyz(&self.step_right) * x + xyz(&self.step_down) * y;
        let direction = direction / float::sqrt(direction.length_squared());
        ray_towards(xyz(&self.position_pixel_angle), direction)
    }
}

#[inline]
fn xyz(v: &[f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
