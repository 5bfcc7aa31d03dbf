//! Global-illumination caching for interactive previews: from a glTF file to a picture, and how it came about.
//!
//! ```
//! use hashcache::{Preview, Settings};
//! let mut settings = Settings::default();
//! settings.set("size", "48x48")?;
//! let preview = Preview::open("builtin:furnace", &settings)?;
//! let rendered = preview.render(&mut |_| ())?;
//! assert_eq!(rendered.image.pixels.len(), 48 * 48);
//! # Ok::<(), hashcache::Error>(())
//! ```
//!
//! # Concepts
//! - [`Settings`]: every knob by its dotted name; [`Settings::set`] takes what `--set` takes.
//! - [`Needs`]: what a scene requires. [`FramePlan`]: needs and settings as stages in order, each with its reason, and
//!   what is left out because the scene does without.
//! - [`Preview`]: a loaded scene with its plan. [`Preview::render`] runs it on the launcher that the settings name,
//!   [`Preview::render_on`] on any backend that casts rays.
//! - [`Session`]: frames that share the scene's buffers, the cache and, while the camera rests, the pixels' sums.
//! - [`Stats`]: what it took, in the JSON form that scripts rely on; with [`StderrStats`] and, on demand, [`CheckStats`]:
//!   how wrong the picture is.
//!
//! # Features
//! `cpu` (default): the serial and rayon launchers. Without it, bring a backend.
//!
//! # Memory
//! Beside the scene, a pixel: 32 bytes of film, 48 with `path.moments`; 96 a pixel that is checked; with a cache or a
//! filter also
//! - 96 of records a stored vertex of its path; 2¹⁹ records at most, except where the paths are shown themselves: without
//!   a cache, and in scenes without gloss at `cache.crf` 1;
//! - 128 of a vertex that is only looked at and its estimate, a layer; for 2¹⁹ vertices at most;
//! - 256 of sums, guides and light, 272 with direct light apart; 133 to 240 more for each further layer behind mirrors and
//!   glass.
//!
//! The octree: about 54 bytes a cell (48 of light, 4 of normal, 1.4 to 3.4 of tables), 1 GiB at most by default, and 56 a
//! stored vertex of an open frame; the grid: 64 a slot, by default one slot a pixel rounded up to a power of two. [`Stats`]
//! has the figures of a run.
//!
//! # Determinism
//! Same scene, settings and seed: the same bits, for any number of threads and either launcher.
//!
//! # Limits today
//! Without a cache a path keeps one vertex, so the filter has one layer; the grid keeps all cells of a move until it is
//! full.
//!
//! # Sources
//! Roth et al. 2020 (octree, reconstruction, layered filter); Binder et al. 2021 (path space filtering in a hash table);
//! Cochran 1977, Horvitz & Thompson 1952, Satterthwaite 1946 (errors by a sample of pixels).
#![forbid(unsafe_code)]

mod accuracy;
pub mod choice;
pub mod clock;
mod emission;
mod error;
pub mod feature;
mod filter;
mod grid;
pub mod image_file;
mod needs;
mod octree;
mod pipeline;
mod plan;
mod preview;
mod session;
mod settings;
mod stats;
mod tone;

pub use accuracy::{CheckStats, Interval, StderrStats};
pub use error::Error;
pub use feature::{Feature, FeatureSet, Saving};
pub use image_file::Image;
pub use needs::{Needs, environment, needs};
pub use plan::{FramePlan, Stage};
pub use preview::{Preview, Progress, Rendered};
pub use scene;
pub use session::{FrameOutput, Session};
pub use settings::{MAX_BOUNCES, MAX_RESOLUTION, MAX_SIDE, MAX_SPP, Settings, SettingsError};
pub use stats::{CacheStats, EnergyBalance, LevelStats, Rays, Stats, Times};
pub use tone::{ToneMapping, srgb_decode, srgb_encode};

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}
