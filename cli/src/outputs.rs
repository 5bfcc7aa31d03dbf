//! The files of a render: checked before the work, written whole or not at all.

use std::path::{Path, PathBuf};

use hashcache::image_file::{self, Format, Image};
use hashcache::{Settings, Stats, ToneMapping};

use crate::failure::Failure;
use crate::folder::Folder;
use crate::interrupt::uninterrupted;
use crate::place::{Place, Staged};

/// Where the results go. Made only when each place can be written.
pub struct Outputs {
    images: Vec<Place>,
    stats: Option<Place>,
    aovs: Option<Folder>,
    tone: ToneMapping,
}

impl Outputs {
    /// Checks formats and folders. Without any output named the image is `SCENE.png` in the current folder, which must not
    /// be there yet: nobody asked to replace it.
    pub fn check(
        scene: &str,
        images: &[PathBuf],
        stats: Option<&Path>,
        aovs: Option<&Path>,
        settings: &Settings,
    ) -> Result<Self, Failure> {
        let tone = settings.tone_mapping();
        let formats = images.iter().map(|path| image_file::format_of(path)).collect::<Result<Vec<_>, _>>()?;
        let unnamed = images.is_empty() && stats.is_none() && aovs.is_none();
        if !unnamed && !formats.contains(&Format::Png) {
            let named = images.first().map_or("an output without a picture".into(), |path| path.display().to_string());
            refuse_tone(tone, &named, "write a .png")?;
        }
        let default = if unnamed { Some(default_name(scene)?) } else { None };
        let aovs = aovs.map(Folder::check).transpose()?;
        let outputs = uninterrupted(|| -> Result<_, Failure> {
            let images = images.iter().chain(&default).map(|path| Place::check(path)).collect::<Result<Vec<_>, _>>()?;
            Ok(Self { images, stats: stats.map(Place::check).transpose()?, aovs, tone })
        })?;
        let places: Vec<_> = outputs.places().collect();
        for (i, place) in places.iter().enumerate() {
            place.refuse_inputs(inputs(scene, settings))?;
            if places[..i].iter().any(|earlier| earlier.is(place)) {
                return Err(Failure::usage(format!(
                    "{}: named for two outputs; leave one out",
                    place.path().display()
                )));
            }
        }
        Ok(outputs)
    }

    /// Whether a folder for pictures beside the picture is named.
    pub fn want_aovs(&self) -> bool {
        self.aovs.is_some()
    }

    /// Writes all files: first completely beside their places, then each takes its name.
    pub fn write(&self, image: &Image, stats: &[u8], aovs: &[(&str, Image)]) -> Result<(), Failure> {
        uninterrupted(|| {
            let made = self.aovs.as_ref().map(Folder::make).transpose()?.unwrap_or(false);
            let written = self.stage(image, stats, aovs).and_then(|all| all.into_iter().try_for_each(Staged::commit));
            if let (Err(_), true, Some(folder)) = (&written, made, &self.aovs) {
                folder.unmake();
            }
            written
        })
    }

    fn stage(&self, image: &Image, stats: &[u8], aovs: &[(&str, Image)]) -> Result<Vec<Staged>, Failure> {
        let mut staged = Vec::new();
        for place in &self.images {
            staged.push(place.clone().stage_image(image, self.tone)?);
        }
        if let Some(place) = &self.stats {
            staged.push(place.clone().stage_bytes(stats)?);
        }
        if let Some(folder) = &self.aovs {
            for (name, image) in aovs {
                staged.push(Place::check(&folder.path().join(format!("{name}.exr")))?.stage_image(image, self.tone)?);
            }
        }
        Ok(staged)
    }

    fn places(&self) -> impl Iterator<Item = &Place> {
        self.images.iter().chain(&self.stats)
    }

    /// The files' names as the user gave them.
    pub fn names(&self) -> String {
        let names = self.places().map(Place::path).chain(self.aovs.as_ref().map(Folder::path));
        names.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
    }
}

/// The files that a scene and its settings name.
pub fn inputs<'a>(scene: &'a str, settings: &'a Settings) -> impl Iterator<Item = &'a Path> {
    [Some(Path::new(scene)), settings.env.as_deref(), settings.camera.as_deref().map(Path::new)].into_iter().flatten()
}

/// Statistics as a file's bytes.
pub fn stats_bytes(stats: &Stats) -> Result<Vec<u8>, Failure> {
    let mut text = serde_json::to_vec_pretty(stats).map_err(|error| Failure::other(error.to_string()))?;
    text.push(b'\n');
    Ok(text)
}

/// Refuses exposure and curve where `output` holds radiance as it is.
pub fn refuse_tone(tone: ToneMapping, output: &str, instead: &str) -> Result<(), Failure> {
    if tone == ToneMapping::default() {
        return Ok(());
    }
    let key = if tone.curve == ToneMapping::default().curve { "image.exposure" } else { "image.tonemap" };
    Err(Failure::usage(format!("{key} does not go with {output}: it is for what a screen shows; {instead}")))
}

/// `cornell.png` for `builtin:cornell` and for `scenes/cornell.gltf`; `thin-wall-0.1.png` for `builtin:thin-wall:0.1`,
/// since not every system takes a colon in a name.
fn default_name(scene: &str) -> Result<PathBuf, Failure> {
    let name = scene.strip_prefix("builtin:").map(Path::new).or_else(|| Path::new(scene).file_stem().map(Path::new));
    let mut name = name.and_then(Path::file_name).unwrap_or("image".as_ref()).to_owned();
    if let (true, Some(text)) = (scene.starts_with("builtin:"), name.to_str()) {
        name = text.replace(':', "-").into();
    }
    name.push(".png");
    let path = PathBuf::from(name);
    if path.symlink_metadata().is_ok() {
        let line = format!("{}: exists; name the image with -o, also to replace it", path.display());
        return Err(Failure::other(line));
    }
    Ok(path)
}
