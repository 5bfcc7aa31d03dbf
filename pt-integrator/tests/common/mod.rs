//! What several tests need: a ray caster that tries every triangle, small scenes, and a chi-squared test.
#![allow(clippy::disallowed_methods, reason = "scenes come from the platform's functions")]
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod caster;
pub mod chi2;
pub mod mixed;
pub mod scenes;
