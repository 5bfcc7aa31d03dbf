//! `hashcache render`: one image.

use hashcache::Preview;

use crate::args::Render;
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::progress::Display;

/// Renders and writes all files.
pub fn run(args: &Render) -> Result<(), Failure> {
    let settings = args.settings.settings()?;
    let outputs = Outputs::check(&args.scene, &args.outputs, args.stats.as_deref())?;
    let preview = Preview::open(&args.scene, &settings)?;
    if !preview.needs().has_light() {
        return Err(Failure::other(format!(
            "{}: holds no light, the image would be black; give an emissive material to a mesh or an environment by --env FILE.hdr",
            args.scene
        )));
    }
    let mut display = Display::new(args.quiet);
    for warning in preview.warnings() {
        display.line(&format!("warning: {warning}"));
    }
    let rendered =
        preview.render(&mut |progress| display.report(progress.stage, progress.done.into(), progress.total.into()));
    display.finish();
    let rendered = rendered?;
    let mut stats = serde_json::to_vec_pretty(&rendered.stats).map_err(|error| Failure::other(error.to_string()))?;
    stats.push(b'\n');
    outputs.write(&rendered.image, &stats)?;
    let (image, seconds) = (&rendered.image, rendered.stats.time_s.render);
    display.line(&format!("{}: {}x{}, rendered in {seconds:.2} s", outputs.names(), image.width, image.height));
    Ok(())
}
