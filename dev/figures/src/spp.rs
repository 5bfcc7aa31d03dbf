//! Error against samples a pixel (as figure 11 of Roth et al. 2020).

use crate::arguments::Arguments;
use crate::run;
use crate::score::Score;
use crate::subject::{Subject, THREE};
use crate::table;

const SPP: [&str; 4] = ["1", "8", "64", "512"];

/// One picture at each number of samples, by the cache and by path tracing alone.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}\n", arguments.changed());
    table::head(&["scene", "by", "spp", "CPU-s"].into_iter().chain(Score::COLUMNS).collect::<Vec<_>>());
    for name in arguments.scenes(&THREE) {
        let subject = Subject::read(&name)?;
        for spp in SPP {
            let cache = arguments.settings(&[])?;
            // Whatever else the command line sets, the reference is plain path tracing.
            let mut plain = cache.clone();
            for (key, value) in [("cache", "none"), ("filter", "none")] {
                plain.set(key, value).map_err(|error| error.to_string())?;
            }
            for (by, mut settings) in [("cache", cache), ("path tracing", plain)] {
                settings.set("spp", spp).map_err(|error| error.to_string())?;
                let frames = run::at_rest(&subject.open(&settings)?, 1)?;
                let mut cells = vec![name.clone(), by.to_owned(), spp.to_owned(), table::seconds(frames.cpu_s)];
                cells.extend(Score::of(&frames.last.image, &subject.still.reference)?.cells());
                table::row(&cells);
            }
        }
    }
    Ok(())
}
