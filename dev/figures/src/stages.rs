//! Time by stage (as figures 17 and 18 of Roth et al. 2020).

use std::collections::BTreeSet;

use hashcache::FrameOutput;

use crate::arguments::Arguments;
use crate::run;
use crate::subject::{ALL, Subject};
use crate::table;

/// CPU-seconds by stage of the first frame at the reference's camera, and of the move's last frame.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}; CPU-seconds\n", arguments.changed());
    let mut rows = Vec::new();
    for name in arguments.scenes(&ALL) {
        let subject = Subject::read(&name)?;
        let preview = subject.open(&arguments.settings(&[])?)?;
        let last = subject.path.frames() - 1;
        for (frame, first) in [("first", last), ("last of the move", 0)] {
            let frames = run::along(&preview, &subject.path, first)?;
            rows.push((name.clone(), frame, frames.stats.cpu_s.build, frames.last));
        }
    }
    let stages: BTreeSet<&str> = rows.iter().flat_map(|(.., frame)| frame.stages.keys().copied()).collect();
    let columns = ["scene", "frame", "build", "frame's sum"];
    table::head(&columns.into_iter().chain(stages.iter().copied()).collect::<Vec<_>>());
    for (name, which, build, frame) in rows {
        let mut cells = vec![name, which.to_owned(), table::seconds(build), table::seconds(frame.elapsed.cpu_s)];
        cells.extend(stages.iter().map(|stage| stage_time(&frame, stage)));
        table::row(&cells);
    }
    Ok(())
}

fn stage_time(frame: &FrameOutput, stage: &str) -> String {
    frame.stages.get(stage).map_or("–".to_owned(), |elapsed| table::seconds(elapsed.cpu_s))
}
