//! A scene that figures are taken of.

use std::path::{Path, PathBuf};

use hashcache::scene::CameraPath;
use hashcache::{Preview, Settings};

use crate::still::Still;

/// The scenes whose references were made with area lights or an environment and whose moves are at hand.
pub const ALL: [&str; 5] = ["cornell-box", "modern-hall", "living-room", "wooden-staircase", "country-kitchen"];

/// The three that stand for the rest where all five would take too long.
pub const THREE: [&str; 3] = ["modern-hall", "wooden-staircase", "country-kitchen"];

/// A shared scene with its reference and its move.
pub struct Subject {
    /// The scene and the picture by an independent renderer.
    pub still: Still,
    /// Thirty frames that end at the reference's camera.
    pub path: CameraPath,
}

/// Where the shared scenes and references are.
pub fn shared() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = std::env::var_os("HASHCACHE_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    if shared.join("refs/scenes").is_dir() {
        Ok(shared)
    } else {
        Err(format!("no shared scenes at {}; set HASHCACHE_SHARED", shared.display()))
    }
}

impl Subject {
    /// Reads a shared scene's facts, reference and move.
    pub fn read(name: &str) -> Result<Self, String> {
        let path = CameraPath::from_file(&shared()?.join(format!("refs/paths/{name}.json")));
        Ok(Self { still: Still::shared(name)?, path: path.map_err(|error| error.to_string())? })
    }

    /// Opens the scene at the reference's size and with its environment.
    pub fn open(&self, settings: &Settings) -> Result<Preview, String> {
        self.still.open(settings)
    }
}
