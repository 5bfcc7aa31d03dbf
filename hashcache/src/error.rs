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
    /// The cache refused its parameters.
    #[error("cache grid: {0}")]
    Grid(String),
    /// The frame needs more memory than there is.
    #[error("{what} needs {bytes} bytes, more than can be had; choose a smaller --size or grid.slots")]
    OutOfMemory {
        /// What needs it.
        what: &'static str,
        /// How much.
        bytes: u64,
    },
}
