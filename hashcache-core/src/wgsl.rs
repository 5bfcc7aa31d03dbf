//! The WGSL twins of this crate's functions, as text.
//!
//! Every module in [`ALL`] stands alone; concatenate the ones a shader needs, in any order. They are pure functions, structs and
//! constants with the prefix `hc_` (`Hc`, `HC_`), without bindings or entry points. A `u64` is a `vec2<u32>`, low
//! word first; an array of `u32` is a vector.
//!
//! ```
//! # use hashcache_core::wgsl;
//! let shader = [wgsl::HASH, "fn seed(pixel: vec2<u32>) -> u32 { return hc_pcg2d(pixel).x; }"].concat();
//! assert!(shader.contains("fn hc_pcg2d"));
//! ```

/// Twins of [`crate::hash`].
pub const HASH: &str = include_str!("../wgsl/hash.wgsl");

/// Twins of [`crate::jitter`].
pub const JITTER: &str = include_str!("../wgsl/jitter.wgsl");

/// Twins of [`crate::pack`].
pub const PACK: &str = include_str!("../wgsl/pack.wgsl");

/// Twins of [`crate::level`].
pub const LEVEL: &str = include_str!("../wgsl/level.wgsl");

/// Twins of [`crate::exact`].
pub const EXACT: &str = include_str!("../wgsl/exact.wgsl");

/// Word indices of [`crate::counters::Counters`].
pub const COUNTERS: &str = include_str!("../wgsl/counters.wgsl");

/// `HcVertexRecord` and `HcEstimateRecord`: the layouts of [`crate::record::VertexRecord`] and
/// [`crate::stages::EstimateRecord`].
pub const RECORD: &str = include_str!("../wgsl/record.wgsl");

/// Twins of the lookups of [`crate::octree`]; needs [`HASH`] and the global of [`OCTREE_BINDINGS`].
pub const OCTREE: &str = include_str!("../wgsl/octree.wgsl");

/// The global that holds an octree's words, at binding 0; replace it to embed [`OCTREE`] elsewhere.
pub const OCTREE_BINDINGS: &str = include_str!("../wgsl/octree_bindings.wgsl");

/// All that stand alone.
pub const ALL: [&str; 7] = [HASH, JITTER, PACK, LEVEL, EXACT, COUNTERS, RECORD];
