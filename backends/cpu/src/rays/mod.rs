//! Ray casting on the CPU.

mod scene;

pub use scene::CpuScene;
