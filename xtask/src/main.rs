//! The developer's command: `cargo xtask VERB`.
//!
//! It depends on no crate of the workspace and spawns cargo, so a verb compiles only what it runs. Each verb prepares
//! a list of [`step::Step`]s, each with what to do when it fails; one runner executes them.

mod bench;
mod check;
mod deps;
mod nostd;
mod render;
mod step;
mod test;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Builds, runs and checks hashcache.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version)]
struct Arguments {
    /// Run the remaining steps after one failed, and list all failures.
    #[arg(long, global = true)]
    keep_going: bool,
    /// Print the steps instead of running them.
    #[arg(long, global = true)]
    list: bool,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Build, render `builtin:cornell`, and print time, rays and error against a reference of its own.
    Render,
    /// All that CI runs: check, no-std, every test.
    Test,
    /// Formatting, clippy for each feature set, docs, licences, arrows between crates.
    Check,
    /// Link a program without std that calls every core function, and run it.
    NoStd,
    /// Compare the dependencies between the crates with the permitted ones.
    Deps,
    /// Run the benchmarks and print each as a ratio to the baseline of the same run.
    Bench {
        /// Only the benchmarks of this package.
        #[arg(long)]
        package: Option<String>,
        /// Only benchmarks whose id contains this.
        filter: Option<String>,
    },
    /// What `.ci/run` runs: as `test`, and a GPU adapter must be there.
    Ci,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let steps = match &arguments.verb {
        Verb::Render => render::steps(),
        Verb::Test => test::steps(false),
        Verb::Check => check::steps(),
        Verb::NoStd => nostd::steps(),
        Verb::Deps => deps::steps(),
        Verb::Bench { package, filter } => bench::steps(package.as_deref(), filter.as_deref()),
        Verb::Ci => test::steps(true),
    };
    step::run(&steps, arguments.keep_going, arguments.list)
}
