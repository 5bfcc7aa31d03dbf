//! A choice among many by weight in constant time.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

/// One column of an alias table. 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AliasEntry {
    /// Share of the column that stands for its own index, in `[0, 1]`.
    pub own: f32,
    /// Index that the rest of the column stands for.
    pub other: u32,
}

/// Chooses an index with the probability the table was built for. The table must not be empty.
///
/// The column comes from `u.x`, the side from `u.y`: the parts of one number would not do, since 24 bits are soon used
/// up by the column of a large table.
#[inline]
pub fn pick_alias(table: &[AliasEntry], u: Vec2) -> u32 {
    let column = ((u.x * table.len() as f32) as usize).min(table.len() - 1);
    let entry = table[column];
    if u.y < entry.own { column as u32 } else { entry.other }
}

/// The alias table of `weights`: index i is chosen with probability `weights[i] / Σ weights`.
///
/// Weights must be finite and not negative. An index of weight 0 is never chosen, unless all weights are 0: then all
/// are equal.
///
/// # Source
/// Vose 1991.
#[cfg(feature = "alloc")]
pub fn build_alias(weights: &[f64]) -> alloc::vec::Vec<AliasEntry> {
    use alloc::vec::Vec;

    let total: f64 = weights.iter().sum();
    let scale = if total > 0.0 { weights.len() as f64 / total } else { 0.0 };
    let mut share: Vec<f64> = weights.iter().map(|w| if total > 0.0 { w * scale } else { 1.0 }).collect();
    let mut table: Vec<AliasEntry> = (0..weights.len()).map(|i| AliasEntry { own: 1.0, other: i as u32 }).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..weights.len()).partition(|&i| share[i] < 1.0);
    while let Some(&l) = large.last() {
        let Some(s) = small.pop() else { break };
        table[s] = AliasEntry { own: share[s] as f32, other: l as u32 };
        share[l] -= 1.0 - share[s];
        if share[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    // What is left has a share of 1 but for rounding. A weight of 0 must not profit from that.
    let largest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
    for s in small {
        if total > 0.0 && weights[s] == 0.0 {
            table[s] = AliasEntry { own: 0.0, other: largest as u32 };
        }
    }
    table
}
