//! `cargo xtask check`: what can be said about the tree without running it.

use std::process::Command;

use crate::deps;
use crate::step::{self, Step};

/// Crates without std and the feature sets in which each must stand.
pub const NO_STD_PACKAGES: [&str; 5] = [
    "hashcache-backend-api",
    "hashcache-core",
    "hashcache-hashgrid",
    "hashcache-layered-filter",
    "hashcache-pt-integrator",
];

/// Formatting, lints, docs, licences, arrows.
pub fn steps() -> Vec<Step> {
    let mut steps = vec![
        Step::cargo(&["fmt", "--all", "--check"], "Run `cargo fmt --all`."),
        Step::cargo(
            &["clippy", "--workspace", "--all-targets", "--all-features", "--", "-D", "warnings"],
            "Mend what clippy names, or `#[expect]` it at the spot with a reason.",
        ),
    ];
    for package in NO_STD_PACKAGES {
        for features in ["", "alloc"] {
            steps.push(Step::cargo(
                &["clippy", "-p", package, "--no-default-features", "--features", features, "--", "-D", "warnings"],
                "The crate must stand in every feature set.",
            ));
        }
    }
    steps.push(Step::cargo_with(
        &["doc", "--workspace", "--all-features", "--no-deps"],
        &[("RUSTDOCFLAGS", "-D warnings")],
        "Mend the links and examples that rustdoc names.",
    ));
    steps.extend(deps::steps());
    steps.push(Step::new(
        "cargo deny check bans licenses sources",
        "Replace the dependency, or permit it in deny.toml with a reason.",
        || {
            if step::output(Command::new(step::cargo()).args(["deny", "--version"])).is_err() {
                eprintln!("    skipped: cargo-deny is not installed (cargo install --locked cargo-deny)");
                return Ok(());
            }
            let arguments = ["deny", "--workspace", "--all-features", "check", "bans", "licenses", "sources"];
            step::run_command(Command::new(step::cargo()).args(arguments).current_dir(step::root()))
        },
    ));
    steps
}
