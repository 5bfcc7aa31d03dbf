//! A frame beside what a user would pick instead at the same cost.

use crate::arguments::Arguments;
use crate::peer::{self, PeerRow};
use crate::run::{self, Frames};
use crate::score::Score;
use crate::subject::{ALL, Subject};
use crate::table;

/// For each scene the first frame at the reference's camera, in a new session, and the last frame of the move that ends
/// there. The peer's errors are those at the frame's own CPU-seconds, without building.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    let peers = peer::read(arguments.peer.as_deref())?;
    println!(
        "{}; ratio: ours over the peer's at equal CPU-seconds (its cheapest setting where that is dearer)\n",
        arguments.changed()
    );
    let ours = ["scene", "frame", "build CPU-s", "CPU-s"].into_iter().chain(Score::COLUMNS);
    let theirs = ["peer CPU-s", "peer relMSE", "peer trimmed", "peer FLIP", "ratio", "trimmed ratio", "FLIP ratio"];
    table::head(&ours.chain(theirs).collect::<Vec<_>>());
    for name in arguments.scenes(&ALL) {
        let subject = Subject::read(&name)?;
        let preview = subject.open(&arguments.settings(&[])?)?;
        let last = subject.path.frames() - 1;
        print(&subject, "first", &run::along(&preview, &subject.path, last)?, &peers)?;
        print(&subject, &format!("{}th of the move", last + 1), &run::along(&preview, &subject.path, 0)?, &peers)?;
    }
    Ok(())
}

fn print(subject: &Subject, frame: &str, frames: &Frames, peers: &[PeerRow]) -> Result<(), String> {
    let score = Score::of(&frames.last.image, &subject.still.reference)?;
    let cpu_s = frames.last.elapsed.cpu_s;
    let build = frames.stats.cpu_s.build;
    let mut cells = vec![subject.still.name.clone(), frame.to_owned(), table::seconds(build), table::seconds(cpu_s)];
    cells.extend(score.cells());
    if let Some(peer) = peer::at(peers, &subject.still.name, cpu_s) {
        cells.extend([
            table::seconds(peer.cpu_s),
            table::error(peer.relmse),
            table::error(peer.trimmed),
            format!("{:.3}", peer.flip),
            table::ratio(score.relmse / peer.relmse),
            table::ratio(score.trimmed / peer.trimmed),
            table::ratio(score.flip / peer.flip),
        ]);
    }
    table::row(&cells);
    Ok(())
}
