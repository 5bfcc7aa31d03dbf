//! Frames of a move.

use hashcache::scene::CameraPath;
use hashcache::{FrameOutput, Image, Preview, Stats};

/// What came of some frames.
pub struct Frames {
    /// The last frame.
    pub last: FrameOutput,
    /// CPU-seconds of all frames, and of those before the last.
    pub cpu_s: f64,
    /// The figures of all frames.
    pub stats: Stats,
}

/// Renders the frames `first` to the path's last one in one session.
pub fn along(preview: &Preview, path: &CameraPath, first: u32) -> Result<Frames, String> {
    let views = (first..path.frames()).filter_map(|i| path.frame(i));
    session(preview, views.map(|(view, light)| (Some(view), light)))
}

/// Renders `count` frames from the camera that the settings name.
pub fn at_rest(preview: &Preview, count: u32) -> Result<Frames, String> {
    session(preview, (0..count).map(|_| (None, 1.0)))
}

/// All pictures from the camera that the settings name, with the light scaled by each factor for so many frames.
pub fn lit(preview: &Preview, lights: &[(f32, u32)]) -> Result<Vec<Image>, String> {
    let say = |error: hashcache::Error| error.to_string();
    let mut backend = preview.backend().map_err(say)?;
    let mut session = preview.session(&mut backend).map_err(say)?;
    let mut images = Vec::new();
    for &(factor, frames) in lights {
        session.scale_light(factor).map_err(say)?;
        for _ in 0..frames {
            images.push(session.frame(preview.camera(), &mut |_| ()).map_err(say)?.image);
        }
    }
    Ok(images)
}

fn session(
    preview: &Preview,
    views: impl Iterator<Item = (Option<hashcache::scene::View>, f32)>,
) -> Result<Frames, String> {
    let say = |error: hashcache::Error| error.to_string();
    let mut backend = preview.backend().map_err(say)?;
    let mut session = preview.session(&mut backend).map_err(say)?;
    let (mut last, mut cpu_s) = (None, 0.0);
    for (view, light) in views {
        let camera = match view {
            Some(view) => preview.camera_at(&view).map_err(say)?,
            None => *preview.camera(),
        };
        session.scale_light(light).map_err(say)?;
        let frame = session.frame(&camera, &mut |_| ()).map_err(say)?;
        cpu_s += frame.elapsed.cpu_s;
        last = Some(frame);
    }
    let stats = session.stats().map_err(say)?;
    Ok(Frames { last: last.ok_or("there is no frame to render")?, cpu_s, stats })
}
