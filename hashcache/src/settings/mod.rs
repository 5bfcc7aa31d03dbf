//! Every setting, by its dotted name.

mod rows;

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Map, Value};

use crate::choice::{
    BackendKind, CacheKind, Choice as _, DenoiserKind, DirectLight, FilterKind, IntegratorKind, Launcher, Moments,
    OctreeLayout, ToneCurve, VisibilityKind,
};
use crate::feature::FeatureSet;
use crate::tone::ToneMapping;

use rows::ROWS;

/// Largest picture side in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// Largest number of samples a pixel: sample indices stay below 2²⁴, where the sampler's points are distinct in `f32`.
pub const MAX_SPP: u32 = 1 << 24;

/// Largest `cache.store`.
pub const MAX_STORE: u32 = pt_integrator::path::MAX_STORED as u32;

/// Largest `octree.resolution`.
pub const MAX_RESOLUTION: u32 = 1 << 16;

/// Largest `max_bounces`.
pub const MAX_BOUNCES: u32 = 1024;

/// What a preview is rendered with: each setting by its name, what it means, its range and its default, which is also the
/// command line's.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// `backend`: where kernels run, by default `cpu`.
    pub backend: BackendKind,
    /// `integrator`: how light is transported, by default `path`.
    pub integrator: IntegratorKind,
    /// `cache`: where light is shared between paths, by default `octree`.
    pub cache: CacheKind,
    /// `visibility`: how shadow rays are answered, by default `exact`.
    pub visibility: VisibilityKind,
    /// `filter`: how the picture is filtered, by default `layered`.
    pub filter: FilterKind,
    /// `spp`: samples a pixel, 1 to 16777216 ([`MAX_SPP`]), by default 1.
    pub spp: u32,
    /// `size`: columns × rows, each 1 to 16384 ([`MAX_SIDE`]); `None`: what the scene asks for, else 512×512.
    pub size: Option<(u32, u32)>,
    /// `camera`: a camera's name or index in the file, or a camera file; `None`: the file's first.
    pub camera: Option<String>,
    /// `env`: an environment map that replaces the scene's.
    pub env: Option<PathBuf>,
    /// `env_scale`: factor on the environment's radiance, 0 to 10¹², by default 1.
    pub env_scale: f32,
    /// `env.rotation`: degrees by which the environment is turned about +y, counter-clockwise seen from above: at 90,
    /// what was at −z is at −x. −3600 to 3600, by default 0.
    pub env_rotation: f32,
    /// `max_bounces`: surface scatterings at most, 0 to 1024 ([`MAX_BOUNCES`]), by default 8; 0 shows only emission seen
    /// directly.
    pub max_bounces: u32,
    /// `seed`: of every random decision, 0 to 4294967295, by default 0.
    pub seed: u32,
    /// `threads`: 0 to 1024, by default 0: one a core.
    pub threads: u32,
    /// `cpu.launcher`: how the CPU backend runs kernels, by default `rayon`.
    pub launcher: Launcher,
    /// `path.roulette_depth`: Russian roulette from this scattering on, 1 to 1024; `None` (`off`), by default `off`:
    /// none.
    pub roulette_depth: Option<u32>,
    /// `path.moments`: whether path tracing without cache and filter also keeps how its samples scatter, which tells the
    /// standard error of its pixels, by default `off`. 16 bytes a pixel; the picture stays the same.
    pub path_moments: Moments,
    /// `cache.roulette_depth`: the same for the paths that fill a cache or feed a filter, whose noise others share: 1 to
    /// 1024 or `off`, by default 4.
    pub cache_roulette_depth: Option<u32>,
    /// `cache.direct`: whether direct light comes from the cache or from the pixel's own shadow rays, by default
    /// `cached`.
    pub direct: DirectLight,
    /// `cache.crf`: caching resolution factor: columns and rows of the cache pass per column and row of the picture, 0.05
    /// to 8, by default 1.
    pub crf: f32,
    /// `cache.store`: vertices of each path that the cache takes, 1 to 8, by default 1.
    pub store: u32,
    /// `cache.length`: scatterings behind a stored vertex that bring light to it, 0 to 1024; `None` (`auto`), by default
    /// `auto`: as many as `max_bounces` leaves to a path's first vertex.
    pub store_length: Option<u32>,
    /// `direct.samples`: shadow rays of each sample of a pixel when direct light is traced, 1 to 256, by default 2.
    pub direct_samples: u32,
    /// `direct.candidates`: light samples among which each shadow ray's is drawn by its contribution, 1 to 64, by default
    /// 1.
    pub direct_candidates: u32,
    /// `direct.scattered`: rays in proportion to the cosine, beside the shadow rays, 0 to 64, by default 1; without any,
    /// noise near emitters has no bound.
    pub direct_scattered: u32,
    /// `reconstruct.samples`: samples a pixel and frame at least that show surfaces and ask the cache, 1 to 4096, by
    /// default 4.
    pub reconstruct_samples: u32,
    /// `needs.force`: features that frames model though the scene has none of them, by default `none`: no bit of the
    /// picture changes, only time and memory.
    pub needs_force: FeatureSet,
    /// `filter.layers`: vertices one behind another, through mirrors and glass, that are kept and filtered by themselves,
    /// 1 to 8, by default 4; fewer where the scene needs fewer.
    pub filter_layers: u32,
    /// `filter.denoiser`: the denoiser behind the filter, by default `cross-bilateral`.
    pub denoiser: DenoiserKind,
    /// `filter.passes`: passes of the denoiser over each image, 1 to 8, by default 1.
    pub filter_passes: u32,
    /// `filter.radius`: farthest tap of the cross-bilateral filter in pixels, 1 to 256, by default 8.
    pub filter_radius: f32,
    /// `filter.samples`: the radius is √(this / samples behind a pixel's light), up to `filter.radius`; 0: always that. 0
    /// to 10⁹, by default 600.
    pub filter_samples: f32,
    /// `filter.wide_radius`: farthest tap of the pass that comes before, over the octree's light, and mixes what differs
    /// by no more than its noise, in pixels, 1 to 256, by default 24; 0: no such pass.
    pub filter_wide_radius: f32,
    /// `filter.wide_samples`: that radius is √(this / samples behind a pixel's light), up to `filter.wide_radius`; 0:
    /// always that. 0 to 10⁹, by default 5000.
    pub filter_wide_samples: f32,
    /// `filter.significance`: standard deviations of a difference of light at which that pass mixes 1/e, 0.001 to 10⁶, by
    /// default 1.5.
    pub filter_significance: f32,
    /// `filter.direct_radius`: the radius over direct light that is traced, in pixels, 1 to 256, by default 2.
    pub filter_direct_radius: f32,
    /// `filter.luminance`: fall with the difference of light, in standard deviations of a pixel's mean, 0.001 to 10⁶; 0:
    /// off. By default 0.
    pub filter_luminance: f32,
    /// `filter.normal`: how often the cosine between normals is squared, 0 to 10, by default 3.
    pub filter_normal: u32,
    /// `filter.path`: fall with the difference of path lengths, per scene radius; 0: off. 0 to 10⁹, by default 0.
    pub filter_path: f32,
    /// `filter.segment`: fall with the difference of last segments' lengths, per scene radius; 0: off. 0 to 10⁹, by
    /// default 0.
    pub filter_segment: f32,
    /// `filter.plane`: width of the bell over the distance from the tangent plane, in pixel footprints, 0.01 to 10000, by
    /// default 2; 0: off.
    pub filter_plane: f32,
    /// `filter.color`: fall with the difference of albedos; 0: off. 0 to 10⁶, by default 0.
    pub filter_color: f32,
    /// `octree.resolution`: cells of the finest level along the scene's largest side, a power of two, 4 to 65536
    /// ([`MAX_RESOLUTION`]); `None` (`auto`), by default `auto`: from the picture's median footprint and `octree.memory`.
    pub octree_resolution: Option<u32>,
    /// `octree.memory`: most MiB of an octree whose resolution is `auto`, 1 to 1048576, by default 1024.
    pub octree_memory: u32,
    /// `octree.cell`: size of the cell asked for in pixel footprints, 0.01 to 10000, by default 2.
    pub octree_cell: f32,
    /// `octree.jitter`: width of the jitter in cells, 0 to 2, by default 0.75; 0: none.
    pub octree_jitter: f32,
    /// `octree.min_samples`: samples below which a coarser cell is asked, 0 to 16777216, by default 128.
    pub octree_min_samples: u32,
    /// `octree.shrinkage`: samples that a coarser cell counts for in a finer one's answer; 0: levels do not mix. 0 to
    /// 65536, by default 16.
    pub octree_shrinkage: f32,
    /// `octree.max_climb`: levels at most that a question rises for `octree.min_samples`, 0 to 31, by default 5.
    pub octree_max_climb: u32,
    /// `octree.layout`: what a cell stores, by default `exact`.
    pub octree_layout: OctreeLayout,
    /// `grid.cell`: size of a cell in pixel footprints, 0.01 to 10000, by default 8.
    pub grid_cell: f32,
    /// `grid.jitter`: width of the jitter in cells, 0 to 1, by default 1; 0: none.
    pub grid_jitter: f32,
    /// `grid.normal_bins`: bins of normals along a side of the cube of directions, odd, 1 to 15, by default 3.
    pub grid_normal_bins: u32,
    /// `grid.slots`: cells that the table has room for, a power of two, 64 to 268435456; `None` (`auto`), by default
    /// `auto`: from the picture's size.
    pub grid_slots: Option<u32>,
    /// `grid.max_probes`: slots tried for a key, 1 to 64, by default 64.
    pub grid_max_probes: u32,
    /// `grid.history`: most deposits of earlier frames that a cell keeps, 0 to 10⁶, by default 0: all, until the lights
    /// change. With a limit cells are never emptied, and pixels show the present frame alone: a change of the light fades, by
    /// limit/(limit + deposits) a frame.
    pub grid_history: u32,
    /// `check.fraction`: share of the pixels, drawn by a hash of pixel and seed, bright ones more often, that are also
    /// traced by paths without cache, so that statistics tell the picture's bias; 0 to 1, by default 0: none.
    pub check_fraction: f64,
    /// `check.spp`: such paths a pixel and frame, an even number, 2 to 16777216 ([`MAX_SPP`]), by default 16.
    pub check_spp: u32,
    /// `image.exposure`: stops by which a PNG is brighter, −100 to 100, by default 0; EXR and HDR hold radiance as it is.
    pub image_exposure: f32,
    /// `image.tonemap`: the curve between radiance and a PNG, by default `srgb`.
    pub image_tonemap: ToneCurve,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            backend: BackendKind::Cpu,
            integrator: IntegratorKind::Path,
            cache: CacheKind::Octree,
            visibility: VisibilityKind::Exact,
            filter: FilterKind::Layered,
            spp: 1,
            size: None,
            camera: None,
            env: None,
            env_scale: 1.0,
            env_rotation: 0.0,
            max_bounces: 8,
            seed: 0,
            threads: 0,
            launcher: Launcher::Rayon,
            roulette_depth: None,
            path_moments: Moments::Off,
            cache_roulette_depth: Some(4),
            direct: DirectLight::Cached,
            crf: 1.0,
            store: 1,
            store_length: None,
            direct_samples: 2,
            direct_candidates: 1,
            direct_scattered: 1,
            reconstruct_samples: 4,
            needs_force: FeatureSet::NONE,
            filter_layers: 4,
            denoiser: DenoiserKind::CrossBilateral,
            filter_passes: 1,
            filter_radius: 8.0,
            filter_samples: 600.0,
            filter_wide_radius: 24.0,
            filter_wide_samples: 5000.0,
            filter_significance: 1.5,
            filter_direct_radius: 2.0,
            filter_luminance: 0.0,
            filter_normal: 3,
            filter_path: 0.0,
            filter_segment: 0.0,
            filter_plane: 2.0,
            filter_color: 0.0,
            octree_resolution: None,
            octree_memory: 1024,
            octree_cell: 2.0,
            octree_jitter: 0.75,
            octree_min_samples: 128,
            octree_shrinkage: 16.0,
            octree_max_climb: 5,
            octree_layout: OctreeLayout::Exact,
            grid_cell: 8.0,
            grid_jitter: 1.0,
            grid_normal_bins: 3,
            grid_slots: None,
            grid_max_probes: 64,
            grid_history: 0,
            check_fraction: 0.0,
            check_spp: 16,
            image_exposure: 0.0,
            image_tonemap: ToneCurve::Srgb,
        }
    }
}

/// A setting that does not exist or a value it does not take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// No setting has this name.
    #[error("{key}: no setting has this name; there are {}", Settings::keys().join(", "))]
    UnknownKey {
        /// The name given.
        key: String,
    },
    /// The setting does not take this value.
    #[error("{key}={value}: not possible; {key} takes {expected}")]
    BadValue {
        /// The setting.
        key: &'static str,
        /// The value given.
        value: String,
        /// What it takes.
        expected: String,
    },
    /// Two settings that do not go together.
    #[error("{first} does not go with {second}; {instead}")]
    Conflict {
        /// The one, with its value.
        first: String,
        /// The other, with its value.
        second: String,
        /// What to use instead.
        instead: String,
    },
}

impl Settings {
    /// The names of all settings.
    pub fn keys() -> Vec<&'static str> {
        ROWS.iter().map(|row| row.key).collect()
    }

    /// Sets one by its name.
    ///
    /// ```
    /// let mut settings = hashcache::Settings::default();
    /// settings.set("grid.cell", "8")?;
    /// assert_eq!(settings.grid_cell, 8.0);
    /// assert!(settings.set("spp", "0").is_err());
    /// # Ok::<(), hashcache::SettingsError>(())
    /// ```
    ///
    /// # Errors
    /// [`SettingsError::UnknownKey`], [`SettingsError::BadValue`]; the settings stay as they were.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), SettingsError> {
        let row = ROWS.iter().find(|row| row.key == key);
        let row = row.ok_or_else(|| SettingsError::UnknownKey { key: key.to_owned() })?;
        (row.set)(self, value).map_err(|expected| SettingsError::BadValue {
            key: row.key,
            value: value.to_owned(),
            expected,
        })
    }

    /// All settings in force, by name.
    pub fn to_json(&self) -> Map<String, Value> {
        ROWS.iter().map(|row| (row.key.to_owned(), (row.get)(self))).collect()
    }

    /// How radiance becomes a PNG.
    pub fn tone_mapping(&self) -> ToneMapping {
        ToneMapping { exposure: self.image_exposure, curve: self.image_tonemap }
    }

    /// Whether whole paths go into the film, without a cache and without a filter.
    pub fn is_plain(&self) -> bool {
        self.cache == CacheKind::None && self.filter == FilterKind::None
    }

    /// Whether cached light fades from frame to frame.
    pub(crate) fn fades(&self) -> bool {
        self.cache == CacheKind::Grid && self.grid_history > 0
    }

    /// Whether a frame keeps anything beside its radiance that pictures could be made of.
    pub fn has_aovs(&self) -> bool {
        !self.is_plain() || self.path_moments == Moments::On || self.check_fraction > 0.0
    }

    /// Checks what single values cannot show.
    ///
    /// # Errors
    /// [`SettingsError::Conflict`].
    pub fn validate(&self) -> Result<(), SettingsError> {
        if self.launcher == Launcher::Serial && self.threads > 1 {
            let mut second = String::new();
            let _ = write!(second, "threads={}", self.threads);
            return Err(SettingsError::Conflict {
                first: "cpu.launcher=serial".into(),
                second,
                instead: "use cpu.launcher=rayon, or threads=1".into(),
            });
        }
        let default = Self::default();
        let fills_otherwise = self.store != default.store || self.crf.to_bits() != default.crf.to_bits();
        if self.cache == CacheKind::None && fills_otherwise {
            return Err(SettingsError::Conflict {
                first: "cache.store or cache.crf".into(),
                second: "cache=none".into(),
                instead: "without a cache each pixel keeps its paths' first vertices: leave them out".into(),
            });
        }
        if self.path_moments == Moments::On && !self.is_plain() {
            let (first, second) = if self.cache == CacheKind::None {
                ("filter", self.filter.name())
            } else {
                ("cache", self.cache.name())
            };
            return Err(SettingsError::Conflict {
                first: "path.moments=on".into(),
                second: format!("{first}={second}"),
                instead: "leave it out: what the filter adds up tells its pixels' errors already".into(),
            });
        }
        if self.cache == CacheKind::None && self.direct == DirectLight::Traced {
            return Err(SettingsError::Conflict {
                first: "cache.direct=traced".into(),
                second: "cache=none".into(),
                instead: "without a cache all light is traced: leave cache.direct out".into(),
            });
        }
        Ok(())
    }
}
