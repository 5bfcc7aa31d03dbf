//! How far paths go.

/// Limits of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathSettings {
    /// Surface scatterings at most, so one path segment more. 0: only emission seen directly.
    pub max_bounces: u32,
    /// Scattering from which on a path may end by chance: it goes on with probability min(throughput, 0.95), the
    /// throughput being its largest channel with this scattering's albedo. [`PathSettings::NO_ROULETTE`]: never.
    pub roulette_depth: u32,
}

impl PathSettings {
    /// `roulette_depth` of paths that never end by chance.
    pub const NO_ROULETTE: u32 = u32::MAX;
    /// Largest probability of going on under roulette: even in a white room paths end. Mitsuba's value.
    pub const LARGEST_SURVIVAL: f32 = 0.95;
}

impl Default for PathSettings {
    /// Eight scatterings, no roulette.
    fn default() -> Self {
        Self { max_bounces: 8, roulette_depth: Self::NO_ROULETTE }
    }
}

/// Limits of a path whose first vertices are kept, each with the light that arrives at it.
///
/// # Deviation
/// Roulette goes by the throughput behind the last vertex that is kept, not from the camera: a dark surface's
/// illumination is as bright as a white one's, and a cache shares it with white ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexSettings {
    /// Limits as for whole paths. `max_bounces` counts from each kept vertex on, its own scattering included, so that
    /// all hold the same: with s vertices kept a path scatters up to s − 1 times more often, and up to `max_bounces` − 1
    /// times by mirrors and glass before the first. 0: no vertex.
    pub path: PathSettings,
    /// Further scatterings at most through which light comes to a kept vertex; no more than `max_bounces − 1`
    /// in any case.
    pub length: u32,
}

impl VertexSettings {
    /// Each vertex holds all the light that `path` lets a pixel's first vertex hold.
    pub const fn new(path: PathSettings) -> Self {
        Self { path, length: u32::MAX }
    }

    /// Scatterings behind a kept vertex.
    #[inline]
    pub(crate) const fn further(&self) -> u32 {
        let most = self.path.max_bounces.saturating_sub(1);
        if self.length < most { self.length } else { most }
    }
}
