//! Where a picture is taken from, in world coordinates.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3, Mat4};
use pt_integrator::scene::Camera;
use serde::Deserialize;

use crate::error::{At, SceneError, one_line};
use crate::import::resource;

/// A named pinhole view. Positions are the file's own, in f64; [`View::camera`] makes them relative to an origin.
///
/// # Units
/// Metres, y up; the field of view in radians.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct View {
    /// The camera's name, else its node's name, else `camera N`.
    pub name: String,
    /// The pinhole, in the file's coordinates.
    pub position: DVec3,
    /// Unit vector to the picture's right.
    pub right: DVec3,
    /// Unit vector to the picture's top.
    pub up: DVec3,
    /// Unit vector into the picture.
    pub forward: DVec3,
    /// Vertical field of view, above 0, below π.
    pub fov_y: f64,
}

/// A camera file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov_y_deg: f64,
}

/// Below this sine between view and up vector the picture's rotation would be decided by rounding.
const PARALLEL: f64 = 1e-9;

/// What a camera file looks like.
const FORM: &str = r#"write {"position":[x,y,z],"target":[x,y,z],"up":[0,1,0],"fov_y_deg":45}"#;

/// The longest camera file that is read, in bytes: a hundred times what one takes.
const LONGEST_CAMERA_FILE: u64 = 1 << 16;

impl View {
    /// A view at `position` towards `target`; `up` shows upwards in the picture.
    ///
    /// # Errors
    /// What is wrong: a number that is not finite, directions that do not span space, a field of view outside of (0, π).
    pub fn look_at(name: String, position: DVec3, target: DVec3, up: DVec3, fov_y: f64) -> Result<Self, &'static str> {
        if !(position.is_finite() && target.is_finite() && up.is_finite()) {
            return Err("has a number that is not finite");
        }
        let forward = unit(target - position).ok_or("position and target coincide")?;
        let up = unit(up).ok_or("the up vector is 0")?;
        let right = forward.cross(up);
        if right.length() < PARALLEL {
            return Err("the up vector is parallel to the view");
        }
        let right = right.normalize();
        Self { name, position, right, up: right.cross(forward), forward, fov_y }.checked()
    }

    /// The view of a glTF camera node: along its −z, +x to the right, +y up; scale and shear are dropped.
    pub(crate) fn from_transform(name: String, world: &DAffine3, fov_y: f64) -> Result<Self, &'static str> {
        const FLAT: &str = "its node's transform does not span space";
        let DMat3 { x_axis, y_axis, z_axis } = world.matrix3;
        let forward = -unit(z_axis).ok_or(FLAT)?;
        let up = unit(y_axis).ok_or(FLAT)?;
        let up = unit(up - forward * up.dot(forward)).ok_or(FLAT)?;
        // A mirroring node mirrors the picture, so its own axes decide the sides.
        let right = unit(x_axis).ok_or(FLAT)?;
        let right = unit(right - forward * right.dot(forward) - up * right.dot(up)).ok_or(FLAT)?;
        Self { name, position: world.translation, right, up, forward, fov_y }.checked()
    }

    /// Reads a camera file: `{"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov_y_deg":θ}`, in the scene file's
    /// coordinates (metres, y up) and degrees.
    ///
    /// # Errors
    /// [`SceneError::Read`] or [`SceneError::Unsupported`].
    ///
    /// ```
    /// let dir = tempfile::tempdir()?;
    /// let path = dir.path().join("front.json");
    /// std::fs::write(&path, r#"{"position":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":45}"#)?;
    /// let view = scene::View::from_file(&path)?;
    /// assert_eq!(view.forward, -scene::glam::DVec3::Z);
    /// assert_eq!(view.name, "front");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let file = path.to_string_lossy();
        let at = At { file: &file };
        let bytes = resource::read_file(path, LONGEST_CAMERA_FILE)?;
        let camera: CameraFile = serde_json::from_slice(&bytes).map_err(|e| at.json("a camera", &e, FORM))?;
        let degrees = camera.fov_y_deg;
        if !(degrees > 0.0 && degrees < 180.0) {
            return Err(at.unsupported("/fov_y_deg", format!("{degrees} is not between 0 and 180"), FORM));
        }
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let [position, target, up] = [camera.position, camera.target, camera.up].map(DVec3::from_array);
        Self::look_at(name, position, target, up, degrees.to_radians())
            .map_err(|what| at.unsupported("the camera", what, FORM))
    }

    /// The camera for a picture of `width` × `height` pixels, relative to the scene's `origin`.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a picture without pixels or with more than 2³¹, and for a camera too far from
    /// the scene to be expressed.
    pub fn camera(&self, origin: DVec3, width: u32, height: u32) -> Result<Camera, SceneError> {
        let column = |v: DVec3| v.as_vec3();
        let matrix = Mat4::from_cols(
            column(self.right).extend(0.0),
            column(self.up).extend(0.0),
            column(-self.forward).extend(0.0),
            column(self.position - origin).extend(1.0),
        );
        Camera::from_matrix(&matrix, self.fov_y as f32, width, height).map_err(|e| SceneError::OutOfRange {
            what: "camera",
            value: format!("{:?} at {width}x{height} ({e})", one_line(&self.name)),
            expected: "1 to 2^31 pixels and a finite view",
        })
    }

    fn checked(self) -> Result<Self, &'static str> {
        if !(self.fov_y > 0.0 && self.fov_y < std::f64::consts::PI) {
            Err("its vertical field of view is not between 0 and 180 degrees")
        } else if !self.position.is_finite() {
            Err("has a number that is not finite")
        } else {
            Ok(self)
        }
    }
}

/// The vector's direction, whatever its length: scaled first, so that no square overflows.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}
