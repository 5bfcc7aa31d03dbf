//! What can be wrong with a scene.

use core::fmt;

use hashcache_core::geometry::OpacityError;

/// Why a scene's lists do not fit together: names and numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneError {
    /// An index points beyond its list.
    Index {
        /// What holds the index.
        at: &'static str,
        /// Which one of them.
        element: u32,
        /// The index found.
        index: u32,
        /// Length of the list it points into.
        length: u32,
    },
    /// A list has another length than it must have.
    Length {
        /// The list.
        list: &'static str,
        /// Its length.
        found: u64,
        /// The length expected.
        expected: u64,
    },
    /// A list is longer than its indices can say or a binding can hold.
    TooLarge {
        /// The list.
        list: &'static str,
        /// Its length.
        found: u64,
        /// The largest length possible.
        limit: u64,
    },
    /// A number is NaN or infinite, or negative where light and albedo cannot be.
    Number {
        /// What holds the number.
        at: &'static str,
        /// Which one of them.
        element: u32,
    },
    /// The lists of holes do not fit together.
    Opacity(OpacityError),
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Index { at, element, index, length } => {
                write!(f, "{at} {element}: index {index} is beyond the end ({length})")
            }
            Self::Length { list, found, expected } => write!(f, "{list}: {found} entries, {expected} expected"),
            Self::TooLarge { list, found, limit } => write!(f, "{list}: {found} entries, at most {limit} are possible"),
            Self::Number { at, element } => write!(f, "{at} {element}: a number is not finite or is negative"),
            Self::Opacity(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for SceneError {}
