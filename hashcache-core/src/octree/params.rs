//! What the octree's data are kept and asked by: settings, and the block of words that kernels read.

use bytemuck::{Pod, Zeroable};

use crate::error::ParamError;
use crate::exact::{MAX_DEPOSITS, Quantum};
use crate::float;
use crate::level::MAX_LEVEL;

/// Fixed point of the jitter inside a cell: 2⁸ = 256 steps along its edge.
pub const JITTER_BITS: u32 = 8;

/// Which light a cache holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Light {
    /// Direct and further light together.
    #[default]
    All = 0,
    /// Only light that arrives after a further scattering; direct light is traced by whoever asks.
    Further = 1,
}

/// Settings of the data of an octree. [`OctreeParams::new`] checks them.
///
/// ```
/// # use hashcache_core::octree::{OctreeParams, OctreeSettings};
/// let settings = OctreeSettings { cell: 2.0, min_samples: 8, ..OctreeSettings::default() };
/// assert!(OctreeParams::new(&settings).is_ok());
/// assert!(OctreeParams::new(&OctreeSettings { jitter: f32::NAN, ..settings }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctreeSettings {
    /// Which light is recorded and answered.
    pub light: Light,
    /// Size of the cells that lookups read, in footprints (pixels as seen along the path), 2⁻¹⁰ to 2¹⁶.
    pub cell: f32,
    /// The paper's `s_j`: half the edge of the square, in cells, that a lookup is moved in along the surface, 0 to 4.
    pub jitter: f32,
    /// How far levels blend into each other: 0, the level nearest the footprint, with a border where it changes; 1, one of
    /// the two levels around it by chance, so that there is no border.
    pub level_jitter: f32,
    /// Samples that a cell must have to be read; else a coarser one is. 0 and 1 mean any.
    pub min_samples: u32,
    /// Levels that a lookup goes up for want of samples, beyond the one nearest the footprint, at most [`MAX_LEVEL`].
    pub max_climb: u32,
    /// Levels below the one nearest the footprint where a lookup starts: with `min_samples` it reads the finest of them
    /// that has enough. 0: cells are never smaller than the footprint asks for.
    pub finer: u32,
    /// Samples that the level above counts for in a level's answer, 0 (levels do not mix) to 2¹⁶.
    pub shrinkage: f32,
    /// Samples after which a mean becomes a moving average, 1 to 2³⁰ (2¹⁶ − 1 at most in layout `paper`): what is older
    /// fades.
    pub max_samples: u32,
    /// Seed of the jitter.
    pub seed: u32,
    /// Unit of a frame's sums.
    pub quantum: Quantum,
}

impl Default for OctreeSettings {
    /// All light; cells of two footprints, moved by half a cell; at least 4 samples, 3 levels up at most.
    fn default() -> Self {
        Self {
            light: Light::All,
            cell: 2.0,
            jitter: 0.5,
            level_jitter: 0.0,
            min_samples: 4,
            max_climb: 3,
            finer: 0,
            shrinkage: 0.0,
            max_samples: MAX_DEPOSITS,
            seed: 0,
            quantum: Quantum::for_scale(1.0),
        }
    }
}

/// Checked settings: the parameter block of the octree's kernels (64 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct OctreeParams {
    quantum: Quantum,
    seed: u32,
    light: u32,
    cell_factor: u32,
    jitter: u32,
    level_jitter: u32,
    min_samples: u32,
    max_climb: u32,
    finer: u32,
    max_samples: u32,
    /// Frame of the last wipe.
    wiped: u32,
    /// Level of a merge.
    level: u32,
    shrinkage: u32,
    /// Records of the frame before those of a batch.
    first: u32,
    reserved: [u32; 2],
}

impl OctreeParams {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] or [`ParamError::OutOfRange`] with the setting's name.
    pub fn new(settings: &OctreeSettings) -> Result<Self, ParamError> {
        let OctreeSettings {
            light,
            cell,
            jitter,
            level_jitter,
            min_samples,
            max_climb,
            finer,
            shrinkage,
            max_samples,
            seed,
            quantum,
        } = *settings;
        ParamError::check_range("cell", f64::from(cell), 1.0 / 1024.0, 65_536.0)?;
        ParamError::check_range("jitter", f64::from(jitter), 0.0, 4.0)?;
        ParamError::check_range("level_jitter", f64::from(level_jitter), 0.0, 1.0)?;
        ParamError::check_range("min_samples", f64::from(min_samples), 0.0, f64::from(MAX_DEPOSITS))?;
        ParamError::check_range("max_climb", f64::from(max_climb), 0.0, f64::from(MAX_LEVEL))?;
        ParamError::check_range("finer", f64::from(finer), 0.0, f64::from(MAX_LEVEL))?;
        ParamError::check_range("shrinkage", f64::from(shrinkage), 0.0, 65_536.0)?;
        ParamError::check_range("max_samples", f64::from(max_samples), 1.0, f64::from(MAX_DEPOSITS))?;
        // ⌊log₂ x + ½⌋ is the nearest level; with jitter, ⌊log₂ x + (1 − j)/2 + j·u⌋ for u in 0..1.
        let cell_factor = cell * float::exp2(0.5 * (1.0 - level_jitter));
        Ok(Self {
            quantum,
            seed,
            light: light as u32,
            cell_factor: cell_factor.to_bits(),
            jitter: (jitter * (1 << JITTER_BITS) as f32 + 0.5) as u32,
            // In 65536ths of the mantissa's range.
            level_jitter: (level_jitter * 65_536.0 + 0.5) as u32,
            min_samples,
            max_climb,
            finer,
            max_samples,
            wiped: 0,
            level: 0,
            shrinkage: shrinkage.to_bits(),
            first: 0,
            reserved: [0; 2],
        })
    }

    /// The same with `frame` as the index of the last wipe: cells with another index count as empty.
    #[must_use]
    pub const fn with_wiped(mut self, frame: u32) -> Self {
        self.wiped = frame;
        self
    }

    /// The same for a merge of `level`.
    #[must_use]
    pub const fn with_level(mut self, level: u32) -> Self {
        self.level = level;
        self
    }

    /// The same for a batch before which the frame has `first` records.
    #[must_use]
    pub const fn with_first(mut self, first: u32) -> Self {
        self.first = first;
        self
    }

    /// Unit of a frame's sums.
    pub const fn quantum(&self) -> Quantum {
        self.quantum
    }

    /// Seed of the jitter.
    pub const fn seed(&self) -> u32 {
        self.seed
    }

    /// Which light is recorded and answered.
    pub const fn light(&self) -> Light {
        if self.light == 0 { Light::All } else { Light::Further }
    }

    /// Size of the cells that lookups read, in footprints, times what rounds to the nearest level.
    pub const fn cell_factor(&self) -> f32 {
        f32::from_bits(self.cell_factor)
    }

    /// Largest offset along an axis, in 256ths of a cell.
    pub const fn jitter(&self) -> u32 {
        self.jitter
    }

    /// Share of a level that is drawn, in 65536ths.
    pub const fn level_jitter(&self) -> u32 {
        self.level_jitter
    }

    /// Samples that a cell must have to be read, at least 1.
    pub const fn min_samples(&self) -> u32 {
        if self.min_samples == 0 { 1 } else { self.min_samples }
    }

    /// Levels that a lookup goes up for want of samples.
    pub const fn max_climb(&self) -> u32 {
        self.max_climb
    }

    /// Levels below the one nearest the footprint where a lookup starts.
    pub const fn finer(&self) -> u32 {
        self.finer
    }

    /// Samples that the level above counts for in a level's answer.
    pub const fn shrinkage(&self) -> f32 {
        f32::from_bits(self.shrinkage)
    }

    /// Samples after which a mean becomes a moving average.
    pub const fn max_samples(&self) -> u32 {
        self.max_samples
    }

    /// Index of the frame of the last wipe.
    pub const fn wiped(&self) -> u32 {
        self.wiped
    }

    /// Level of a merge.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Records of the frame before those of a batch.
    pub const fn first(&self) -> u32 {
        self.first
    }
}

const _: () = assert!(size_of::<OctreeParams>() == 64);
