//! Ray casting on the CPU.

mod build;
mod collapse;
mod instance;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes_avx2;
mod layout;
mod mesh;
mod scene;
mod segment;
mod stack;
mod traverse;
mod triangle;

pub use scene::{CpuScene, Stats};
