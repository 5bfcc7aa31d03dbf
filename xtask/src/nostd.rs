//! `cargo xtask no-std`: the proof that the core crates need no std.

use std::process::Command;

use crate::step::{self, Step};

/// Links a program without std that calls every core function, and runs it.
pub fn steps() -> Vec<Step> {
    vec![
        Step::cargo(
            &["build", "--quiet", "-p", "no-std-link", "--profile", "no-std"],
            "A core crate or one of its dependencies pulled in std (E0152), or misses a symbol.",
        ),
        Step::new("run no-std-link", "A core function gave another result without std than with it.", || {
            step::run_command(&mut Command::new(step::target().join("no-std").join("no-std-link")))
        }),
    ]
}
