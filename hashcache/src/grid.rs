//! The hash grid's parameters from scene and settings, and its figures.

use backend_api::{Backend, Binding, Error as BackendError};
use hashcache_core::error::ParamError;
use hashcache_core::exact::Quantum;
use hashgrid::tag::{EMPTY, tag_distance};
use hashgrid::{GridStages, Params, Settings as GridSettings};
use pt_integrator::camera::CameraRays;
use pt_integrator::scene::Camera;

use crate::choice::{CacheKind, Choice};
use crate::pipeline::{self, Error};
use crate::settings::Settings;
use crate::stats::{CacheStats, EnergyBalance};

/// Smallest cell as a share of the scene's diagonal: finer than what f32 coordinates of the scene can tell apart.
const SMALLEST_CELL: f32 = 1.0 / (1 << 24) as f32;

/// L0 of the sums as a share of the largest emission. A vertex's illumination is a mean of radiance, so a sample by
/// multiple importance sampling hardly exceeds the largest emission times the number of bounces; the clamp, at 16 times
/// the largest emission, is above that, and the quantum, 2⁻²⁹ of it, also serves rooms that a small sun lights.
pub(crate) const L0_SHARE: f32 = 1.0 / 512.0;

/// Word of a cell that holds tag and count, and words of a cell.
const CELL_BYTES: usize = hashgrid::CELL_WORDS * 8;

/// The grid's parameters for a camera.
pub(crate) fn params(
    settings: &Settings,
    camera: &Camera,
    diagonal: f32,
    max_radiance: f32,
) -> Result<Params, ParamError> {
    Params::new(&GridSettings {
        cell_footprints: settings.grid_cell,
        base_size: (diagonal * SMALLEST_CELL).clamp(1e-9, 1e6),
        pixel_angle: CameraRays::new(camera).pixel_angle(),
        jitter: settings.grid_jitter,
        normal_bins: settings.grid_normal_bins,
        max_probes: settings.grid_max_probes,
        seed: settings.seed,
        quantum: Quantum::for_scale(max_radiance * L0_SHARE),
    })
}

/// The grid for a session that starts at a camera.
pub(crate) fn stages(
    settings: &Settings,
    camera: &Camera,
    diagonal: f32,
    max_radiance: f32,
) -> Result<GridStages, ParamError> {
    let params = params(settings, camera, diagonal, max_radiance)?;
    // One slot a pixel: cells hold many vertices, so the table stays nearly empty and probes short.
    let slots = settings
        .grid_slots
        .unwrap_or_else(|| camera.pixels().next_power_of_two().max(hashgrid::table::MIN_CELLS as u32));
    GridStages::new(params, slots)
}

/// The figures of a grid after all frames.
pub(crate) fn stats<B: Backend>(backend: &mut B, grid: &GridStages, settings: &Settings) -> Result<CacheStats, Error> {
    let ticket = grid.read_counters(backend)?;
    let counters = GridStages::counters(&backend.redeem(ticket, true)?.ok_or(BackendError::UnknownTicket)?);
    let table = grid.table().ok_or(BackendError::UnknownTicket)?;
    let bytes = pipeline::read(backend, Binding { buffer: table, offset: 0, size: grid.table_bytes() })?;
    let (mut cells, mut farthest) = (0_u64, 0);
    for cell in bytes.chunks_exact(CELL_BYTES) {
        let tag = u32::from_le_bytes([cell[4], cell[5], cell[6], cell[7]]);
        if tag != EMPTY {
            cells += 1;
            farthest = farthest.max(u64::from(tag_distance(tag)) + 1);
        }
    }
    let quantum = grid.params().quantum();
    let lost = counters.energy_refused.wrapping_add(counters.energy_clamped);
    let asked = counters.lookups + counters.deposits + counters.refusals;
    Ok(CacheStats {
        kind: CacheKind::Grid.name(),
        cells,
        bytes: grid.table_bytes(),
        bytes_per_cell: grid.table_bytes() as f64 / cells.max(1) as f64,
        levels: Vec::new(),
        lookups: counters.lookups,
        hits: counters.hits,
        fallbacks: counters.fallbacks,
        insert_failures: counters.refusals,
        mean_probes: counters.probes as f64 / asked.max(1) as f64,
        max_probes: farthest.min(u64::from(settings.grid_max_probes)),
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
