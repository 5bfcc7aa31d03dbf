//! Error against the octree's resolution (as figure 13 of Roth et al. 2020).

use crate::arguments::Arguments;
use crate::run;
use crate::score::Score;
use crate::subject::{Subject, THREE};
use crate::table;

const RESOLUTIONS: [&str; 4] = ["256", "512", "1024", "2048"];

/// Frames at rest: with few the noise of small cells hides what they resolve.
const FRAMES: u32 = 32;

/// First and last of [`FRAMES`] frames at rest, for each resolution. A cell of one footprint is asked for, so that the
/// finest level is used wherever it exists.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}; octree.cell=1 so that the finest level is asked\n", arguments.changed());
    let columns = ["scene", "resolution", "cells", "MiB", "build CPU-s", "frames", "CPU-s a frame"];
    table::head(&columns.into_iter().chain(Score::COLUMNS).collect::<Vec<_>>());
    for name in arguments.scenes(&THREE) {
        let subject = Subject::read(&name)?;
        for resolution in RESOLUTIONS {
            let of_verb = [("cache", "octree"), ("octree.cell", "1"), ("octree.resolution", resolution)];
            let preview = subject.open(&arguments.settings(&of_verb)?)?;
            for count in [1, FRAMES] {
                let frames = run::at_rest(&preview, count)?;
                let cache = frames.stats.cache.as_ref().ok_or("the settings name no cache")?;
                let mut cells = vec![
                    name.clone(),
                    resolution.to_owned(),
                    cache.cells.to_string(),
                    format!("{:.1}", cache.bytes as f64 / f64::from(1 << 20)),
                    table::seconds(frames.stats.cpu_s.build),
                    count.to_string(),
                    table::seconds(frames.cpu_s / f64::from(count)),
                ];
                cells.extend(Score::of(&frames.last.image, &subject.still.reference)?.cells());
                table::row(&cells);
            }
        }
    }
    Ok(())
}
