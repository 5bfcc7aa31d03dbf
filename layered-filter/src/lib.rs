//! Filters for noisy or cached illumination: pixels that show like surfaces share their light, bounce by bounce.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod atrous;
pub mod bilateral;
pub mod denoiser;
pub mod fill;
pub mod guide;
pub mod image;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub mod kernels;
pub mod lab;
pub mod layers;
pub mod log;
mod mean;
pub mod pixel;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
mod stages;
pub mod weights;

pub use atrous::{ATrous, Taps};
pub use bilateral::CrossBilateral;
pub use denoiser::{Denoiser, filter, filter_pixels};
pub use guide::{GuideRecord, GuideScale, PreparedGuide};
pub use image::{HOLE, Light, View};
pub use layers::{Layer, Scratch, compose_layers, compose_screen};
pub use pixel::{Direct, GatherParams, LayerPixel};
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub use stages::{Filter, FilterSettings, FilterStages};
pub use weights::{LuminanceWeight, WeightSettings, Weights};
