//! The WGSL twins of this crate's functions, as text.
//!
//! Pure functions with the prefix `pt_`, without bindings or entry points.
//!
//! ```
//! let shader = [hashcache_core::wgsl::HASH, pt_integrator::wgsl::SAMPLER].concat();
//! assert!(shader.contains("fn pt_sobol_point"));
//! ```

/// Twins of [`crate::sampler`]; needs `hashcache_core::wgsl::HASH`.
pub const SAMPLER: &str = include_str!("../wgsl/sampler.wgsl");
