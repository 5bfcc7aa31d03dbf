//! What is rendered: surfaces, materials, textures, lights, cameras, environment.
//!
//! [`SceneData`] (feature `alloc`) owns a scene as a loader builds it. `packed::PackedScene` packs it
//! into buffers, and [`SceneView`](crate::view::SceneView) borrows those: it is what path tracing reads.

mod camera;
#[cfg(feature = "alloc")]
mod data;
#[cfg(feature = "alloc")]
mod environment;
#[cfg(feature = "alloc")]
mod error;
mod material;
mod needs;
#[cfg(feature = "alloc")]
mod opacity;
mod punctual;
mod shading;
mod texture;
#[cfg(feature = "alloc")]
mod validate;

pub use camera::{Camera, CameraError};
#[cfg(feature = "alloc")]
pub use data::SceneData;
#[cfg(feature = "alloc")]
pub use environment::{Environment, EnvironmentImage};
#[cfg(feature = "alloc")]
pub use error::SceneError;
pub use material::{Lobes, Material};
pub use needs::Needs;
#[cfg(feature = "alloc")]
pub use opacity::OpacityData;
pub use punctual::PunctualLight;
pub use shading::TriangleShading;
pub use texture::{Texture, Wrap};

/// An index that points at nothing.
pub const NONE: u32 = u32::MAX;
