//! The stages of a frame, each with the reason why it is there.

mod reasons;
mod saving;

use std::fmt;

use serde::Serialize;

use crate::choice::{CacheKind, Choice as _, DirectLight};
use crate::feature::Saving;
use crate::needs::Needs;
use crate::settings::Settings;

use reasons::Reasons;

/// One stage of a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Stage {
    /// Its name, the key of its time in the statistics.
    pub stage: &'static str,
    /// Why the frame has it.
    pub why: String,
}

/// What a frame does, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// The stages of one frame.
    pub stages: Vec<Stage>,
    /// What the scene needs.
    pub needs: Needs,
    /// Whether vertices are recorded for a cache.
    pub cache: CacheKind,
    /// Where direct light comes from.
    pub direct: DirectLight,
    /// Vertices one behind another that a sample of a pixel keeps.
    pub layers: u32,
    /// Whether the first vertices of a frame's last paths are also samples of the picture.
    pub reuses_paths: bool,
    /// What the scene or the settings do without and the frame leaves out.
    pub saved: Vec<Saving>,
}

impl FramePlan {
    /// The plan for a scene under these settings, for pictures of so many pixels.
    pub fn new(needs: Needs, settings: &Settings, pixels: u32) -> Self {
        let layers = layers(&needs, settings);
        let why = Reasons { needs: &needs, settings, layers };
        let mut stages = Vec::new();
        let mut push = |stage, why: String| stages.push(Stage { stage, why });
        let cache = settings.cache;
        if settings.is_plain() {
            push("trace", why.film());
            push("resolve", "the film's sums become radiance".to_owned());
        } else {
            push("trace", why.trace());
            match cache {
                CacheKind::None => {}
                CacheKind::Octree => {
                    let means = "the vertices' light becomes part of their cells' means, and of all coarser ones";
                    push("update", means.to_owned());
                }
                CacheKind::Grid => {
                    push("update", why.grid_update());
                }
            }
            if cache != CacheKind::None {
                push("reconstruct", why.reconstruct());
                let query = "each vertex that scatters diffusely reads its cell's mean in place of its own light";
                push("query", query.to_owned());
            }
            push("gather", why.gather());
            push("filter", why.filter());
        }
        if settings.check_fraction > 0.0 {
            push("check", why.check(pixels));
        }
        let saved = saving::without(&needs, settings, pixels);
        // One path a pixel, and what it keeps is what a look at the pixel would keep.
        let reuses_paths = settings.crf.to_bits() == 1.0_f32.to_bits() && !needs.is_glossy();
        Self { stages, needs, cache, direct: settings.direct, layers, reuses_paths, saved }
    }
}

/// Vertices one behind another that are kept of a sample. Without a cache a path keeps one.
fn layers(needs: &Needs, settings: &Settings) -> u32 {
    if settings.cache == CacheKind::None {
        1
    } else if settings.needs_force.has_layers() {
        settings.filter_layers
    } else {
        needs.layers.min(settings.filter_layers)
    }
}

impl fmt::Display for FramePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cache {}", self.cache.name())?;
        for (index, stage) in self.stages.iter().enumerate() {
            writeln!(f, "{}. {:<8} {}", index + 1, stage.stage, stage.why)?;
        }
        for (need, why) in reasons::needs(&self.needs) {
            writeln!(f, "needs {need}: {why}")?;
        }
        self.saved.iter().try_for_each(|saving| writeln!(f, "{saving}"))
    }
}
