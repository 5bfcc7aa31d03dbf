//! A scene as bytes: three buffers that kernels read, laid out alike on the host and on a GPU.
//!
//! | buffer | content |
//! |---|---|
//! | triangles | one [`SceneTriangle`] (80 bytes) for each triangle of the scene, in its order |
//! | scene | [`SceneHeader`] and the sections it points to, each on a multiple of 16 bytes |
//! | texels | texels of all textures; one word when there are none |

mod header;
#[cfg(feature = "alloc")]
mod scene;
mod triangle;

pub use header::{SceneHeader, Section};
#[cfg(feature = "alloc")]
pub use scene::PackedScene;
pub use triangle::{PackedVertex, SceneInstance, SceneTriangle};
