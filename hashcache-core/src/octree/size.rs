//! What an octree weighs: counted, predicted, and by level.

use super::error::BuildError;
use super::grid::{Grid, MIN_RESOLUTION};
use super::partition::{Partition, Workers};
use super::table::BUCKET_WORDS;
use super::triangles::Triangles;
use super::view::Octree;

/// Bytes of a cell's normal.
pub const NORMAL_BYTES: u32 = 4;

/// Resolution at which cells are counted to predict finer ones: takes a tenth of a second for a million triangles, and
/// most of what a scene is made of is larger than its cells.
const PROBE: u32 = 256;

/// What a level holds and weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelStatistics {
    /// The level.
    pub level: u32,
    /// Cells along an edge of the root cube; along the scene's largest side it is half as many.
    pub side: u32,
    /// Stored cells.
    pub cells: u32,
    /// Stored cells / all cells of the root cube (which has eight times the volume of the scene's).
    pub density: f64,
    /// Bytes of the cells' data and normals.
    pub data_bytes: u64,
    /// Bytes of the tables.
    pub table_bytes: u64,
}

impl Octree<'_> {
    /// What a level holds and weighs, with `cell_bytes` of data a cell beside the normal.
    pub fn statistics(&self, level: u32, cell_bytes: u32) -> LevelStatistics {
        let (side, cells) = (self.grid().side(level), self.level_range(level).len() as u32);
        let buckets: u64 = self.level_maps(level).iter().map(|map| u64::from(map.buckets)).sum();
        LevelStatistics {
            level,
            side,
            cells,
            density: f64::from(cells) / (f64::from(side) * f64::from(side) * f64::from(side)),
            data_bytes: u64::from(cells) * u64::from(cell_bytes + NORMAL_BYTES),
            table_bytes: buckets * u64::from(BUCKET_WORDS) * 4,
        }
    }
}

/// Bytes that a scene's octree will have, tables, normals and `cell_bytes` of data a cell: exact up to a resolution of 256,
/// within some percent beyond, where the growth between the two finest levels counted is carried on.
///
/// # Errors
/// [`BuildError`] for a scene or a resolution of which there is no octree.
pub fn predict_bytes(
    triangles: &Triangles<'_>,
    resolution: u32,
    cell_bytes: u32,
    workers: &dyn Workers,
) -> Result<u64, BuildError> {
    let [low, high] = triangles.bounds().ok_or(BuildError::Empty)?;
    let wanted = Grid::new(low, high, resolution)?;
    let probe = Partition::new(&Grid::new(low, high, resolution.min(PROBE))?, triangles, u64::MAX, workers)?;
    Ok(grown(&probe, wanted.levels, cell_bytes))
}

/// The bytes of a partition with more levels.
fn grown(probe: &Partition, levels: u32, cell_bytes: u32) -> u64 {
    // A smooth surface has four times as many cells a level, what is thinner than a cell up to eight times.
    let growth = (probe.cells(0) as f64 / probe.cells(1) as f64).clamp(2.0, 8.0);
    let doublings = levels.saturating_sub(probe.grid().levels);
    (0..doublings).fold(probe.bytes(cell_bytes) as f64, |bytes, _| bytes * growth) as u64
}

/// The largest resolution up to `wanted` (rounded down to a power of two) whose octree will, by prediction, have at most
/// `max_bytes`: see [`predict_bytes`].
///
/// # Errors
/// [`BuildError`] for a scene of which there is no octree; [`BuildError::TooLarge`] when even the smallest has more bytes.
pub fn resolution_within(
    triangles: &Triangles<'_>,
    wanted: u32,
    cell_bytes: u32,
    max_bytes: u64,
    workers: &dyn Workers,
) -> Result<u32, BuildError> {
    let [low, high] = triangles.bounds().ok_or(BuildError::Empty)?;
    let wanted = 1 << wanted.clamp(MIN_RESOLUTION, super::grid::MAX_RESOLUTION).ilog2();
    let probe = Partition::new(&Grid::new(low, high, wanted.min(PROBE))?, triangles, u64::MAX, workers)?;
    let mut resolution = wanted;
    loop {
        // A coarser octree is a finer one without its finest levels.
        let coarser = probe.grid().resolution.ilog2().saturating_sub(resolution.ilog2());
        let needed = if coarser > 0 {
            probe.bytes_from(coarser, cell_bytes)
        } else {
            grown(&probe, resolution.ilog2() + 2, cell_bytes)
        };
        if needed <= max_bytes {
            return Ok(resolution);
        }
        if resolution == MIN_RESOLUTION {
            return Err(BuildError::TooLarge { needed, limit: max_bytes });
        }
        resolution /= 2;
    }
}

/// The resolution whose finest cells are nearest to a footprint, in ratio: a power of two for [`resolution_within`].
///
/// # Units
/// `footprint` in scene units, the size that cells should have. NaN and what is not above 0 ask for the finest.
///
/// # Errors
/// [`BuildError::Empty`].
pub fn resolution_for_footprint(triangles: &Triangles<'_>, footprint: f32) -> Result<u32, BuildError> {
    let [low, high] = triangles.bounds().ok_or(BuildError::Empty)?;
    let coarsest = Grid::new(low, high, MIN_RESOLUTION)?;
    let mut resolution = MIN_RESOLUTION;
    // Halves round up: 1/√2 is where two sizes are equally near.
    let mut cell = coarsest.cell * core::f32::consts::FRAC_1_SQRT_2;
    while resolution < super::grid::MAX_RESOLUTION && (footprint.is_nan() || footprint < cell) {
        cell *= 0.5;
        resolution *= 2;
    }
    Ok(resolution)
}
