//! What can be wrong with opacity masks.

use core::fmt;

/// Why lists of opacity masks do not fit together: names and numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OpacityError {
    /// A list has another length than there are triangles.
    Length {
        /// The list.
        list: &'static str,
        /// Its length.
        found: u64,
        /// The number of triangles.
        expected: u64,
    },
    /// An index points beyond its list.
    Index {
        /// What holds the index.
        at: &'static str,
        /// Which one of them.
        element: u64,
        /// The index found.
        index: u64,
        /// Length of the list it points into.
        length: u64,
    },
    /// An image without area, or with a side of 2³⁰ or more.
    Size {
        /// Which mask.
        mask: u64,
        /// Values a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A number is NaN or infinite.
    Number {
        /// What holds the number.
        at: &'static str,
        /// Which one of them.
        element: u64,
    },
}

impl fmt::Display for OpacityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Length { list, found, expected } => write!(f, "{list}: {found} entries, {expected} expected"),
            Self::Index { at, element, index, length } => {
                write!(f, "{at} {element}: index {index} is beyond the end ({length})")
            }
            Self::Size { mask, width, height } => write!(f, "mask {mask}: an image of {width}×{height}"),
            Self::Number { at, element } => write!(f, "{at} {element}: a number is not finite"),
        }
    }
}

impl core::error::Error for OpacityError {}
