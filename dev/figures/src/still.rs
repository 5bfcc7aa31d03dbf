//! A picture to be compared with a reference.

use std::hash::{DefaultHasher, Hasher as _};
use std::path::PathBuf;

use hashcache::{Image, Preview, Settings, image_file};
use serde_json::Value;

use crate::run;
use crate::subject::shared;

/// A scene with a reference.
pub struct Still {
    /// Its name.
    pub name: String,
    scene: String,
    environment: Option<PathBuf>,
    /// The picture as it should be.
    pub reference: Image,
}

/// Size of the pictures of built-in scenes.
const SIZE: (u32, u32) = (192, 144);

/// Samples a pixel of a built-in scene's reference.
const SPP: u32 = 1024;

impl Still {
    /// A built-in scene with a reference by own path tracing, or a shared one with that of an independent renderer.
    pub fn read(name: &str) -> Result<Self, String> {
        if name.starts_with("builtin:") { Self::builtin(name) } else { Self::shared(name) }
    }

    /// A shared scene.
    pub fn shared(name: &str) -> Result<Self, String> {
        let shared = shared()?;
        let (folder, scenes) = (shared.join("refs/scenes"), shared.join("scenes"));
        let file = folder.join(format!("{name}.json"));
        let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let facts: Value = serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))?;
        let scene = facts["scene"].as_str().ok_or_else(|| format!("{}: names no scene", file.display()))?;
        let environment = facts["args"].as_array().and_then(|arguments| arguments.get(1)).and_then(Value::as_str);
        Ok(Self {
            name: name.to_owned(),
            scene: scenes.join(scene).to_string_lossy().into_owned(),
            environment: environment.map(|file| file.replace("{scenes}", &scenes.to_string_lossy()).into()),
            reference: image_file::read(&folder.join(format!("{name}.exr"))).map_err(|error| error.to_string())?,
        })
    }

    /// A built-in scene; its reference is kept in the temporary folder, since it takes minutes, for this very program: another
    /// one may show another picture.
    fn builtin(name: &str) -> Result<Self, String> {
        let file = std::env::temp_dir().join(kept_name(name, program()?));
        let say = |error: hashcache::Error| error.to_string();
        let reference = if file.is_file() {
            image_file::read(&file).map_err(|error| error.to_string())?
        } else {
            let mut settings = Settings { size: Some(SIZE), spp: SPP, seed: 1, ..Settings::default() };
            for (key, value) in [("cache", "none"), ("filter", "none")] {
                settings.set(key, value).map_err(|error| error.to_string())?;
            }
            let image = run::at_rest(&Preview::open(name, &settings).map_err(say)?, 1)?.last.image;
            image_file::write(&file, &image).map_err(|error| error.to_string())?;
            image
        };
        Ok(Self { name: name.to_owned(), scene: name.to_owned(), environment: None, reference })
    }

    /// Opens the scene at the reference's size and with its environment.
    pub fn open(&self, settings: &Settings) -> Result<Preview, String> {
        let settings = Settings {
            size: Some((self.reference.width, self.reference.height)),
            env: self.environment.clone(),
            ..settings.clone()
        };
        Preview::open(&self.scene, &settings).map_err(|error| error.to_string())
    }
}

/// The file that keeps a built-in scene's reference by a program.
fn kept_name(scene: &str, program: u64) -> String {
    format!("figures-{}-{}x{}-{SPP}-{program:016x}.exr", scene.replace(':', "-"), SIZE.0, SIZE.1)
}

/// A hash of this program's file: scenes, path tracing and settings are all in it.
fn program() -> Result<u64, String> {
    let file = std::env::current_exe().map_err(|error| format!("this program's file: {error}"))?;
    let bytes = std::fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let mut hasher = DefaultHasher::new();
    hasher.write(&bytes);
    Ok(hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_kept_by_program_and_scene() {
        let program = program().unwrap();
        assert_eq!(program, self::program().unwrap());
        let of = |scene, program| kept_name(scene, program);
        assert_ne!(of("builtin:cornell", program), of("builtin:cornell", program ^ 1));
        assert_ne!(of("builtin:cornell", program), of("builtin:furnace", program));
    }
}
