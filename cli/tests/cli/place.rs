//! Runs the command in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// A folder for one run. The command's temporary files would show up in `folder` or `temporary`.
pub struct Place {
    folder: TempDir,
    temporary: TempDir,
}

/// What a run said.
pub struct Run {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Place {
    pub fn new() -> Self {
        let [folder, temporary] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        Self { folder, temporary }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The command, ready to run here.
    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hashcache"));
        command.args(args).current_dir(self.folder.path()).env("TMPDIR", self.temporary.path()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> Run {
        let Output { status, stdout, stderr } = self.command(args).output().expect("the command starts");
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Run { status: status.code().unwrap_or(-1), stdout: text(stdout), stderr: text(stderr) }
    }

    /// Runs what must succeed.
    #[track_caller]
    pub fn succeed(&self, args: &[&str]) -> Run {
        let run = self.run(args);
        assert_eq!(run.status, 0, "{args:?}: {}", run.stderr);
        run
    }

    /// The sorted names in a folder.
    pub fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).expect("a folder");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("text")).collect();
        names.sort();
        names
    }

    /// Names and bytes of all files in both folders.
    pub fn contents(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut found = Vec::new();
        list(self.folder.path(), &mut found);
        list(self.temporary.path(), &mut found);
        found.sort();
        found
    }
}

fn list(folder: &Path, found: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && !path.is_symlink() {
            list(&path, found);
            found.push((path, Vec::new()));
        } else {
            let bytes = fs::read(&path).unwrap_or_default();
            found.push((path, bytes));
        }
    }
}

/// Checks that the keys of statistics that scripts rely on are there.
#[track_caller]
pub fn has_stats(stats: &Value) {
    for key in [
        "scene",
        "backend",
        "settings",
        "needs",
        "plan",
        "time_s",
        "cpu_s",
        "rays",
        "cache",
        "peak_rss_bytes",
        "samples_per_pixel",
        "frames",
    ] {
        assert!(!stats[key].is_null(), "{key} is missing in {stats}");
    }
}
