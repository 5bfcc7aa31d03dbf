//! Ray casting on the CPU.
//!
//! [`CpuScene`] holds the scene's triangles in hierarchies of eight boxes a node and eight triangles a leaf
//! (`layout`). A ray (`ray`) tests the eight boxes of a node together (`traverse`), then the
//! eight triangles of a leaf (`triangle`), in the processor's widest lanes (`lanes`). Meshes placed once are copied into
//! the scene's space; the others are reached through a second hierarchy (`instance`). Triangles may have holes (`holes`);
//! a scene without runs code without.

mod build;
mod collapse;
mod holes;
mod input;
mod instance;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_avx2;
mod layout;
mod mesh;
mod ray;
mod scene;
mod stack;
mod traverse;
mod triangle;

pub use scene::{CpuScene, Stats};
