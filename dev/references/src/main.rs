//! The full comparison with the independent renderer: 64 samples a pixel, eight seeds, seven scenes.
//! `cargo run --release -p references [-- SCENE…]`

use std::process::ExitCode;

use references::{ENERGY_TOLERANCE, FALSE_ALARM, Reference, SCENES, TRIMMED_RATIO, shared};

/// Samples a pixel, as many as the figures of the references are given for.
const SPP: u32 = 64;

/// Independent pictures.
const SEEDS: u32 = 8;

fn main() -> ExitCode {
    let Some(shared) = shared() else { return ExitCode::FAILURE };
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    println!("{SEEDS} seeds of {SPP} samples a pixel; energy ± its own standard deviation");
    println!(
        "{:<17} {:>27} {:>9}  {:>9} {:>9} {:>6}  {:>7} {:>8}  {:>8}  verdict",
        "scene", "energy r g b", "sigma", "trimmed", "Mitsuba", "ratio", "max |z|", "p", "Ms/CPU-s"
    );
    let mut all_pass = true;
    for name in SCENES.into_iter().filter(|name| wanted.is_empty() || wanted.iter().any(|w| w == name)) {
        let measured = Reference::read(&shared, name).measure(SEEDS, SPP);
        let ratio = measured.trimmed / measured.trimmed_mitsuba;
        let sigma = measured.energy_sigma.into_iter().fold(0.0, f64::max);
        let passes = measured.energy.iter().all(|ratio| (ratio - 1.0).abs() <= ENERGY_TOLERANCE)
            && ratio <= TRIMMED_RATIO
            && measured.blocks.passes(FALSE_ALARM);
        all_pass &= passes;
        let [r, g, b] = measured.energy;
        println!(
            "{name:<17} {r:>9.5}{g:>9.5}{b:>9.5} {sigma:>9.5}  {:>9.6} {:>9.6} {ratio:>6.3}  {:>7.2} {:>8.4}  {:>8.3}  {}",
            measured.trimmed,
            measured.trimmed_mitsuba,
            measured.blocks.max_abs_z,
            measured.blocks.p_value,
            measured.samples_per_cpu_s / 1e6,
            if passes { "passes" } else { "FAILS" },
        );
    }
    if all_pass { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
