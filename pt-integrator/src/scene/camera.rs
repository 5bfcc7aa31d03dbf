//! Where the picture is taken from.

use core::fmt;

use glam::{Mat4, Vec3};

/// A pinhole camera with a box pixel filter.
///
/// # Units
/// Position in scene units relative to the scene's origin; the field of view in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole.
    pub position: Vec3,
    /// Unit vector to the picture's right.
    pub right: Vec3,
    /// Unit vector to the picture's top.
    pub up: Vec3,
    /// Unit vector into the picture.
    pub forward: Vec3,
    /// Vertical field of view, from the lower to the upper edge; above 0, below π.
    pub fov_y: f32,
    /// Pixels a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
}

/// Why a camera cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CameraError {
    /// A number is NaN or infinite.
    NotFinite,
    /// Position and target coincide, or the up vector is parallel to the view, or the matrix is singular.
    Degenerate,
    /// The field of view is not between 0 and π.
    FieldOfView,
    /// The picture has no pixels, or more than 2³¹.
    Size,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "the camera has a number that is not finite",
            Self::Degenerate => "the camera's directions do not span space",
            Self::FieldOfView => "the camera's vertical field of view is not between 0 and 180 degrees",
            Self::Size => "the picture must have from 1 to 2^31 pixels",
        })
    }
}

impl core::error::Error for CameraError {}

impl Camera {
    /// A camera at `position` that looks at `target`; `up` shows upwards in the picture.
    ///
    /// # Errors
    /// [`CameraError`].
    ///
    /// ```
    /// use hashcache_core::glam::Vec3;
    /// use pt_integrator::scene::Camera;
    /// let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 0.8, 640, 480)?;
    /// assert_eq!(camera.forward, Vec3::NEG_Z);
    /// assert_eq!(camera.right, Vec3::X);
    /// # Ok::<(), pt_integrator::scene::CameraError>(())
    /// ```
    pub fn look_at(
        position: Vec3,
        target: Vec3,
        up: Vec3,
        fov_y: f32,
        width: u32,
        height: u32,
    ) -> Result<Self, CameraError> {
        if !(position.is_finite() && target.is_finite() && up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        let forward = unit(target - position)?;
        let right = unit(forward.cross(unit(up)?))?;
        Self { position, right, up: right.cross(forward), forward, fov_y, width, height }.checked()
    }

    /// A camera from its node's matrix as glTF defines it: it looks along −z, +x is to the right, +y is up.
    /// Scale and shear are dropped.
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn from_matrix(to_scene: &Mat4, fov_y: f32, width: u32, height: u32) -> Result<Self, CameraError> {
        if !to_scene.is_finite() {
            return Err(CameraError::NotFinite);
        }
        let forward = unit(-to_scene.z_axis.truncate())?;
        // A mirroring node mirrors the picture, so its own axes decide the sides.
        let up = to_scene.y_axis.truncate();
        let up = unit(up - forward * up.dot(forward))?;
        let right = to_scene.x_axis.truncate();
        let right = unit(right - forward * right.dot(forward) - up * right.dot(up))?;
        let position = to_scene.w_axis.truncate();
        Self { position, right, up, forward, fov_y, width, height }.checked()
    }

    /// The same view in another number of pixels; the vertical field of view stays.
    ///
    /// # Errors
    /// [`CameraError::Size`].
    pub fn with_size(self, width: u32, height: u32) -> Result<Self, CameraError> {
        Self { width, height, ..self }.checked()
    }

    /// Number of pixels.
    pub const fn pixels(&self) -> u32 {
        self.width * self.height
    }

    fn checked(self) -> Result<Self, CameraError> {
        if !self.fov_y.is_finite() || !self.position.is_finite() {
            Err(CameraError::NotFinite)
        } else if self.fov_y <= 0.0 || self.fov_y >= core::f32::consts::PI {
            Err(CameraError::FieldOfView)
        } else if self.width == 0 || self.height == 0 || u64::from(self.width) * u64::from(self.height) > 1 << 31 {
            Err(CameraError::Size)
        } else {
            Ok(self)
        }
    }
}

/// The vector's direction, whatever its length: scaled by its largest component first, so that no square overflows.
fn unit(v: Vec3) -> Result<Vec3, CameraError> {
    let largest = v.abs().max_element();
    if largest > 0.0 {
        (v / largest).try_normalize().ok_or(CameraError::Degenerate)
    } else {
        Err(CameraError::Degenerate)
    }
}
