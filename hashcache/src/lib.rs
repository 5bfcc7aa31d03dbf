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
//! - [`Needs`]: what a scene requires. [`FramePlan`]: needs and settings as stages in order, each with its reason.
//! - [`Preview`]: a loaded scene with its plan. [`Preview::render`] runs it on the launcher that the settings name,
//!   [`Preview::render_on`] on any backend that casts rays.
//! - [`Stats`]: what it took, in the JSON form that scripts rely on.
//!
//! # Features
//! `cpu` (default): the serial and rayon launchers. Without it, bring a backend.
//!
//! # Memory
//! Beside the scene: 32 bytes a pixel of film, 16 of radiance; with the grid 96 of records, 32 of estimates (for the
//! largest batch) and 64 a slot of the table, by default one slot a pixel rounded up to a power of two. 512×512: 59 MB.
//!
//! # Determinism
//! Same scene, settings and seed: the same bits, for any number of threads and either launcher.
//!
//! # Limits today
//! One still picture; Lambertian surfaces; the grid at the first vertex; no filter.
//!
//! # Sources
//! Binder et al. 2021 (path space filtering in a hash table).
#![forbid(unsafe_code)]

pub mod choice;
pub mod clock;
mod error;
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

pub use error::Error;
pub use image_file::Image;
pub use needs::{Needs, needs};
pub use plan::{FramePlan, Stage};
pub use preview::{Preview, Progress, Rendered};
pub use scene;
pub use session::{FrameOutput, Session};
pub use settings::{MAX_BOUNCES, MAX_SIDE, MAX_SPP, Settings, SettingsError};
pub use stats::{CacheStats, EnergyBalance, LevelStats, Rays, Stats, Times};

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}
