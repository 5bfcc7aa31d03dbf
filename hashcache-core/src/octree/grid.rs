//! Where the cells of all levels lie.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::error::ParamError;

/// Smallest resolution: one block of cells along a side.
pub const MIN_RESOLUTION: u32 = 4;

/// Largest resolution. Twice as many cells would need a finer step than f32 has at the far side of the cube, so that
/// cells would differ in size.
pub const MAX_RESOLUTION: u32 = 1 << 16;

/// Every triangle is voxelised with a margin of E·2⁻¹⁹ around each cell: 16 rounding steps of f32 at the far side of the
/// cube. Less, and a point on a triangle could fall, by rounding, into a cell that is not stored; more, and cells are
/// stored in vain (at a resolution of 4096 the margin is 1/128 of a cell).
pub const MARGIN_BITS: u32 = 19;

/// The edge length E exceeds the scene's largest side by this factor, so that no point of the scene lies on the border.
const SLACK: f64 = 1.01;

/// The cube that the octree divides.
///
/// E is 1.01 × the largest side of the scene's box. The finest level (level 0) has `resolution` cells along E. The root
/// cube's edge is 2·E, and its corner lies 2·E/3 below the box's lower corner: a third of the coarsest cell, so that
/// walls along the scene's border miss the borders of cells on all levels by a third of a cell.
///
/// | words | field |
/// |---|---|
/// | 0..3 | `origin` |
/// | 3 | `cell` |
/// | 4 | `recip_cell` |
/// | 5 | `resolution` |
/// | 6 | `levels` |
/// | 7 | `maps_log2` |
/// | 8..11 | `corner` |
/// | 11 | zero |
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Grid {
    /// Corner of the root cube, in scene units.
    pub origin: [f32; 3],
    /// Edge length of a cell of the finest level, in scene units.
    pub cell: f32,
    /// 1 / `cell`, rounded on its own.
    pub recip_cell: f32,
    /// Cells of the finest level along E: a power of two. The cube has twice as many along an edge.
    pub resolution: u32,
    /// Number of levels, log₂(2·`resolution`) + 1. The coarsest has one cell.
    pub levels: u32,
    /// Log₂ of the number of maps along an axis of the finest level: 0 up to a resolution of 4096.
    pub maps_log2: u32,
    /// The lowest corner of a block that may be occupied on the finest level, in cells.
    pub corner: [u32; 3],
    /// Zero.
    pub reserved: u32,
}

/// Cells along the edges of a block: 32 cells, one bit each.
pub const BLOCK: [u32; 3] = [4, 4, 2];

/// Log₂ of the number of cells that one map spans along an axis.
pub const MAP_BITS: u32 = 12;

impl Grid {
    /// The grid of a scene whose points all lie in `min..=max`.
    ///
    /// # Errors
    /// [`ParamError`] for a resolution that is no power of two or outside [`MIN_RESOLUTION`]`..=`[`MAX_RESOLUTION`], for
    /// a box that is not finite, turned inside out, or larger than 2¹⁰⁰.
    ///
    /// ```
    /// use hashcache_core::glam::Vec3;
    /// use hashcache_core::octree::Grid;
    ///
    /// let grid = Grid::new(Vec3::ZERO, Vec3::ONE, 256)?;
    /// // The box begins 2/3 of E above the corner of the cube.
    /// assert_eq!(grid.coordinates(Vec3::ZERO), Some([170, 170, 170]));
    /// assert_eq!((grid.levels, grid.coordinates(Vec3::splat(2.0))), (10, None));
    /// # Ok::<(), hashcache_core::error::ParamError>(())
    /// ```
    pub fn new(min: Vec3, max: Vec3, resolution: u32) -> Result<Self, ParamError> {
        if !resolution.is_power_of_two() {
            return Err(ParamError::NotPowerOfTwo { name: "resolution", value: u64::from(resolution) });
        }
        let (least, most) = (f64::from(MIN_RESOLUTION), f64::from(MAX_RESOLUTION));
        ParamError::check_range("resolution", f64::from(resolution), least, most)?;
        let (low, high) = (min.to_array().map(f64::from), max.to_array().map(f64::from));
        let (mut side, mut farthest) = (0.0_f64, 0.0_f64);
        for axis in 0..3 {
            ParamError::check_range("box", high[axis] - low[axis], 0.0, LARGEST)?;
            ParamError::check_range("box", low[axis], -LARGEST, LARGEST)?;
            side = side.max(high[axis] - low[axis]);
            farthest = farthest.max(low[axis].abs()).max(high[axis].abs());
        }
        // A scene that is a point has cells, too: such that f32 tells them apart where the scene lies.
        let edge = (side * SLACK).max(farthest / f64::from(1 << 16)).max(SMALLEST);
        let cell = (edge / f64::from(resolution)) as f32;
        let recip_cell = (f64::from(resolution) / edge) as f32;
        let origin = low.map(|v| (v - edge * (2.0 / 3.0)) as f32);
        let mut grid = Self {
            origin,
            cell,
            recip_cell,
            resolution,
            levels: resolution.ilog2() + 2,
            maps_log2: resolution.ilog2().saturating_sub(MAP_BITS),
            corner: [0; 3],
            reserved: 0,
        };
        let lowest = grid.exact(min).map(|v| (v - grid.margin()) as u32);
        grid.corner = align(lowest);
        Ok(grid)
    }

    /// The margin around a cell within which triangles count as overlapping it, in cells of the finest level.
    pub fn margin(&self) -> f64 {
        f64::from(self.resolution) / f64::from(1 << MARGIN_BITS)
    }

    /// Cells of `level` along an edge of the root cube.
    ///
    /// ```
    /// # use hashcache_core::{glam::Vec3, octree::Grid};
    /// let grid = Grid::new(Vec3::ZERO, Vec3::ONE, 64)?;
    /// assert_eq!((grid.side(0), grid.side(3), grid.side(grid.levels - 1)), (128, 16, 1));
    /// # Ok::<(), hashcache_core::error::ParamError>(())
    /// ```
    pub const fn side(&self, level: u32) -> u32 {
        (2 * self.resolution) >> level
    }

    /// Edge length of the cells of `level`, in scene units.
    pub fn cell_size(&self, level: u32) -> f32 {
        // Exact: a power of two up to 2¹⁷.
        self.cell * (1_u32 << level) as f32
    }

    /// The cell of the finest level that holds the point; on level `l` it is the same shifted right by `l`.
    /// `None` outside the root cube and for NaN.
    ///
    /// One subtraction, one multiplication and a floor an axis; the rest is integers.
    #[inline]
    pub fn coordinates(&self, p: Vec3) -> Option<[u32; 3]> {
        let q = (p - Vec3::from_array(self.origin)) * self.recip_cell;
        let side = (2 * self.resolution) as f32;
        // NaN compares false; numbers from 0 on are truncated to their floor.
        let inside = |v: f32| v >= 0.0 && v < side;
        (inside(q.x) && inside(q.y) && inside(q.z)).then_some([q.x as u32, q.y as u32, q.z as u32])
    }

    /// The centre of a cell of `level`, in scene units.
    pub fn centre(&self, level: u32, coordinates: [u32; 3]) -> Vec3 {
        let size = self.cell_size(level);
        Vec3::from_array(coordinates.map(|c| (c as f32 + 0.5) * size)) + Vec3::from_array(self.origin)
    }

    /// The lowest corner of a block that may be occupied on `level`, in cells of that level.
    #[inline]
    #[must_use]
    pub const fn level_corner(&self, level: u32) -> [u32; 3] {
        let [x, y, z] = self.corner;
        align([x >> level, y >> level, z >> level])
    }

    /// Log₂ of the number of maps along an axis of `level`.
    #[inline]
    pub const fn level_maps_log2(&self, level: u32) -> u32 {
        self.maps_log2.saturating_sub(level)
    }

    /// A point in cells of the finest level, in double precision.
    #[must_use]
    pub(crate) fn exact(&self, p: Vec3) -> [f64; 3] {
        let (p, recip) = (p.to_array(), f64::from(self.recip_cell));
        core::array::from_fn(|axis| (f64::from(p[axis]) - f64::from(self.origin[axis])) * recip)
    }
}

/// The corner of the block that holds a cell.
const fn align(cell: [u32; 3]) -> [u32; 3] {
    [cell[0] & !3, cell[1] & !3, cell[2] & !1]
}

/// Largest box side and coordinate: squares and cubes of cells stay finite.
const LARGEST: f64 = 1.267_650_600_228_229_4e30;

/// Smallest E: the reciprocal of a cell stays a normal f32.
const SMALLEST: f64 = 7.888_609_052_210_118e-31;
