//! Serial and rayon launchers of hashcache kernels, and ray casting on the CPU.

pub mod rays;
