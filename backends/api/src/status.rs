//! The word by which a dispatch tells what happened to it.

/// Flags of one dispatch. A dispatch starts as [`Status::NOT_RUN`]; a launch that ran clears that flag, so work that
/// never happened cannot pass for a buffer of zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(u32);

impl Status {
    /// Ran, nothing to tell.
    pub const OK: Self = Self(0);
    /// A table had no room for a key.
    pub const TABLE_FULL: Self = Self(1);
    /// A value was NaN or infinite and was left out.
    pub const NON_FINITE: Self = Self(1 << 1);
    /// A sum or count reached its bound.
    pub const OVERFLOW: Self = Self(1 << 2);
    /// No launch has run.
    pub const NOT_RUN: Self = Self(1 << 31);

    /// The word as stored.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// A status from a stored word.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Whether every flag of `other` is raised.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The flags of both.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
