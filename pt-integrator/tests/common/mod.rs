//! What several tests need: a ray caster that tries every triangle, small scenes, and a chi-squared test.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod caster;
pub mod chi2;
pub mod scenes;
