//! The stages of a frame, each with the reason why it is there.

use std::fmt;

use serde::Serialize;

use crate::choice::{CacheKind, Choice, DirectLight, FilterKind};
use crate::needs::Needs;
use crate::settings::Settings;

/// One stage of a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Stage {
    /// Its name, the key of its time in the statistics.
    pub stage: &'static str,
    /// Why the frame has it.
    pub why: String,
}

/// What a frame does, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePlan {
    /// The stages of one frame.
    pub stages: Vec<Stage>,
    /// What the scene needs.
    pub needs: Needs,
    /// Whether vertices are recorded for a cache.
    pub cache: CacheKind,
    /// Where direct light comes from.
    pub direct: DirectLight,
}

impl FramePlan {
    /// The plan for a scene under these settings.
    pub fn new(needs: Needs, settings: &Settings) -> Self {
        let mut stages = Vec::new();
        let mut push = |stage, why: String| stages.push(Stage { stage, why });
        let lights = match (needs.emissive_triangles, needs.environment) {
            (0, "none") => "nothing gives light, so rays show a black scene".to_owned(),
            (0, environment) => format!("lit by a {environment} environment"),
            (triangles, "none") => format!("lit by {triangles} emissive triangles"),
            (triangles, environment) => {
                format!("lit by {triangles} emissive triangles and a {environment} environment")
            }
        };
        let surfaces = format!(
            "{} triangles in {}, Lambert{}",
            needs.triangles,
            if needs.instances > 1 { format!("{} instances", needs.instances) } else { "one mesh".to_owned() },
            if needs.textures { ", textured" } else { ", no texture code" },
        );
        let bounces = settings.max_bounces;
        if settings.cache == CacheKind::None && settings.filter == FilterKind::None {
            push(
                "trace",
                format!("whole paths of up to {bounces} scatterings into the film, no cache: {surfaces}; {lights}"),
            );
            push("resolve", "the film's sums become radiance".to_owned());
            return Self { stages, needs, cache: settings.cache, direct: settings.direct };
        }
        let kept = match (settings.cache, settings.store) {
            (CacheKind::None, _) => "their first vertex kept for the filter".to_owned(),
            (cache, 1) => format!("their first vertex recorded for the {}", cache.name()),
            (cache, store) => format!("their first {store} vertices recorded for the {}", cache.name()),
        };
        push("trace", format!("paths of up to {bounces} scatterings, {kept}: {surfaces}; {lights}"));
        match settings.cache {
            CacheKind::None => {}
            CacheKind::Octree => {
                push(
                    "update",
                    "the vertices' light becomes part of their cells' means, and of all coarser ones".to_owned(),
                );
            }
            CacheKind::Grid => {
                push("update", "the vertices' cells are claimed and their light is added to them".to_owned());
            }
        }
        if settings.cache != CacheKind::None {
            let direct = match settings.direct {
                DirectLight::Cached => String::new(),
                DirectLight::Traced => format!(", each with {} shadow rays for direct light", settings.direct_samples),
            };
            let least = settings.reconstruct_samples;
            push("reconstruct", format!("at least {least} samples a pixel show what it sees, for clean edges{direct}"));
            push("query", "each sample reads its cell's mean in place of its own light".to_owned());
        }
        push("gather", "samples become sums of light, albedo and guides a pixel".to_owned());
        let denoiser = settings.denoiser.name();
        push(
            "filter",
            match settings.filter {
                FilterKind::None => {
                    "no filter: sums become radiance, pixels without light take their neighbours'".to_owned()
                }
                FilterKind::Layered => format!(
                    "{denoiser}, passes: {}, over the light without albedo, in one layer: all surfaces are Lambertian",
                    settings.filter_passes
                ),
                FilterKind::Screen => format!(
                    "{denoiser}, passes: {}, over the light without albedo, by the surfaces seen",
                    settings.filter_passes
                ),
            },
        );
        Self { stages, needs, cache: settings.cache, direct: settings.direct }
    }
}

impl fmt::Display for FramePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cache {}", self.cache.name())?;
        for (index, stage) in self.stages.iter().enumerate() {
            writeln!(f, "{}. {:<8} {}", index + 1, stage.stage, stage.why)?;
        }
        Ok(())
    }
}
