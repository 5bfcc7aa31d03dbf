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
