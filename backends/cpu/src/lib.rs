//! Serial and rayon launchers of hashcache kernels, and ray casting on the CPU.

mod backend;
mod launch;
mod primitives;
mod storage;

pub mod rays;

pub use backend::CpuBackend;
