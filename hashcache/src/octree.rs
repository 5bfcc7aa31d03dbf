//! The octree's structure and parameters from scene and settings, and its figures.

use std::num::NonZero;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use backend_api::{Backend, Error as BackendError};
use hashcache_core::error::ParamError;
use hashcache_core::exact::Quantum;
use hashcache_core::octree::{
    BuildError, BuildSettings, Layout, Light, OctreeParams, OctreeSettings, OctreeStages, OwnedOctree, Triangles,
    Workers, build, build_within, resolution_for_footprint,
};

use crate::choice::{CacheKind, Choice, DirectLight, Launcher, OctreeLayout};
use crate::grid::L0_SHARE;
use crate::pipeline::Error;
use crate::preview::Preview;
use crate::settings::Settings;
use crate::stats::{CacheStats, EnergyBalance, LevelStats};

/// Most bytes of an octree whose resolution is asked for by number.
const MOST_BYTES: u64 = 16 << 30;

/// The structure: of the resolution asked for, or of the one whose finest cells are what the median pixel asks for.
pub(crate) fn structure(preview: &Preview, median_footprint: f32) -> Result<OwnedOctree, BuildError> {
    let settings = preview.settings();
    let geometry = preview.geometry();
    let workers = Threads::of(settings);
    let cell_bytes = layout(settings).cell_bytes();
    if let Some(resolution) = settings.octree_resolution {
        return build(&geometry, &BuildSettings { resolution, cell_bytes, max_bytes: MOST_BYTES }, &workers);
    }
    let triangles = Triangles::new(&geometry)?;
    let resolution = resolution_for_footprint(&triangles, median_footprint * settings.octree_cell)?;
    let max_bytes = u64::from(settings.octree_memory) << 20;
    build_within(&geometry, &BuildSettings { resolution, cell_bytes, max_bytes }, &workers)
}

/// The layout of the cells.
pub(crate) fn layout(settings: &Settings) -> Layout {
    match settings.octree_layout {
        OctreeLayout::Exact => Layout::Exact,
        OctreeLayout::Paper => Layout::Paper,
    }
}

/// What cells hold and how they are asked.
pub(crate) fn params(settings: &Settings, max_radiance: f32) -> Result<OctreeParams, ParamError> {
    OctreeParams::new(&OctreeSettings {
        light: match settings.direct {
            DirectLight::Cached => Light::All,
            DirectLight::Traced => Light::Further,
        },
        cell: settings.octree_cell,
        jitter: settings.octree_jitter,
        min_samples: settings.octree_min_samples,
        max_climb: settings.octree_max_climb,
        shrinkage: settings.octree_shrinkage,
        seed: settings.seed,
        quantum: Quantum::for_scale(max_radiance * L0_SHARE),
        ..OctreeSettings::default()
    })
}

/// Threads for a build: items are taken in small runs by whoever is free.
struct Threads(usize);

/// Runs of items that a build is cut into, for each thread: enough that none waits long for the last.
const RUNS_PER_THREAD: u32 = 16;

impl Threads {
    fn of(settings: &Settings) -> Self {
        Self(match (settings.launcher, settings.threads) {
            (Launcher::Serial, _) => 1,
            (Launcher::Rayon, 0) => thread::available_parallelism().map_or(1, NonZero::get),
            (Launcher::Rayon, threads) => threads as usize,
        })
    }
}

impl Workers for Threads {
    fn run(&self, items: u32, body: &(dyn Fn(Range<u32>) + Sync)) {
        if self.0 <= 1 {
            return body(0..items);
        }
        let run = (items / (self.0 as u32 * RUNS_PER_THREAD)).max(1);
        let next = AtomicU32::new(0);
        thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(|| {
                    loop {
                        let taken = next.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |first| {
                            (first < items).then(|| first.saturating_add(run))
                        });
                        let Ok(first) = taken else { return };
                        body(first..first.saturating_add(run).min(items));
                    }
                });
            }
        });
    }
}

/// The figures of an octree after all frames.
pub(crate) fn stats<B: Backend>(backend: &mut B, cache: &OctreeStages) -> Result<CacheStats, Error> {
    let ticket = cache.read_counters(backend)?;
    let counters = OctreeStages::counters(&backend.redeem(ticket, true)?.ok_or(BackendError::UnknownTicket)?);
    let octree = cache.octree().view();
    let cell_bytes = cache.layout().cell_bytes();
    let levels: Vec<LevelStats> = (0..octree.grid().levels)
        .map(|level| {
            let statistics = octree.statistics(level, cell_bytes);
            // The root cube has twice the edge of the scene's box.
            let resolution = u64::from(statistics.side / 2).max(1);
            LevelStats {
                resolution,
                cells: statistics.cells.into(),
                density: f64::from(statistics.cells) / (resolution as f64).powi(3),
                data_bytes: statistics.data_bytes,
                hash_bytes: statistics.table_bytes,
            }
        })
        .collect();
    let bytes = cache.data_bytes() + cache.table_bytes();
    let cells = u64::from(cache.cells());
    let quantum = cache.params().quantum();
    let lost = counters.energy_refused.wrapping_add(counters.energy_clamped);
    Ok(CacheStats {
        kind: CacheKind::Octree.name(),
        cells,
        bytes,
        bytes_per_cell: bytes as f64 / cells.max(1) as f64,
        levels,
        lookups: counters.lookups,
        hits: counters.hits,
        fallbacks: counters.fallbacks,
        insert_failures: counters.refusals,
        mean_probes: counters.probes as f64 / (counters.lookups + counters.deposits).max(1) as f64,
        // A key has two buckets.
        max_probes: 2,
        clamped: counters.clamped,
        underflowed: counters.underflowed,
        non_finite: counters.non_finite + counters.negative,
        energy: EnergyBalance {
            recorded: quantum.energy(counters.energy_recorded) + quantum.underflow_energy(counters.energy_underflowed),
            stored: quantum.energy(counters.energy_stored),
            lost: quantum.energy(lost) + quantum.underflow_energy(counters.energy_underflowed),
        },
    })
}
