//! `hashcache fly`: a camera move, frame by frame, with what each frame takes and how it differs from its reference.

mod frames;
mod references;

use hashcache::Preview;
use hashcache::scene::CameraPath;
use serde_json::Value;

use crate::args::{Fly, FrameFormat};
use crate::failure::Failure;
use crate::folder::Folder;
use crate::outputs;
use crate::progress::Display;
use crate::render::open;
use crate::table::Table;
use frames::{Frame, Previous};
use references::References;

const METRICS: &str = "metrics.csv";
const SUMMARY: &str = "summary.json";

/// Renders and writes all files.
pub fn run(args: &Fly) -> Result<(), Failure> {
    let settings = args.settings.settings()?;
    if settings.camera.is_some() {
        return Err(Failure::usage("--camera does not go with --path; the path holds the cameras"));
    }
    let tone = settings.tone_mapping();
    if args.format != FrameFormat::Png {
        outputs::refuse_tone(tone, &format!("--format {}", args.format.ending()), "use --format png")?;
    }
    let folder = Folder::check(&args.output)?;
    let path = CameraPath::from_file(&args.path).map_err(hashcache::Error::from)?;
    let names: Vec<_> = (0..path.frames()).map(|index| frame_name(index, args.format.ending())).collect();
    refuse_other_frames(&folder, &names)?;
    let references = args.references.as_deref().map(|folder| References::find(folder, path.frames())).transpose()?;
    let mut display = Display::new(args.quiet);
    let start = path.frame(0).map(|(view, _)| view);
    let preview = open(&mut display, &args.scene, &settings, start.as_ref())?;
    if let Some(references) = &references {
        references.check(preview.size())?;
    }
    let stops = (0..path.frames()).map_while(|index| path.frame(index));
    let stops = stops.map(|(view, light)| Ok((preview.camera_at(&view)?, view, light)));
    let stops = stops.collect::<Result<Vec<_>, hashcache::Error>>()?;

    for warning in preview.warnings() {
        display.line(&format!("warning: {warning}"));
    }
    let mut backend = preview.backend()?;
    let mut session = preview.session(&mut backend)?;
    let mut previous = None;
    let mut table = None;
    let mut frames = Vec::new();
    for (index, ((camera, view, light), name)) in stops.iter().zip(&names).enumerate() {
        session.scale_light(*light)?;
        let output = session.frame(camera, &mut |progress| {
            let (done, total) = (u64::from(progress.done), u64::from(progress.total));
            display.report("fly", index as u64 * total + done, stops.len() as u64 * total);
        })?;
        let reference = references.as_ref().map(|all| all.read(index)).transpose()?.flatten();
        let now = Previous { image: output.image, reference, view: view.clone(), light: *light };
        let frame = Frame::measure(index, output.elapsed, &now, previous.as_ref())
            .map_err(|error| Failure::other(format!("frame {index}: {error}")))?;
        let table = if let Some(table) = &mut table {
            table
        } else {
            // What an earlier move left says nothing about this one.
            folder.remove(SUMMARY)?;
            table.insert(Table::create(&folder, METRICS, [Frame::columns().as_slice()])?)
        };
        folder.write_image(name, &now.image, tone)?;
        table.add(&frame.cells())?;
        frames.push(frame);
        previous = Some(now);
    }
    display.finish();
    let stats = session.stats()?;
    let seconds = stats.time_s.render;
    let mut summary = serde_json::to_value(&stats).map_err(|error| Failure::other(error.to_string()))?;
    summary["frames"] = serde_json::to_value(&frames).map_err(|error| Failure::other(error.to_string()))?;
    summary["path"] = Value::from(args.path.display().to_string());
    folder.write_bytes(SUMMARY, format!("{summary:#}\n").as_bytes())?;
    display.line(&told(args, &preview, &frames, seconds));
    Ok(())
}

/// One line about the move.
fn told(args: &Fly, preview: &Preview, frames: &[Frame], seconds: f64) -> String {
    let (width, height) = preview.size();
    let mean = |name: &str, values: Vec<f64>| match values.len() {
        0 => String::new(),
        count => format!(", mean {name} {:.5}", values.iter().sum::<f64>() / count as f64),
    };
    let relmse = mean("relMSE", frames.iter().filter_map(Frame::relmse).collect());
    let flicker = mean("flicker", frames.iter().filter_map(Frame::flicker).collect());
    let (folder, count) = (args.output.display(), frames.len());
    format!("{folder}: {count} frames of {width}x{height}, rendered in {seconds:.2} s{relmse}{flicker}")
}

fn frame_name(index: u32, ending: &str) -> String {
    format!("frame_{index:04}.{ending}")
}

/// Files of this move are replaced; others would make two moves look like one.
fn refuse_other_frames(folder: &Folder, names: &[String]) -> Result<(), Failure> {
    let found = folder.names()?.into_iter().filter_map(|name| name.into_string().ok());
    let mut others = found.filter(|name| name.starts_with("frame_") && !names.contains(name));
    match others.next() {
        None => Ok(()),
        Some(other) => {
            let file = folder.path().join(other);
            let line = format!("{}: of another move; remove it or name another folder", file.display());
            Err(Failure::other(line))
        }
    }
}
