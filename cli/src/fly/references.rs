//! A move's references: a folder with a picture for each frame, or for some.

use std::path::{Path, PathBuf};

use hashcache::{Image, image_file};

use super::frame_name;
use crate::failure::Failure;
use crate::figures::view;

/// The reference of each frame that has one.
pub struct References {
    files: Vec<Option<PathBuf>>,
}

impl References {
    /// Looks which frames have one; at least one frame must.
    pub fn find(folder: &Path, frames: u32) -> Result<Self, Failure> {
        let file = |index| folder.join(frame_name(index, "exr"));
        let files: Vec<_> = (0..frames).map(|index| Some(file(index)).filter(|file| file.is_file())).collect();
        if files.iter().all(Option::is_none) {
            return Err(Failure::other(format!(
                "{}: holds no reference of this move; name a folder with frame_0000.exr to {}",
                folder.display(),
                frame_name(frames.saturating_sub(1), "exr"),
            )));
        }
        Ok(Self { files })
    }

    /// Checks that all can be read and are of this size, so that no hour of rendering ends in a failure.
    pub fn check(&self, size: (u32, u32)) -> Result<(), Failure> {
        let (width, height) = size;
        for file in self.files.iter().flatten() {
            let image = read(file)?;
            if (image.width, image.height) != size {
                return Err(Failure::other(format!(
                    "{}: is {}x{}, the frames {width}x{height}; give --size {}x{} or other references",
                    file.display(),
                    image.width,
                    image.height,
                    image.width,
                    image.height
                )));
            }
        }
        Ok(())
    }

    /// The reference of a frame. Not kept in memory: there may be thousands.
    pub fn read(&self, index: usize) -> Result<Option<Image>, Failure> {
        self.files.get(index).and_then(Option::as_deref).map(read).transpose()
    }
}

fn read(file: &Path) -> Result<Image, Failure> {
    let image = image_file::read(file)?;
    view(&image).map_err(|error| Failure::other(format!("{}: {error}; render it anew", file.display())))?;
    Ok(image)
}
