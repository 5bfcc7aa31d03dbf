//! Suites that span crates.

pub mod conformance;
