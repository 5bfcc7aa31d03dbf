//! Our path tracer against an independent renderer, at a size that every test run can afford. The whole comparison
//! is `cargo run --release -p references`.

use references::{ENERGY_TOLERANCE, FALSE_ALARM, Reference, SCENES, TRIMMED_RATIO, shared};

/// Samples a pixel of one picture.
const SPP: u32 = 4;

/// Pictures, enough for a variance of their mean.
const SEEDS: u32 = 4;

/// Standard deviations of the energy that noise may explain beyond the tolerance: 21 comparisons at 4.5 fail by chance
/// once in seven thousand runs.
const SIGMAS: f64 = 4.5;

/// Scenes with light that only few paths bring, such as a caustic: so few samples do not tell the spread of a block. The
/// whole comparison, with 32 times as many, holds their blocks too.
const RARE_LIGHT: [&str; 1] = ["cornell-specular"];

#[test]
fn pictures_are_those_of_an_independent_renderer() {
    let Some(shared) = shared() else { return };
    let mut wrong = Vec::new();
    for name in SCENES {
        let measured = Reference::read(&shared, name).measure(SEEDS, SPP);
        for (channel, (ratio, sigma)) in measured.energy.iter().zip(measured.energy_sigma).enumerate() {
            // Four seeds tell their own spread only roughly, so it counts at least as much as its usual error.
            if (ratio - 1.0).abs() > ENERGY_TOLERANCE + SIGMAS * 1.5 * sigma {
                wrong.push(format!("{name}: energy of channel {channel} is {ratio:.5} ± {sigma:.5}"));
            }
        }
        let ratio = measured.trimmed / measured.trimmed_mitsuba;
        if ratio > TRIMMED_RATIO {
            wrong.push(format!("{name}: trimmed relMSE is {ratio:.3} of Mitsuba's"));
        }
        if !RARE_LIGHT.contains(&name) && !measured.blocks.passes(FALSE_ALARM) {
            let (z, worst) = (measured.blocks.max_abs_z, measured.blocks.worst);
            wrong.push(format!("{name}: block {worst:?} differs by {z:.1} sigma, p = {}", measured.blocks.p_value));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
