//! The stages of a frame, each with the reason why it is there.

use std::fmt;

use serde::Serialize;

use crate::choice::{CacheKind, Choice, DirectLight};
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
        match settings.cache {
            CacheKind::None => {
                push(
                    "trace",
                    format!("whole paths of up to {bounces} scatterings into the film, no cache: {surfaces}; {lights}"),
                );
            }
            CacheKind::Grid => {
                push(
                    "trace",
                    format!(
                        "paths of up to {bounces} scatterings, their first vertex recorded for the grid: {surfaces}; {lights}"
                    ),
                );
                push("update", "the vertices' cells are claimed and their light is added to them".to_owned());
                push("query", "each vertex reads its cell's mean in place of its own light".to_owned());
                push(
                    "compose",
                    match settings.direct {
                        DirectLight::Cached => "film = emission + albedo · light of the cell".to_owned(),
                        DirectLight::Traced => {
                            "film = emission + albedo · (own direct light + further light of the cell)".to_owned()
                        }
                    },
                );
            }
        }
        push("resolve", "the film's sums become radiance".to_owned());
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
