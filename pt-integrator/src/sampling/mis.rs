//! Weights for estimates that two strategies share.

/// Weight of a sample drawn with density `own` when another strategy would have drawn it with density `other`: power
/// heuristic, β = 2. Weights of the two strategies add up to 1. 0 when `own` is 0; no square overflows.
///
/// # Source
/// Veach 1997, eq. 9.13.
///
/// ```
/// use pt_integrator::sampling::power_heuristic;
/// assert_eq!(power_heuristic(1.0, 3.0), 0.1);
/// assert_eq!(power_heuristic(1e30, 0.0), 1.0);
/// ```
#[inline]
pub fn power_heuristic(own: f32, other: f32) -> f32 {
    if own <= 0.0 {
        return 0.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
