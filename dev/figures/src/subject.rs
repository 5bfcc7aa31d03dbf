//! A scene that figures are taken of.

use std::path::{Path, PathBuf};

use hashcache::scene::CameraPath;
use hashcache::{Image, Preview, Settings, image_file};
use serde_json::Value;

/// The scenes whose references were made with area lights or an environment and whose moves are at hand.
pub const ALL: [&str; 5] = ["cornell-box", "modern-hall", "living-room", "wooden-staircase", "country-kitchen"];

/// The three that stand for the rest where all five would take too long.
pub const THREE: [&str; 3] = ["modern-hall", "wooden-staircase", "country-kitchen"];

/// A shared scene with its reference and its move.
pub struct Subject {
    /// Its name.
    pub name: String,
    scene: PathBuf,
    environment: Option<PathBuf>,
    /// The picture by an independent renderer.
    pub reference: Image,
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
        let shared = shared()?;
        let (folder, scenes) = (shared.join("refs/scenes"), shared.join("scenes"));
        let file = folder.join(format!("{name}.json"));
        let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let facts: Value = serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))?;
        let scene = facts["scene"].as_str().ok_or_else(|| format!("{}: names no scene", file.display()))?;
        let environment = facts["args"].as_array().and_then(|arguments| arguments.get(1)).and_then(Value::as_str);
        Ok(Self {
            name: name.to_owned(),
            scene: scenes.join(scene),
            environment: environment.map(|file| file.replace("{scenes}", &scenes.to_string_lossy()).into()),
            reference: image_file::read(&folder.join(format!("{name}.exr"))).map_err(|error| error.to_string())?,
            path: CameraPath::from_file(&shared.join(format!("refs/paths/{name}.json")))
                .map_err(|error| error.to_string())?,
        })
    }

    /// Opens the scene at the reference's size and with its environment.
    pub fn open(&self, settings: &Settings) -> Result<Preview, String> {
        let settings = Settings {
            size: Some((self.reference.width, self.reference.height)),
            env: self.environment.clone(),
            ..settings.clone()
        };
        Preview::open(&self.scene.to_string_lossy(), &settings).map_err(|error| error.to_string())
    }
}
