//! `hashcache render`: one image.

use std::sync::{Mutex, PoisonError};

use hashcache::scene::View;
use hashcache::{Preview, Settings};

use crate::args::Render;
use crate::failure::Failure;
use crate::outputs::{Outputs, stats_bytes};
use crate::progress::Display;

/// Renders and writes all files.
pub fn run(args: &Render) -> Result<(), Failure> {
    let settings = args.settings.settings()?;
    if args.aov.is_some() && !settings.has_aovs() {
        return Err(Failure::usage(
            "--aov does not go with cache=none and filter=none, which keep nothing but radiance; use a cache or a filter, path.moments=on or check.fraction",
        ));
    }
    let outputs = Outputs::check(&args.scene, &args.outputs, args.stats.as_deref(), args.aov.as_deref(), &settings)?;
    let mut display = Display::new(args.quiet);
    let preview = open(&mut display, &args.scene, &settings, None)?;
    for warning in preview.warnings() {
        display.line(&format!("warning: {warning}"));
    }
    display.report("build", 0, settings.spp.into());
    let mut backend = preview.backend()?;
    let mut session = preview.session(&mut backend)?;
    let frame = session.frame(preview.camera(), &mut |progress| {
        display.report(progress.stage, progress.done.into(), progress.total.into());
    });
    display.finish();
    let image = frame?.image;
    let aovs = if outputs.want_aovs() { session.aovs()? } else { Vec::new() };
    let stats = session.stats()?;
    outputs.write(&image, &stats_bytes(&stats)?, &aovs)?;
    let seconds = stats.time_s.render;
    display.line(&format!("{}: {}x{}, rendered in {seconds:.2} s", outputs.names(), image.width, image.height));
    Ok(())
}

/// Loads a scene, showing how far that is, and checks that something lights it; from a camera of the caller's if there
/// is one.
pub fn open(display: &mut Display, scene: &str, settings: &Settings, view: Option<&View>) -> Result<Preview, Failure> {
    let shown = Mutex::new(&mut *display);
    let opened = Preview::open_with_progress(scene, settings, view, &|progress| {
        let mut display = shown.lock().unwrap_or_else(PoisonError::into_inner);
        display.report(progress.what, progress.done, progress.total);
    });
    let lit = opened.map_err(Failure::from).and_then(|preview| lit(preview, scene));
    if lit.is_err() {
        display.finish();
    }
    lit
}

/// A scene that something lights.
fn lit(preview: Preview, scene: &str) -> Result<Preview, Failure> {
    if preview.needs().has_light() {
        return Ok(preview);
    }
    Err(Failure::other(format!(
        "{scene}: holds no light, the image would be black; give an emissive material to a mesh or an environment by --env FILE.hdr"
    )))
}
