//! Calls the core crates' functions in a program without std, and checks what they return.
//!
//! `cargo build -p no-std-link --profile no-std` links it: that profile aborts on panic, which selects the form
//! without std below. A dependency that needs std then fails with E0152 (two panic handlers). With
//! `--features alloc` the program brings an allocator and calls the kernels too. Any other profile gives an ordinary
//! program that makes the same calls, so that checks over the whole workspace pass, and both forms must agree.
//!
//! Exit status 0: all results were right. 1: the first wrong one is named on standard error.
#![cfg_attr(panic = "abort", no_std, no_main)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod checks;
mod core_crate;
mod filter;
mod floor;
mod grid;
mod integrator;
#[cfg(feature = "alloc")]
mod kernels;
mod launches;
mod octree;
#[cfg(panic = "abort")]
mod runtime;

use checks::Checks;

fn run() -> Checks {
    let mut checks = Checks::default();
    core_crate::run(&mut checks);
    launches::run(&mut checks);
    octree::run(&mut checks);
    grid::run(&mut checks);
    integrator::run(&mut checks);
    filter::run(&mut checks);
    #[cfg(feature = "alloc")]
    kernels::run(&mut checks);
    checks
}

#[cfg(not(panic = "abort"))]
fn main() -> std::process::ExitCode {
    match run().first_wrong() {
        None => std::process::ExitCode::SUCCESS,
        Some(name) => {
            eprintln!("wrong: {name}");
            std::process::ExitCode::FAILURE
        }
    }
}
