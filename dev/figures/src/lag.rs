//! What is left of the light of before after the lights have changed.

use hashcache::Image;

use crate::arguments::Arguments;
use crate::run;
use crate::score::Score;
use crate::still::Still;
use crate::table;

/// Frames before the change, and after it.
const BEFORE: u32 = 16;
const AFTER: u32 = 32;

/// Factors on the light before and after a change.
const CHANGES: [(&str, f32, f32); 2] = [("dimmed to a tenth", 1.0, 0.1), ("ten times brighter", 0.1, 1.0)];

/// A name, and the settings.
const VARIANTS: [(&str, &[(&str, &str)]); 7] = [
    ("octree, emptied", &[("cache", "octree")]),
    ("grid, emptied", &[("cache", "grid")]),
    ("grid, 16 kept", &[("cache", "grid"), ("grid.history", "16")]),
    ("grid, 64 kept", &[("cache", "grid"), ("grid.history", "64")]),
    ("grid, 256 kept", &[("cache", "grid"), ("grid.history", "256")]),
    ("grid, 1024 kept", &[("cache", "grid"), ("grid.history", "1024")]),
    ("grid, 4096 kept", &[("cache", "grid"), ("grid.history", "4096")]),
];

/// Frames until the picture's mean has gone 90 % of its way; the sum over frames of the share that it still has to go; and
/// relMSE of the first and the last frame after the change.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}; {BEFORE} frames, then {AFTER} with other light\n", arguments.changed());
    table::head(&["scene", "light", "cache", "frames to 90 %", "ghost in frames", "relMSE, first frame", "last frame"]);
    for name in arguments.scenes(&["builtin:cornell"]) {
        let still = Still::read(&name)?;
        for (change, old, new) in CHANGES {
            for (variant, changes) in VARIANTS {
                let mut settings = arguments.settings(&[])?;
                for (key, value) in changes {
                    settings.set(key, value).map_err(|error| error.to_string())?;
                }
                let frames = run::lit(&still.open(&settings)?, &[(old, BEFORE), (new, AFTER)])?;
                let (before, after) = frames.split_at(BEFORE as usize);
                let reference = scaled(&still.reference, new);
                let from = before.last().map_or(0.0, mean);
                let ways = after.iter().map(|image| (mean(image) - from) / (mean(&reference) - from));
                let left: Vec<f64> = ways.map(|way| 1.0 - way).collect();
                let within = left.iter().position(|left| *left <= 0.1);
                let [first, last] = [after.first(), after.last()]
                    .map(|image| Score::relmse(image.ok_or("there is no frame")?, &reference).map(table::error));
                table::row(&[
                    name.clone(),
                    change.to_owned(),
                    variant.to_owned(),
                    within.map_or(format!("over {AFTER}"), |frames| (frames + 1).to_string()),
                    format!("{:.2}", left.iter().sum::<f64>()),
                    first?,
                    last?,
                ]);
            }
        }
    }
    Ok(())
}

fn scaled(image: &Image, factor: f32) -> Image {
    let pixels = image.pixels.iter().map(|pixel| pixel.map(|v| v * factor)).collect();
    Image { pixels, ..*image }
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flatten().map(|v| f64::from(*v)).sum();
    sum / (3.0 * image.pixels.len() as f64)
}
