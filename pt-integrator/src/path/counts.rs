//! What tracing did.

/// Numbers of rays and paths; add them up over a launch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays that asked for the nearest hit.
    pub closest: u64,
    /// Connections whose visibility mattered.
    pub shadow_asked: u64,
    /// Of these, the ones that were traced.
    pub shadow_traced: u64,
    /// Paths.
    pub paths: u64,
    /// Paths that were dropped because their radiance was NaN or infinite.
    pub non_finite: u64,
}

impl RayCounts {
    /// Number of counters.
    pub const WORDS: usize = 5;

    /// The counters in the order of their declaration.
    pub const fn to_words(self) -> [u64; Self::WORDS] {
        [self.closest, self.shadow_asked, self.shadow_traced, self.paths, self.non_finite]
    }

    /// Counters from [`RayCounts::to_words`].
    pub const fn from_words(words: [u64; Self::WORDS]) -> Self {
        let [closest, shadow_asked, shadow_traced, paths, non_finite] = words;
        Self { closest, shadow_asked, shadow_traced, paths, non_finite }
    }
}
