//! What can be wrong with an octree or with building one.

use core::fmt;

use crate::error::ParamError;

/// Why words are no octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OctreeError {
    /// Fewer words than the header says, or than a header has.
    TooShort {
        /// Words given.
        words: u64,
        /// Words needed.
        needed: u64,
    },
    /// The header is none, or its numbers contradict each other.
    Header,
    /// A level's record contradicts the header.
    Level {
        /// The level.
        level: u32,
    },
    /// A map's table lies outside the words.
    Map {
        /// The map.
        map: u32,
    },
}

impl fmt::Display for OctreeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooShort { words, needed } => write!(f, "octree: {words} words given, {needed} are needed"),
            Self::Header => write!(f, "octree: the header is not sound"),
            Self::Level { level } => write!(f, "octree: the record of level {level} is not sound"),
            Self::Map { map } => write!(f, "octree: the table of map {map} lies outside"),
        }
    }
}

impl core::error::Error for OctreeError {}

/// Why an octree could not be built.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// A setting is outside its range.
    Param(ParamError),
    /// No triangle has finite corners.
    Empty,
    /// It would not fit.
    TooLarge {
        /// Bytes that tables, normals and data would take; an estimate when counting was stopped early.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// More triangles or cells than 32 bits count.
    TooMany,
}

impl From<ParamError> for BuildError {
    fn from(error: ParamError) -> Self {
        Self::Param(error)
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Param(error) => write!(f, "octree: {error}"),
            Self::Empty => write!(f, "octree: the scene has no triangle with finite corners"),
            Self::TooLarge { needed, limit } => {
                write!(f, "octree: {needed} bytes are needed, {limit} are allowed")
            }
            Self::TooMany => write!(f, "octree: more triangles or cells than 32 bits count"),
        }
    }
}

impl core::error::Error for BuildError {}
