//! Emitters: which one to sample, where on it, and with which density.

mod alias;
#[cfg(feature = "alloc")]
mod candidate;
mod environment;
#[cfg(feature = "alloc")]
mod environment_build;
#[cfg(feature = "alloc")]
mod footprint;
#[cfg(feature = "alloc")]
mod list;
mod meeting;
mod punctual;
mod sample;
#[cfg(feature = "alloc")]
mod shares;
mod triangle;

#[cfg(feature = "alloc")]
pub use alias::build_alias;
pub use alias::{AliasEntry, pick_alias};
pub use environment::{EnvironmentSample, EnvironmentView, guide_buckets};
#[cfg(feature = "alloc")]
pub use environment_build::EnvironmentTables;
#[cfg(feature = "alloc")]
pub use list::LightList;
pub use meeting::{MAX_TRIED, may_meet_emitter};
pub use sample::{LightSample, sample_light};
pub use triangle::{TriangleLight, triangle_density};

use glam::Vec3;

/// Luminance of linear Rec. 709 (ITU-R BT.709-6, item 3.2): what emitters are weighed by. Above 0 for every colour
/// that is not black.
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
