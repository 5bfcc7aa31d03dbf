//! `cargo xtask no-std`: the proof that the core crates need no std.

use std::process::Command;

use crate::step::{self, Step};

/// Links a program without std that calls every core function, and runs it: without and with an allocator.
pub fn steps() -> Vec<Step> {
    // With `alloc` the program brings an allocator of its own and calls what stands behind that feature, too.
    ["", "alloc"].into_iter().flat_map(with_features).collect()
}

fn with_features(features: &'static str) -> [Step; 2] {
    [
        Step::cargo(
            &["build", "--quiet", "-p", "no-std-link", "--profile", "no-std", "--features", features],
            "A core crate or one of its dependencies pulled in std (E0152), or misses a symbol.",
        ),
        Step::new("run no-std-link", "A core function gave another result without std than with it.", || {
            step::run_command(&mut Command::new(step::target().join("no-std").join("no-std-link")))
        }),
    ]
}
