//! What a grid is built with: settings in the units of the scene, and the block of integers that kernels read.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::exact::Quantum;
use hashcache_core::level::exponent;

/// Most slots that a claim, a deposit or a lookup looks at. The distance from home fills six bits of a tag.
pub const MAX_PROBES: u32 = 64;

/// Most bins along an edge of a face of the normals' cube. At 15 a bin is 6° wide, finer than any cell stays filled.
pub const MAX_NORMAL_BINS: u32 = 15;

/// Fixed point of positions inside a cell: 2⁸ = 256 steps along its edge. More would leave less than 2²² cells along
/// an axis on the finest level, fewer would show in the jitter.
pub const CELL_BITS: u32 = 8;

/// Exponents of the smallest cell's size that are accepted: 2⁻³⁰ (a nanometre) to 2²⁰ (a thousand kilometres).
pub const BASE_EXPONENTS: core::ops::RangeInclusive<i32> = -30..=20;

/// Mantissa bits of the footprint and of its factor that count: 12 and 12 make 24, so their product is exact.
const EXACT_MASK: u32 = 0xffff_f000;

/// The bits of 2⁶³: times the largest factor, 2⁴⁶, it stays finite.
const FOOTPRINT_MAX: u32 = 0x5f00_0000;

/// What a grid is built with, in the units of the scene. [`Params::new`] checks it.
///
/// ```
/// # use hashgrid::{Params, Settings};
/// let settings = Settings { cell_footprints: 12.0, pixel_angle: 0.001, ..Settings::default() };
/// assert!(Params::new(&settings).is_ok());
/// assert!(Params::new(&Settings { normal_bins: 4, ..settings }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Size of a cell in footprints (pixels, as seen along the path), 2⁻¹⁰ to 2¹⁶. Sizes are powers of two: a cell is
    /// between half this size and this size. 12 significant bits count.
    pub cell_footprints: f32,
    /// Size of the smallest cells in metres, 2⁻³⁰ to 2²⁰; rounded down to a power of two, so that the way from
    /// world to cell is exact. Footprints below it share its cells.
    pub base_size: f32,
    /// Angle of a pixel, 2·tan(`fov_y`/2)/height: footprint / path length. 0 leaves out how the jitter changes the
    /// level (all levels then end abruptly).
    pub pixel_angle: f32,
    /// Width of the jitter, 0 (none) to 1 (a whole cell, half to either side; normals: a whole bin).
    pub jitter: f32,
    /// Bins along an edge of a face of the normals' cube, odd, 1 to [`MAX_NORMAL_BINS`]. Odd, so that axis-aligned
    /// normals are in the middle of a bin and not on a border.
    pub normal_bins: u32,
    /// Slots a key may try, 1 to [`MAX_PROBES`].
    pub max_probes: u32,
    /// Seed of the jitter.
    pub seed: u32,
    /// Unit of the sums.
    pub quantum: Quantum,
}

impl Default for Settings {
    /// Cells of 8 pixels, at least a millimetre; full jitter; 3×3 bins a face; 64 probes; L0 = 1.
    fn default() -> Self {
        Self {
            cell_footprints: 8.0,
            base_size: 1.0 / 1024.0,
            pixel_angle: 0.001,
            jitter: 1.0,
            normal_bins: 3,
            max_probes: MAX_PROBES,
            seed: 0,
            quantum: Quantum::for_scale(1.0),
        }
    }
}

/// Checked settings as integers: the parameter block of all kernels of this crate (48 bytes, `HgParams` in WGSL).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Params {
    cells_per_footprint: u32,
    base_exponent: i32,
    level_rate: i32,
    jitter: u32,
    normal_bins: u32,
    normal_jitter: u32,
    max_probes: u32,
    seed: u32,
    quantum: Quantum,
    reserved: [u32; 3],
}

impl Params {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] or [`ParamError::OutOfRange`] with the setting's name; an even `normal_bins` counts as
    /// out of range.
    pub fn new(settings: &Settings) -> Result<Self, ParamError> {
        let Settings { cell_footprints, base_size, pixel_angle, jitter, normal_bins, max_probes, seed, quantum } =
            *settings;
        let power = |e: i32| f64::from_bits(((e + 1023) as u64) << 52);
        ParamError::check_range("cell_footprints", f64::from(cell_footprints), power(-10), power(16))?;
        let (smallest, largest) = (power(*BASE_EXPONENTS.start()), power(*BASE_EXPONENTS.end()));
        ParamError::check_range("base_size", f64::from(base_size), smallest, largest)?;
        ParamError::check_range("pixel_angle", f64::from(pixel_angle), 0.0, 4.0)?;
        ParamError::check_range("jitter", f64::from(jitter), 0.0, 1.0)?;
        ParamError::check_range("normal_bins", f64::from(normal_bins), 1.0, f64::from(MAX_NORMAL_BINS))?;
        if normal_bins % 2 == 0 {
            let (value, max) = (f64::from(normal_bins), f64::from(MAX_NORMAL_BINS));
            return Err(ParamError::OutOfRange { name: "normal_bins", value, min: 1.0, max });
        }
        ParamError::check_range("max_probes", f64::from(max_probes), 1.0, f64::from(MAX_PROBES))?;

        let base_exponent = exponent(base_size);
        let factor = f32::from_bits(cell_footprints.to_bits() & EXACT_MASK);
        // A power of two scales exactly.
        let cells_per_footprint = factor * f32::from_bits(((127 - base_exponent) as u32) << 23);
        // Cell size / path length, in 2⁻²³ a 256th of a cell; above 64 the cell dwarfs the path and the level is moot.
        let rate = (cell_footprints * pixel_angle).min(64.0) * 32_768.0 + 0.5;
        Ok(Self {
            cells_per_footprint: cells_per_footprint.to_bits(),
            base_exponent,
            level_rate: rate as i32,
            jitter: (jitter * 128.0 + 0.5) as u32,
            normal_bins,
            normal_jitter: (jitter * 32_768.0 / normal_bins as f32) as u32,
            max_probes,
            seed,
            quantum,
            reserved: [0; 3],
        })
    }

    /// Exponent of the smallest cells' size, which is 2^`base_exponent` metres.
    pub const fn base_exponent(&self) -> i32 {
        self.base_exponent
    }

    /// Largest offset along an axis, in 256ths of a cell, 0 to 128.
    pub const fn jitter(&self) -> u32 {
        self.jitter
    }

    /// Bins along an edge of a face of the normals' cube.
    pub const fn normal_bins(&self) -> u32 {
        self.normal_bins
    }

    /// Largest shift of a normal, in 32768ths of half a face's edge.
    pub const fn normal_jitter(&self) -> u32 {
        self.normal_jitter
    }

    /// Slots a key may try.
    pub const fn max_probes(&self) -> u32 {
        self.max_probes
    }

    /// Seed of the jitter.
    pub const fn seed(&self) -> u32 {
        self.seed
    }

    /// Unit of the sums.
    pub const fn quantum(&self) -> Quantum {
        self.quantum
    }

    /// A footprint, given by its bits, in cells of the smallest level times their size in footprints. Exact, since the
    /// footprint is cut to 12 significant bits, and finite, since it is cut to 2⁶³ metres; 0 for negative ones.
    #[inline]
    pub fn footprint_in_cells(&self, footprint: u32) -> f32 {
        let usable = if footprint > 0x7fff_ffff { 0 } else { footprint.min(FOOTPRINT_MAX) };
        f32::from_bits(usable & EXACT_MASK) * f32::from_bits(self.cells_per_footprint)
    }

    /// How much farther a path is, in 2⁻²³ of a footprint's worth of cells, for each 256th of a cell.
    pub(crate) const fn level_rate(&self) -> i32 {
        self.level_rate
    }

    /// Edge of a cell of `level`, in metres.
    ///
    /// ```
    /// # use hashgrid::{Params, Settings};
    /// let params = Params::new(&Settings { base_size: 0.01, ..Settings::default() })?;
    /// assert_eq!(params.cell_size(3), 8.0 / 128.0); // 0.01 is rounded down to 2⁻⁷
    /// # Ok::<(), hashcache_core::error::ParamError>(())
    /// ```
    pub fn cell_size(&self, level: u32) -> f32 {
        f32::from_bits(((127 + self.base_exponent + level as i32) as u32) << 23)
    }
}
