//! Light through a wall: the built-in scene `thin-wall`, whose right room is black.

use hashcache::scene::View;
use hashcache::{Image, Preview};

use crate::arguments::Arguments;
use crate::run;
use crate::table;

/// Cells along the box's largest side, 4 m: one is near four footprints of its back wall, so that the finest level is the
/// one asked and a thickness in cells means something.
const RESOLUTION: f64 = 64.0;
const CELL: f64 = 1.01 * 4.0 / RESOLUTION;

/// The wall's thickness in cells.
const THICKNESSES: [f64; 8] = [0.01, 0.05, 0.1, 0.25, 0.5, 1.0, 1.5, 2.0];

/// Frames at rest: enough that noise does not count.
const FRAMES: u32 = 8;

/// What is switched: a name, and the settings that differ from the ones in force.
const VARIANTS: [(&str, &[(&str, &str)]); 6] = [
    ("in force", &[]),
    ("without jitter", &[("octree.jitter", "0")]),
    ("without coarser cells", &[("octree.max_climb", "0")]),
    ("direct light traced", &[("cache.direct", "traced")]),
    ("direct light cached", &[("cache.direct", "cached")]),
    ("without filter", &[("filter", "none")]),
];

/// Light that the dark room shows over what the bright room shows, in per cent.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}; octree.resolution={RESOLUTION}, {FRAMES} frames at rest; leak in per cent\n", arguments.changed());
    let columns: Vec<_> = VARIANTS.iter().map(|(name, _)| *name).collect();
    table::head(&["thickness in cells", "in metres"].into_iter().chain(columns).collect::<Vec<_>>());
    for cells in THICKNESSES {
        let thickness = cells * CELL;
        let mut row = vec![format!("{cells}"), format!("{thickness:.5}")];
        for (_, changes) in VARIANTS {
            let resolution = RESOLUTION.to_string();
            let base = [("cache", "octree"), ("octree.resolution", resolution.as_str())];
            let mut settings = arguments.settings(&base)?;
            for (key, value) in changes {
                settings.set(key, value).map_err(|error| error.to_string())?;
            }
            let scene = format!("builtin:thin-wall:{thickness}");
            let preview = Preview::open(&scene, &settings).map_err(|error| error.to_string())?;
            let image = run::at_rest(&preview, FRAMES)?.last.image;
            row.push(format!("{:.3}", 100.0 * leak(&image, thickness)?));
        }
        table::row(&row);
    }
    Ok(())
}

/// The sum of the pixels that look into the right room over that of those that look into the left one.
fn leak(image: &Image, thickness: f64) -> Result<f64, String> {
    let loaded = hashcache::scene::load("builtin:thin-wall", &hashcache::scene::LoadOptions::default());
    let loaded = loaded.map_err(|error| error.to_string())?;
    let view = loaded.view(None).map_err(|error| error.to_string())?;
    let [mut left, mut right] = [0.0; 2];
    for (i, pixel) in image.pixels.iter().enumerate() {
        let light: f64 = pixel.iter().map(|&c| f64::from(c)).sum();
        let column = i as u32 % image.width;
        // A pixel that the wall's front covers in part belongs to neither.
        let [from, to] = [0, 1].map(|edge| at_opening(view, image, column + edge));
        if from > 0.5 * thickness {
            right += light;
        } else if to < -0.5 * thickness {
            left += light;
        }
    }
    if left > 0.0 { Ok(right / left) } else { Err("the bright room is black".to_owned()) }
}

/// Where a column's left edge meets the opening's plane z = 0. The camera looks along −z, so a column is one x.
fn at_opening(view: &View, image: &Image, column: u32) -> f64 {
    let half = (0.5 * view.fov_y).tan() * f64::from(image.width) / f64::from(image.height);
    let across = 2.0 * f64::from(column) / f64::from(image.width) - 1.0;
    view.position.x + view.position.z * half * across
}
