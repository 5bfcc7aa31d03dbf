//! wgpu launcher of hashcache kernels.
