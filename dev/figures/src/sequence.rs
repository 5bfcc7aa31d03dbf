//! Error against the frames that came before (as figure 14 of Roth et al. 2020).

use crate::arguments::Arguments;
use crate::run;
use crate::score::Score;
use crate::subject::{ALL, Subject};
use crate::table;

/// Frames of the move before and with the one that is judged.
const HISTORIES: [u32; 6] = [1, 2, 4, 8, 16, 30];

/// The move's last frame when only its last 1, 2, … frames are rendered, and as many frames at rest at its end.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}\n", arguments.changed());
    table::head(&["scene", "camera", "frames", "CPU-s a frame"].into_iter().chain(Score::COLUMNS).collect::<Vec<_>>());
    for name in arguments.scenes(&ALL) {
        let subject = Subject::read(&name)?;
        let preview = subject.open(&arguments.settings(&[])?)?;
        for count in HISTORIES.into_iter().filter(|&count| count <= subject.path.frames()) {
            let moving = run::along(&preview, &subject.path, subject.path.frames() - count)?;
            let resting = run::at_rest(&preview, count)?;
            for (camera, frames) in [("moves", moving), ("rests", resting)] {
                let cpu_s = frames.cpu_s / f64::from(count);
                let mut cells = vec![name.clone(), camera.to_owned(), count.to_string(), table::seconds(cpu_s)];
                cells.extend(Score::of(&frames.last.image, &subject.still.reference)?.cells());
                table::row(&cells);
            }
        }
    }
    Ok(())
}
