//! The figures of a render, in the stable form that others script against.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

use crate::accuracy::{CheckStats, StderrStats};
use crate::clock::Elapsed;
use crate::feature::Saving;
use crate::needs::Needs;
use crate::pipeline::Work;
use crate::plan::Stage;

/// Figures of one render. Its JSON keys are stable; more may stand beside them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stats {
    /// The scene as it was named.
    pub scene: String,
    /// The launcher that ran: `serial`, `rayon`.
    pub backend: String,
    /// Every setting in force, by its dotted name.
    pub settings: Map<String, Value>,
    /// What the scene needs.
    pub needs: Needs,
    /// The stages that ran, and why.
    pub plan: Vec<Stage>,
    /// What the scene does without, and what that saves.
    pub saved: Vec<Saving>,
    /// Wall seconds.
    pub time_s: Times,
    /// User and system seconds of all threads.
    pub cpu_s: Times,
    /// Rays cast.
    pub rays: Rays,
    /// The cache's figures; `None` without a cache.
    pub cache: Option<CacheStats>,
    /// Standard errors of the last frame's pixels; `None` where nothing tells them.
    pub stderr: Option<StderrStats>,
    /// What a check of some pixels tells of the last frame; `None` without `check.fraction`.
    pub check: Option<CheckStats>,
    /// The most memory the process held in bytes, where the system tells.
    pub peak_rss_bytes: Option<u64>,
    /// Paths traced for each pixel.
    pub samples_per_pixel: u32,
    /// Path contributions that were NaN or infinite and were left out.
    pub non_finite: u64,
    /// Frames rendered.
    pub frames: u32,
    /// What the scene file holds beyond what is modelled.
    pub warnings: Vec<String>,
}

/// Seconds by part.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Times {
    /// Reading files.
    pub load: f64,
    /// Building the acceleration structure and uploading.
    pub build: f64,
    /// Everything from the first path to the finished picture.
    pub render: f64,
    /// `render` by stage.
    pub stages: BTreeMap<&'static str, f64>,
}

/// Numbers of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rays {
    /// Closest-hit rays.
    pub closest: u64,
    /// Questions whether a light is visible.
    pub shadow_asked: u64,
    /// Those that were answered by tracing.
    pub shadow_traced: u64,
}

/// A cache's figures.
#[derive(Clone, Debug, Serialize)]
pub struct CacheStats {
    /// The cache's name, as `--cache` takes it.
    pub kind: &'static str,
    /// Cells in use.
    pub cells: u64,
    /// Memory of the table.
    pub bytes: u64,
    /// `bytes / cells`.
    pub bytes_per_cell: f64,
    /// Cells by level of detail.
    pub levels: Vec<LevelStats>,
    /// Questions asked.
    pub lookups: u64,
    /// Those that a cell answered.
    pub hits: u64,
    /// Those that were answered by the vertex's own value.
    pub fallbacks: u64,
    /// Samples that found no room.
    pub insert_failures: u64,
    /// Slots looked at for one question, on average.
    pub mean_probes: f64,
    /// The most slots that one cell's key lies from its first slot, plus one.
    pub max_probes: u64,
    /// Samples above the largest value a sum takes; they were lowered to it.
    pub clamped: u64,
    /// Samples below half a quantum; they count as 0.
    pub underflowed: u64,
    /// Samples that were NaN, infinite or negative; they count as 0.
    pub non_finite: u64,
    /// Light recorded, stored and lost, which balance: recorded = stored + lost.
    pub energy: EnergyBalance,
}

/// Cells of one level.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LevelStats {
    /// Cells along one side of the scene's extent.
    pub resolution: u64,
    /// Cells in use.
    pub cells: u64,
    /// `cells / resolution³`.
    pub density: f64,
    /// Bytes of their data.
    pub data_bytes: u64,
    /// Bytes of their keys.
    pub hash_bytes: u64,
}

/// Sums over all samples and channels, in units of radiance.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct EnergyBalance {
    /// Given to the cache.
    pub recorded: f64,
    /// In its cells.
    pub stored: f64,
    /// Not in its cells: refused, clamped away, below a quantum.
    pub lost: f64,
}

impl Stats {
    /// Adds a frame to the sums.
    pub(crate) fn add_frame(&mut self, elapsed: Elapsed, work: &Work) {
        self.time_s.render += elapsed.wall_s;
        self.cpu_s.render += elapsed.cpu_s;
        for (stage, elapsed) in &work.stages {
            *self.time_s.stages.entry(stage).or_default() += elapsed.wall_s;
            *self.cpu_s.stages.entry(stage).or_default() += elapsed.cpu_s;
        }
        self.rays.closest += work.rays.closest;
        self.rays.shadow_asked += work.rays.shadow_asked;
        self.rays.shadow_traced += work.rays.shadow_traced;
        self.non_finite += work.non_finite;
        self.samples_per_pixel += work.samples;
        self.frames += 1;
    }
}
