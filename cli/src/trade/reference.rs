//! The picture that all others are compared with: given, or path traced here and kept in the folder.

use std::path::Path;

use hashcache::choice::{CacheKind, FilterKind};
use hashcache::{Image, Preview, Settings, ToneMapping, image_file};
use image_metrics::rel_mse;
use serde_json::{Map, Value, json};

use crate::args::Trade;
use crate::failure::Failure;
use crate::figures::view;
use crate::folder::Folder;
use crate::progress::Display;

const IMAGE: &str = "reference.exr";
const FACTS: &str = "reference.json";

/// A reference and what it is called in the table.
pub struct Reference {
    pub image: Image,
    pub name: String,
}

/// The seed of a reference, half of all seeds away from the first that is measured: no row shares its paths.
fn seed(settings: &Settings) -> u32 {
    settings.seed.wrapping_add(1 << 31)
}

impl Reference {
    /// Checks what can be checked before the scene is loaded.
    pub fn check(args: &Trade, folder: &Folder) -> Result<(), Failure> {
        let names = folder.names()?;
        let has = |name: &str| names.iter().any(|found| found == name);
        if args.reference.is_none() && has(IMAGE) && !has(FACTS) {
            let path = folder.path().join(IMAGE).display().to_string();
            return Err(Failure::other(format!("{path}: made by something else; give it by --reference {path}")));
        }
        Ok(())
    }

    /// Reads the picture that the user names.
    pub fn read(path: &Path, size: (u32, u32)) -> Result<Self, Failure> {
        let image = image_file::read(path)?;
        let name = path.display().to_string();
        if (image.width, image.height) != size {
            let (w, h) = size;
            return Err(Failure::other(format!(
                "{name}: is {}x{}, the picture {w}x{h}; give --size {}x{} or another reference",
                image.width, image.height, image.width, image.height
            )));
        }
        view(&image).map_err(|error| Failure::other(format!("{name}: {error}; give another reference")))?;
        Ok(Self { image, name })
    }

    /// Reads the folder's picture, or path traces it. Gives the preview back.
    pub fn own(
        args: &Trade,
        folder: &Folder,
        preview: Preview,
        base: &Settings,
        display: &mut Display,
    ) -> Result<(Preview, Self), Failure> {
        let half = args.reference_spp.div_ceil(2);
        let settings = Settings {
            cache: CacheKind::None,
            filter: FilterKind::None,
            spp: half,
            seed: seed(base),
            size: Some(preview.size()),
            camera: base.camera.clone(),
            env: base.env.clone(),
            env_scale: base.env_scale,
            max_bounces: base.max_bounces,
            backend: base.backend,
            threads: base.threads,
            launcher: base.launcher,
            ..Settings::default()
        };
        let facts = facts(&args.scene, &Settings { spp: 2 * half, ..settings.clone() });
        let name = IMAGE.to_owned();
        if folder.names()?.iter().any(|found| found == IMAGE) {
            same_facts(folder, &facts)?;
            let image = Self::read(&folder.path().join(IMAGE), preview.size())?.image;
            return Ok((preview, Self { image, name }));
        }
        let preview = preview.with_settings(&settings)?;
        let (image, error) = trace(&preview, half, display)?;
        let written = json!({ "made_with": facts, "estimated_relmse": error });
        // The facts first: a picture without them counts as somebody else's.
        folder.write_bytes(FACTS, format!("{written:#}\n").as_bytes())?;
        folder.write_image(IMAGE, &image, ToneMapping::default())?;
        let path = folder.path().join(IMAGE);
        display.line(&format!("{}: {} samples a pixel, its own relMSE is about {error:.2e}", path.display(), 2 * half));
        Ok((preview, Self { image, name }))
    }
}

/// Traces both halves of the samples, and tells the picture and its own error: the halves H₁ and H₂ of independent noise
/// have the mean F, and H₁ − F = (H₁ − H₂)/2 has F's variance. Stratified samples make the true error smaller.
fn trace(preview: &Preview, half: u32, display: &mut Display) -> Result<(Image, f64), Failure> {
    let mut backend = preview.backend()?;
    let mut session = preview.session(&mut backend)?;
    let camera = preview.camera();
    let total = 2 * u64::from(half);
    let mut frame = |done: u64, display: &mut Display| {
        session.frame(camera, &mut |progress| display.report("reference", done + u64::from(progress.done), total))
    };
    let first = frame(0, display)?.image;
    let whole = frame(half.into(), display)?.image;
    let error = view(&first).and_then(|first| rel_mse(first, view(&whole)?));
    let error = error.map_err(|error| Failure::other(format!("the reference: {error}; give one by --reference")))?;
    Ok((whole, error))
}

/// What decides the picture's bits: the scene and its settings, not where they are computed.
fn facts(scene: &str, settings: &Settings) -> Map<String, Value> {
    let mut facts = settings.to_json();
    for key in ["backend", "threads", "cpu.launcher"] {
        facts.remove(key);
    }
    facts.insert("scene".to_owned(), scene.into());
    facts
}

/// Refuses a picture that was made with anything else.
fn same_facts(folder: &Folder, facts: &Map<String, Value>) -> Result<(), Failure> {
    let path = folder.path().join(FACTS);
    let refused = |why: &str| {
        let line = format!("{}: {why}; name another folder, or remove this one", path.display());
        Err(Failure::other(line))
    };
    let Ok(bytes) = std::fs::read(&path) else { return refused("cannot be read") };
    let found: Value = match serde_json::from_slice(&bytes) {
        Ok(found) => found,
        Err(error) => return refused(&format!("is no JSON of an earlier sweep ({error})")),
    };
    let differs = facts.iter().find(|(key, value)| found["made_with"].get(key) != Some(value));
    match differs {
        None => Ok(()),
        Some((key, value)) => {
            let earlier = &found["made_with"][key];
            refused(&format!("the reference there was made with {key} {earlier}, this sweep has {value}"))
        }
    }
}
