//! What can go wrong between a scene file and a picture.

use crate::image_file::ImageError;
use crate::settings::SettingsError;

/// An error of the whole way, told in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The scene.
    #[error(transparent)]
    Scene(#[from] scene::SceneError),
    /// An image file.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The backend.
    #[error("backend {backend}: {error}")]
    Backend {
        /// Its name.
        backend: &'static str,
        /// What it said.
        error: backend_api::Error,
    },
    /// The integrator refused the scene's data.
    #[error("{scene}: {reason}")]
    BadScene {
        /// The scene as it was named.
        scene: String,
        /// Why.
        reason: String,
    },
    /// A part of the frame refused its parameters.
    #[error("{what}: {reason}")]
    Refused {
        /// The cache, the filter, a setting.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// A frame's camera is for a picture of another size than the session's.
    #[error("camera: made for a picture of {}x{}, the session's has {}x{}", size.0, size.1, wanted.0, wanted.1)]
    CameraSize {
        /// Columns and rows that the camera is for.
        size: (u32, u32),
        /// Columns and rows of the session's picture.
        wanted: (u32, u32),
    },
    /// The frame needs more memory than there is.
    #[error(
        "{what} needs {bytes} bytes, more than can be had; choose a smaller --size, octree.resolution or grid.slots"
    )]
    OutOfMemory {
        /// What needs it.
        what: &'static str,
        /// How much.
        bytes: u64,
    },
}
