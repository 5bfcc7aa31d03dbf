//! The files of a render: checked before the work, written whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{fmt, fs};

use hashcache::image_file::{self, Image, ImageError};
use tempfile::TempDir;

use crate::failure::Failure;

/// Where the results go. Made only when each place can be written.
pub struct Outputs {
    images: Vec<Place>,
    stats: Option<Place>,
}

/// A file to be written, its folder resolved.
struct Place {
    path: PathBuf,
    folder: PathBuf,
    name: PathBuf,
}

impl Outputs {
    /// Checks formats and folders. Without `-o` and `--stats` the image is `SCENE.png` in the current folder, which must not
    /// be there yet: nobody asked to replace it.
    pub fn check(scene: &str, images: &[PathBuf], stats: Option<&Path>) -> Result<Self, Failure> {
        for path in images {
            image_file::format_of(path)?;
        }
        let default = if images.is_empty() && stats.is_none() { Some(default_name(scene)?) } else { None };
        let images = images.iter().chain(&default).map(|path| Place::check(path)).collect::<Result<Vec<_>, _>>()?;
        let outputs = Self { images, stats: stats.map(Place::check).transpose()? };
        let places: Vec<_> = outputs.images.iter().chain(&outputs.stats).collect();
        for (i, place) in places.iter().enumerate() {
            if places[..i].iter().any(|earlier| (&earlier.folder, &earlier.name) == (&place.folder, &place.name)) {
                return Err(Failure::usage(format!("{}: named for two outputs; leave one out", place.path.display())));
            }
        }
        Ok(outputs)
    }

    /// Writes all files: first completely beside their places, then each takes its name.
    pub fn write(&self, image: &Image, stats: &[u8]) -> Result<(), Failure> {
        let mut staged = Vec::new();
        for place in &self.images {
            let (folder, file) = place.stage()?;
            image_file::write(&file, image).map_err(|error| match error {
                ImageError::Write { reason, .. } => place.failure(&reason),
                error => error.into(),
            })?;
            staged.push((place, folder, file));
        }
        if let Some(place) = &self.stats {
            let (folder, file) = place.stage()?;
            let written = fs::File::create_new(&file).and_then(|mut out| out.write_all(stats));
            written.map_err(|error| place.failure(&error.kind()))?;
            staged.push((place, folder, file));
        }
        for (place, _folder, file) in &staged {
            fs::rename(file, place.folder.join(&place.name)).map_err(|error| place.failure(&error.kind()))?;
        }
        Ok(())
    }

    /// The files' names as the user gave them.
    pub fn names(&self) -> String {
        let names = self.images.iter().chain(&self.stats).map(|place| place.path.display().to_string());
        names.collect::<Vec<_>>().join(", ")
    }
}

impl Place {
    fn check(path: &Path) -> Result<Self, Failure> {
        let refused = |why: &str| Err(Failure::other(format!("{}: cannot be written: {why}", path.display())));
        let Some(name) = path.file_name() else {
            return refused("the path ends in no file name; add one");
        };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let Some(folder) = folder.canonicalize().ok().filter(|folder| folder.is_dir()) else {
            return refused(&format!("there is no folder {}; create it first", folder.display()));
        };
        // A rename would put the result in a link's or device's place.
        if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
            return refused("the name belongs to a folder, link or device; name a file");
        }
        let place = Self { path: path.to_owned(), name: name.into(), folder };
        place.stage()?;
        Ok(place)
    }

    /// A folder that goes away with the value, in the place's own folder so that a rename suffices, and the file in it.
    fn stage(&self) -> Result<(TempDir, PathBuf), Failure> {
        let folder = tempfile::Builder::new().prefix(".hashcache-").tempdir_in(&self.folder);
        let folder = folder.map_err(|error| self.failure(&error.kind()))?;
        let file = folder.path().join(&self.name);
        Ok((folder, file))
    }

    /// The reason without the names of temporary files, which say nothing to the user.
    fn failure(&self, reason: &dyn fmt::Display) -> Failure {
        Failure::other(format!("{}: cannot be written ({reason}); choose another place", self.path.display()))
    }
}

/// `cornell.png` for `builtin:cornell` and for `scenes/cornell.gltf`.
fn default_name(scene: &str) -> Result<PathBuf, Failure> {
    let name = scene.strip_prefix("builtin:").map(Path::new).or_else(|| Path::new(scene).file_stem().map(Path::new));
    let mut name = name.and_then(Path::file_name).unwrap_or("image".as_ref()).to_owned();
    name.push(".png");
    let path = PathBuf::from(name);
    if path.symlink_metadata().is_ok() {
        let line = format!("{}: exists; name the image with -o, also to replace it", path.display());
        return Err(Failure::other(line));
    }
    Ok(path)
}
