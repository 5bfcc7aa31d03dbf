//! A CSV file that grows by whole rows.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::PathBuf;

use crate::failure::Failure;
use crate::folder::Folder;
use crate::interrupt::uninterrupted;

/// An open table.
pub struct Table {
    path: PathBuf,
    file: File,
}

impl Table {
    /// Puts a table of these rows, the first with the columns' names, into a folder in place of one of the same name.
    pub fn create<'a>(
        folder: &Folder,
        name: &str,
        rows: impl IntoIterator<Item = &'a [String]>,
    ) -> Result<Self, Failure> {
        let path = folder.path().join(name);
        let mut bytes = Vec::new();
        for row in rows {
            bytes.extend(line(row));
        }
        folder.write_bytes(name, &bytes)?;
        let opened = OpenOptions::new().append(true).open(&path);
        let file = opened
            .map_err(|error| Failure::other(format!("{}: cannot be written ({})", path.display(), error.kind())))?;
        Ok(Self { path, file })
    }

    /// Adds a row.
    pub fn add(&mut self, row: &[String]) -> Result<(), Failure> {
        let line = line(row);
        uninterrupted(|| self.file.write_all(&line)).map_err(|error| {
            let line =
                format!("{}: a row cannot be added ({}); make room and start again", self.path.display(), error.kind());
            Failure::other(line)
        })
    }
}

/// A row with its line break.
fn line(row: &[String]) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // A vector takes whatever is written.
    let _ = writer.write_record(row);
    writer.into_inner().unwrap_or_default()
}

/// A cell for a number that may not exist.
pub fn cell(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}
