//! `hashcache render`: one image.

use hashcache::Preview;
use hashcache::choice::{CacheKind, FilterKind};

use crate::args::Render;
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::progress::Display;

/// Renders and writes all files.
pub fn run(args: &Render) -> Result<(), Failure> {
    let settings = args.settings.settings()?;
    if args.aov.is_some() && settings.cache == CacheKind::None && settings.filter == FilterKind::None {
        return Err(Failure::usage(
            "--aov does not go with cache=none and filter=none, which keep nothing but radiance; use a cache or a filter",
        ));
    }
    let outputs = Outputs::check(&args.scene, &args.outputs, args.stats.as_deref(), args.aov.as_deref())?;
    let preview = lit(Preview::open(&args.scene, &settings)?, &args.scene)?;
    let mut display = Display::new(args.quiet);
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
    let mut text = serde_json::to_vec_pretty(&stats).map_err(|error| Failure::other(error.to_string()))?;
    text.push(b'\n');
    outputs.write(&image, &text, &aovs)?;
    let seconds = stats.time_s.render;
    display.line(&format!("{}: {}x{}, rendered in {seconds:.2} s", outputs.names(), image.width, image.height));
    Ok(())
}

/// A scene that something lights.
pub fn lit(preview: Preview, scene: &str) -> Result<Preview, Failure> {
    if preview.needs().has_light() {
        return Ok(preview);
    }
    Err(Failure::other(format!(
        "{scene}: holds no light, the image would be black; give an emissive material to a mesh or an environment by --env FILE.hdr"
    )))
}
