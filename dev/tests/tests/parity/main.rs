//! WGSL and Rust on equal inputs, tier by tier: integers give equal bits; + − × ÷ √ stay within stated bounds.
//! Everything is compared on the GPU of this machine, with outputs pre-filled with poison.

mod core;
mod grid;
mod keys;
mod octree;
mod octree_data;
mod points;
mod sampler;
