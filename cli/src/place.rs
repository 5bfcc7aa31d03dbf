//! A file to be written: its place is checked before the work, and it appears there whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{fmt, fs};

use hashcache::ToneMapping;
use hashcache::image_file::{self, Image, ImageError};
use tempfile::TempDir;

use crate::failure::Failure;

/// Where a file is to be, its folder resolved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    path: PathBuf,
    folder: PathBuf,
    name: PathBuf,
}

/// A file, complete beside its place.
pub struct Staged {
    place: Place,
    file: PathBuf,
    _folder: TempDir,
}

impl Place {
    /// The place that a path names, if a file can be put there.
    pub fn check(path: &Path) -> Result<Self, Failure> {
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

    /// The path as the user gave it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether both are the same file, however it is named.
    pub fn is(&self, other: &Self) -> bool {
        (&self.folder, &self.name) == (&other.folder, &other.name)
    }

    /// Refuses a place that one of the files to be read has.
    pub fn refuse_inputs<'a>(&self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
        let same = |input: &Path| matches!((self.path.canonicalize(), input.canonicalize()), (Ok(a), Ok(b)) if a == b);
        match inputs.into_iter().find(|input| same(input)) {
            None => Ok(()),
            Some(input) => Err(Failure::usage(format!(
                "{}: is {}, which is read; name another file",
                self.path.display(),
                input.display()
            ))),
        }
    }

    /// Writes a picture beside the place, in the format of the name's ending.
    pub fn stage_image(self, image: &Image, tone: ToneMapping) -> Result<Staged, Failure> {
        let (folder, file) = self.stage()?;
        image_file::write_toned(&file, image, tone).map_err(|error| match error {
            ImageError::Write { reason, .. } => self.failure(&reason),
            error => error.into(),
        })?;
        Ok(Staged { place: self, file, _folder: folder })
    }

    /// Writes bytes beside the place.
    pub fn stage_bytes(self, bytes: &[u8]) -> Result<Staged, Failure> {
        let (folder, file) = self.stage()?;
        let written = fs::File::create_new(&file).and_then(|mut out| out.write_all(bytes));
        written.map_err(|error| self.failure(&error.kind()))?;
        Ok(Staged { place: self, file, _folder: folder })
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

impl Staged {
    /// Lets the file take its name.
    pub fn commit(self) -> Result<(), Failure> {
        let target = self.place.folder.join(&self.place.name);
        fs::rename(&self.file, target).map_err(|error| self.place.failure(&error.kind()))
    }
}
