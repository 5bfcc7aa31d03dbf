//! The `hashcache` command: reads the command line, calls the library, and tells the outcome.
//!
//! Results go to files and standard output, progress and warnings to standard error. Exit status 0: done; 2: the command
//! line is wrong whatever the files hold; 1: anything else. Each failure is one line.

mod args;
mod compare;
mod failure;
mod figures;
mod fly;
mod folder;
mod heat_map;
mod info;
mod interrupt;
mod outputs;
mod place;
mod progress;
mod render;
mod table;
mod trade;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::Parser as _;

use crate::args::{Cli, Command};
use crate::failure::Failure;

fn main() -> ExitCode {
    interrupt::install();
    let result = match Cli::try_parse() {
        Ok(cli) => run(&cli.command),
        // Help and version are answers, not errors.
        Err(error) if !error.use_stderr() => print(&error.to_string()),
        Err(error) => Err(error.into()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let _ = writeln!(io::stderr(), "error: {failure}");
            ExitCode::from(failure.status)
        }
    }
}

fn run(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Render(args) => render::run(args),
        Command::Fly(args) => fly::run(args),
        Command::Plan(args) => print(&info::plan(args)?),
        Command::Trade(args) => print(&trade::run(args)?),
        Command::Info(args) => print(&info::scene(args)?),
        Command::Compare(args) => print(&compare::run(args)?),
    }
}

/// Writes to standard output. A reader that has seen enough (`| head`) is no failure.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::other(format!("standard output cannot be written ({error})")))
        }
        _ => Ok(()),
    }
}
