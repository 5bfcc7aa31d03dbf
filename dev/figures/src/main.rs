//! The figures that the documentation quotes, each by one command.
//! `cargo run --release -p figures -- VERB [SCENE…] [--set KEY=VALUE]… [--peer FILE]`
//!
//! A verb prints a Markdown table. Scenes are those with an independent reference, under `HASHCACHE_SHARED`; without names a
//! verb takes its own selection. Times are CPU-seconds: wall time is noise on a shared machine, and so is a comparison of
//! CPU-seconds from two machines.

mod arguments;
mod coverage;
mod densities;
mod frontier;
mod lag;
mod layers;
mod leaks;
mod peer;
mod resolution;
mod run;
mod score;
mod sequence;
mod spp;
mod stages;
mod still;
mod subject;
mod table;

use std::process::ExitCode;

use arguments::Arguments;

/// A verb: its name, what it prints, and how.
type Verb = (&'static str, &'static str, fn(&Arguments) -> Result<(), String>);

const VERBS: [Verb; 10] = [
    ("coverage", "how often the interval that a check tells holds a picture's bias", coverage::run),
    ("frontier", "first and last frame of a move beside path tracing with Open Image Denoise", frontier::run),
    ("lag", "what is left of the light of before after the lights have changed, by what cells keep", lag::run),
    ("leaks", "light through a thin wall, by its thickness, with each remedy on and off", leaks::run),
    (
        "layers",
        "error behind mirrors and glass: layers filtered by themselves beside the surfaces seen first",
        layers::run,
    ),
    ("resolution", "error against the octree's resolution", resolution::run),
    ("spp", "error against samples a pixel, cache beside path tracing", spp::run),
    ("sequence", "error against the frames that came before", sequence::run),
    ("stages", "time by stage, of a first frame and of a frame of a move", stages::run),
    ("densities", "cells and bytes by level", densities::run),
];

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1);
    let wanted = words.next().unwrap_or_default();
    let Some((_, _, run)) = VERBS.iter().find(|(name, ..)| *name == wanted) else {
        eprintln!("figures VERB [SCENE…] [--set KEY=VALUE]… [--peer FILE]");
        for (name, about, _) in VERBS {
            eprintln!("  {name:<11}{about}");
        }
        return ExitCode::from(2);
    };
    match Arguments::parse(words).and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("figures {wanted}: {reason}");
            ExitCode::FAILURE
        }
    }
}
