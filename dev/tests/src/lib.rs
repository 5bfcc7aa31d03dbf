//! Suites that span crates.

pub mod conformance;
pub mod gpu;
pub mod harness;
pub mod vertices;
