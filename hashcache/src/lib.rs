//! Global-illumination caching for interactive previews: from a glTF file to a picture, and how it came about.
#![forbid(unsafe_code)]

pub mod choice;
pub mod clock;
mod error;
mod grid;
pub mod image_file;
mod needs;
mod pipeline;
mod plan;
mod preview;
mod settings;
mod stats;

pub use error::Error;
pub use image_file::Image;
pub use needs::{Needs, needs};
pub use plan::{FramePlan, Stage};
pub use preview::{Preview, Progress, Rendered};
pub use scene;
pub use settings::{MAX_BOUNCES, MAX_SIDE, MAX_SPP, Settings, SettingsError};
pub use stats::{CacheStats, EnergyBalance, LevelStats, Rays, Stats, Times};
