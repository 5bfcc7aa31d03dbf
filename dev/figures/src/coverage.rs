//! How often the interval that a check of a picture tells holds the picture's bias.

use hashcache::{Image, Preview, Rendered, Settings};

use crate::arguments::Arguments;
use crate::table;

/// Scenes whose light many paths find.
const SCENES: [&str; 3] = ["builtin:cornell", "builtin:interior", "builtin:instances"];

/// Pictures, each with a check of its own.
const SEEDS: u32 = 200;

/// Intervals of 95 % that have to hold: 93 of 100, which true ones fall short of once in thirteen times.
const LEAST: u32 = 186;

/// Paths a pixel of the picture that tells the truth: 256 times those of a check of all pixels, for a sixteenth of its error.
const TRUTH_SPP: u32 = 4096;

/// Small pictures, so that thousands of them take minutes.
const SMALL: [(&str, &str); 2] = [("size", "24x24"), ("octree.resolution", "32")];

const VARIANTS: [(&str, &[(&str, &str)]); 2] = [
    ("octree, a quarter of the pixels", &[("cache", "octree"), ("check.fraction", "0.25")]),
    ("grid, all pixels", &[("cache", "grid"), ("check.fraction", "1")]),
];

/// A row for each scene and cache; an error where too few intervals hold.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!(
        "{}; pictures of 24×24 pixels, {SEEDS} seeds; widths and bias in per cent of the light\n",
        arguments.changed()
    );
    table::head(&["scene", "cache, checked", "intervals that hold", "half width", "bias"]);
    let mut short = Vec::new();
    for name in arguments.scenes(&SCENES) {
        let mut plain = arguments.settings(&SMALL)?;
        set(&mut plain, &[("cache", "none"), ("filter", "none")])?;
        // A seed of its own, so that the truth is independent of what is checked.
        (plain.spp, plain.seed) = (TRUTH_SPP, 1_000_000);
        let say = |error: hashcache::Error| error.to_string();
        let truth = mean(&Preview::open(&name, &plain).map_err(say)?.render(&mut |_| ()).map_err(say)?.image);
        for (variant, changes) in VARIANTS {
            let mut settings = arguments.settings(&SMALL)?;
            set(&mut settings, changes)?;
            let mut preview = Preview::open(&name, &settings).map_err(say)?;
            let (mut held, mut half, mut bias) = (0, 0.0, 0.0);
            for seed in 0..SEEDS {
                preview = preview.with_seed(seed);
                let Rendered { image, stats } = preview.render(&mut |_| ()).map_err(say)?;
                let told = stats.check.and_then(|check| check.bias).ok_or("a check of too few pixels")?;
                let is = mean(&image) - truth;
                held += u32::from(told.low <= is && is <= told.high);
                half += 0.5 * (told.high - told.low) / f64::from(SEEDS);
                bias += is / f64::from(SEEDS);
            }
            let of_light = |value: f64| format!("{:.2}", 100.0 * value / truth);
            table::row(&[
                name.clone(),
                variant.to_owned(),
                format!("{held} of {SEEDS}"),
                of_light(half),
                of_light(bias),
            ]);
            if held < LEAST {
                short.push(format!("{name}, {variant}: {held}"));
            }
        }
    }
    if short.is_empty() { Ok(()) } else { Err(format!("fewer than {LEAST} of {SEEDS} hold: {}", short.join("; "))) }
}

fn set(settings: &mut Settings, changes: &[(&str, &str)]) -> Result<(), String> {
    changes.iter().try_for_each(|(key, value)| settings.set(key, value)).map_err(|error| error.to_string())
}

/// Mean luminance.
fn mean(image: &Image) -> f64 {
    let luminance = |[r, g, b]: [f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    image.pixels.iter().map(|pixel| luminance(pixel.map(f64::from))).sum::<f64>() / image.pixels.len() as f64
}
