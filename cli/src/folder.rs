//! A folder for results: checked before the work, made when the first file is there to be put into it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io};

use hashcache::{Image, ToneMapping};

use crate::failure::Failure;
use crate::interrupt::uninterrupted;
use crate::place::{Place, Staged};

/// A folder that is there, or can be made.
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// The folder that a path names, if files can be put into it. Its own folder must be there.
    pub fn check(path: &Path) -> Result<Self, Failure> {
        let refused = |why: &str| Err(Failure::other(format!("{}: cannot be written: {why}", path.display())));
        let parent = match path.symlink_metadata() {
            Ok(_) if path.is_dir() => path,
            Ok(_) => return refused("the name belongs to something that is no folder; name a folder"),
            Err(_) => match path.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent,
                _ => Path::new("."),
            },
        };
        if !parent.is_dir() {
            return refused(&format!("there is no folder {}; create it first", parent.display()));
        }
        let tried = uninterrupted(|| tempfile::Builder::new().prefix(".hashcache-").tempdir_in(parent).map(drop));
        if let Err(error) = tried {
            return refused(&format!("{}; choose another place", error.kind()));
        }
        Ok(Self { path: path.to_owned() })
    }

    /// The folder as the user named it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The names of everything in it; none if it is not there yet.
    pub fn names(&self) -> Result<Vec<OsString>, Failure> {
        let entries = match fs::read_dir(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            other => other,
        };
        let names = entries.and_then(|entries| entries.map(|entry| entry.map(|entry| entry.file_name())).collect());
        names.map_err(|error| {
            Failure::other(format!("{}: cannot be read ({}); choose another folder", self.path.display(), error.kind()))
        })
    }

    /// Writes a picture into it, whole or not at all.
    pub fn write_image(&self, name: &str, image: &Image, tone: ToneMapping) -> Result<(), Failure> {
        uninterrupted(|| self.put(name, |place| place.stage_image(image, tone)))
    }

    /// Writes a file into it, whole or not at all.
    pub fn write_bytes(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        uninterrupted(|| self.put(name, |place| place.stage_bytes(bytes)))
    }

    /// Removes a file of this name, if there is one.
    pub fn remove(&self, name: &str) -> Result<(), Failure> {
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(Failure::other(format!("{}: cannot be replaced ({})", path.display(), error.kind())))
            }
            _ => Ok(()),
        }
    }

    fn put(&self, name: &str, stage: impl FnOnce(Place) -> Result<Staged, Failure>) -> Result<(), Failure> {
        let made = self.make()?;
        let done = Place::check(&self.path.join(name)).and_then(stage).and_then(Staged::commit);
        if done.is_err() && made {
            self.unmake();
        }
        done
    }

    /// Makes the folder and tells whether it was not there before. Call it while uninterrupted.
    pub fn make(&self) -> Result<bool, Failure> {
        match fs::create_dir(&self.path) {
            Ok(()) => Ok(true),
            Err(_) if self.path.is_dir() => Ok(false),
            Err(error) => {
                let line = format!("{}: cannot be made ({}); choose another place", self.path.display(), error.kind());
                Err(Failure::other(line))
            }
        }
    }

    /// Takes the folder away again if it is empty.
    pub fn unmake(&self) {
        let _ = fs::remove_dir(&self.path);
    }
}
