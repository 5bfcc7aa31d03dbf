//! Builds octrees and owns them.

use alloc::vec::Vec;

use super::block::from_morton;
use super::cuckoo::fill;
use super::error::BuildError;
use super::grid::{Grid, MIN_RESOLUTION};
use super::header::{Header, LevelRecord, MAGIC, MapRecord, TABLE_ALIGNMENT, records_words};
use super::normals;
use super::partition::{Partition, Workers};
use super::size::{NORMAL_BYTES, predict_bytes, resolution_within};
use super::triangles::Triangles;
use super::view::Octree;
use crate::geometry::Geometry;

/// What [`build`] needs to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildSettings {
    /// Cells of the finest level along the scene's largest side: a power of two.
    pub resolution: u32,
    /// Bytes of data that a cell will have; counted, not allocated.
    pub cell_bytes: u32,
    /// Most bytes of tables, normals and data.
    pub max_bytes: u64,
}

impl Default for BuildSettings {
    fn default() -> Self {
        Self { resolution: 512, cell_bytes: 48, max_bytes: 4 << 30 }
    }
}

/// An octree that owns its storage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnedOctree {
    /// Header, records and tables: what [`Octree::new`] looks at.
    pub words: Vec<u32>,
    /// The octahedral code of every cell's front: the normal of the largest triangle that overlaps the cell, the first by
    /// number among equals, turned so that its first component that is not 0 is positive.
    pub normals: Vec<u32>,
}

impl OwnedOctree {
    /// The octree.
    ///
    /// # Panics
    /// When `words` was changed to something else.
    pub fn view(&self) -> Octree<'_> {
        Octree::new(&self.words).expect("built by this module")
    }

    /// Bytes of tables and normals.
    pub fn bytes(&self) -> u64 {
        4 * (self.words.len() + self.normals.len()) as u64
    }
}

/// Builds the octree of a scene.
///
/// # Errors
/// [`BuildError`]. [`TooLarge`](BuildError::TooLarge), with the size that the octree would have, comes before memory for
/// tables, normals or data is asked for.
///
/// ```
/// use hashcache_core::geometry::{Geometry, Instance, Mesh};
/// use hashcache_core::glam::Vec3;
/// use hashcache_core::octree::{BuildSettings, Serial, build};
///
/// let geometry = Geometry {
///     positions: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     indices: &[[0, 1, 2]],
///     meshes: &[Mesh { first_triangle: 0, triangle_count: 1 }],
///     instances: &[Instance::identity(0)],
///     ..Geometry::default()
/// };
/// let built = build(&geometry, &BuildSettings { resolution: 64, ..BuildSettings::default() }, &Serial)?;
/// let octree = built.view();
/// let on = octree.coordinates(Vec3::new(0.2, 0.3, 0.0)).expect("inside");
/// let off = octree.coordinates(Vec3::new(0.2, 0.3, 0.5)).expect("inside");
/// assert!(octree.cell(0, on).is_some() && octree.cell(0, off).is_none());
/// # Ok::<(), hashcache_core::octree::BuildError>(())
/// ```
pub fn build(
    geometry: &Geometry<'_>,
    settings: &BuildSettings,
    workers: &dyn Workers,
) -> Result<OwnedOctree, BuildError> {
    let &BuildSettings { resolution, cell_bytes, max_bytes } = settings;
    let triangles = Triangles::new(geometry)?;
    let [low, high] = triangles.bounds().ok_or(BuildError::Empty)?;
    let grid = Grid::new(low, high, resolution)?;
    let max_cells = (max_bytes / u64::from(NORMAL_BYTES + cell_bytes)).min(u64::from(u32::MAX));
    let partition = match Partition::new(&grid, &triangles, max_cells, workers) {
        Err(BuildError::TooLarge { .. }) => {
            // Counting was stopped: the whole is predicted, but not below what was counted.
            let predicted = predict_bytes(&triangles, resolution, cell_bytes, workers)?;
            return Err(BuildError::TooLarge { needed: predicted.max(max_bytes.saturating_add(1)), limit: max_bytes });
        }
        partition => partition?,
    };
    let needed = partition.bytes(cell_bytes);
    if needed > max_bytes {
        return Err(BuildError::TooLarge { needed, limit: max_bytes });
    }
    finish(&partition, &triangles, workers)
}

/// Builds the octree of the largest resolution up to `settings.resolution` that has at most `settings.max_bytes`.
///
/// # Errors
/// [`BuildError`]; [`TooLarge`](BuildError::TooLarge) when no resolution is small enough.
pub fn build_within(
    geometry: &Geometry<'_>,
    settings: &BuildSettings,
    workers: &dyn Workers,
) -> Result<OwnedOctree, BuildError> {
    let &BuildSettings { resolution, cell_bytes, max_bytes } = settings;
    let triangles = Triangles::new(geometry)?;
    let mut resolution = resolution_within(&triangles, resolution, cell_bytes, max_bytes, workers)?;
    loop {
        match build(geometry, &BuildSettings { resolution, ..*settings }, workers) {
            // The prediction was too low.
            Err(BuildError::TooLarge { .. }) if resolution > MIN_RESOLUTION => resolution /= 2,
            result => return result,
        }
    }
}

/// Puts a partition's cells into tables and finds their normals.
///
/// # Errors
/// [`BuildError::TooMany`].
pub fn finish(
    partition: &Partition,
    triangles: &Triangles<'_>,
    workers: &dyn Workers,
) -> Result<OwnedOctree, BuildError> {
    let words = tables(partition)?;
    let normals = normals::normals(&words, partition, triangles, workers);
    Ok(OwnedOctree { words, normals })
}

fn tables(partition: &Partition) -> Result<Vec<u32>, BuildError> {
    let grid = partition.grid();
    let maps = partition.levels().iter().map(Vec::len).sum::<usize>() as u32;
    let records = records_words(grid.levels, maps);
    let mut words = Vec::with_capacity(partition.words_from(0) as usize);
    words.resize(records, 0);
    let (mut levels, mut map_records) = (Vec::new(), Vec::new());
    let mut cells = 0_u64;
    for (level, maps) in (0..).zip(partition.levels()) {
        let mut record = LevelRecord {
            corner: grid.level_corner(level),
            maps_log2: grid.level_maps_log2(level),
            first_map: map_records.len() as u32,
            first_cell: cells as u32,
            cells: 0,
            reserved: 0,
        };
        for blocks in maps {
            let first_word = u32::try_from(words.len()).map_err(|_| BuildError::TooMany)?;
            let rows = || {
                blocks.iter().scan(cells as u32, |base, block| {
                    let row = [from_morton((block >> 32) as u32), *block as u32, *base];
                    *base = base.wrapping_add((*block as u32).count_ones());
                    Some(row)
                })
            };
            let (buckets, seed) = fill(&mut words, blocks.len() as u32, rows);
            words.resize(words.len().next_multiple_of(TABLE_ALIGNMENT), 0);
            map_records.push(MapRecord { first_word, buckets, seed, blocks: blocks.len() as u32 });
            cells += blocks.iter().map(|block| u64::from((*block as u32).count_ones())).sum::<u64>();
        }
        record.cells = (cells - u64::from(record.first_cell)) as u32;
        levels.push(record);
        if cells > u64::from(u32::MAX) {
            return Err(BuildError::TooMany);
        }
    }
    let count = u32::try_from(words.len()).map_err(|_| BuildError::TooMany)?;
    let header = Header { magic: MAGIC, words: count, maps, cells: cells as u32, grid: *grid };
    let (head, rest) = words.split_at_mut(size_of::<Header>() / 4);
    head.copy_from_slice(bytemuck::cast_slice(&[header]));
    let (level_words, rest) = rest.split_at_mut(size_of_val(levels.as_slice()) / 4);
    level_words.copy_from_slice(bytemuck::cast_slice(&levels));
    rest[..size_of_val(map_records.as_slice()) / 4].copy_from_slice(bytemuck::cast_slice(&map_records));
    Ok(words)
}
