//! Suites that span crates.

pub mod conformance;
pub mod gpu;
pub mod vertices;
