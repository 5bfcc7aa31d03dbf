//! Pearson's chi-squared test.

/// Compares counts with expected counts; cells expecting fewer than five samples are pooled. Panics when the counts
/// are less likely than one in a million under the expectation.
///
/// The threshold is a bound, not a quantile table: chi-squared with k degrees of freedom exceeds
/// k + 2·√(k·x) + 2·x with probability at most e⁻ˣ (Laurent & Massart 2000, lemma 1).
pub fn check(what: &str, counts: &[u64], expected: &[f64]) {
    assert_eq!(counts.len(), expected.len());
    let (mut statistic, mut cells) = (0.0, 0.0);
    let (mut pooled_count, mut pooled_expected) = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected < 5.0 {
            assert!(expected > 0.0 || count == 0, "{what}: {count} samples where the density is 0");
            pooled_count += count as f64;
            pooled_expected += expected;
        } else {
            statistic += (count as f64 - expected).powi(2) / expected;
            cells += 1.0;
        }
    }
    if pooled_expected >= 5.0 {
        statistic += (pooled_count - pooled_expected).powi(2) / pooled_expected;
        cells += 1.0;
    }
    let freedom: f64 = cells - 1.0;
    let x = 1e6_f64.ln();
    let bound = freedom + 2.0 * (freedom * x).sqrt() + 2.0 * x;
    assert!(statistic < bound, "{what}: chi-squared {statistic} of {freedom} degrees of freedom is above {bound}");
}
