//! How much of what a cell holds stays when a frame's light is added: rules, as types.
//!
//! A rule names the *weight* that the history keeps, in deposits: the history's sums are scaled to it ([`Sums::part`])
//! and the frame's are added, so the mean becomes α·old + (1 − α)·new with α = weight/(weight + new deposits). All rules
//! are this one operation, in integers, and no rule makes more of the history than it was. [`crate::merge`] applies
//! a rule to whole tables.
//!
//! | rule | weight of `old` deposits beside `new` ones |
//! |---|---|
//! | [`Integrate`] | `old` |
//! | [`FixedCount`] | `old`, at most a count |
//! | [`MovingAverage`] | `new`·α/(1 − α), at most `old` |
//! | [`Adaptive`] | between 0 and `old`, by what re-evaluated paths tell |
//!
//! Weights are whole deposits, to the nearest: with few deposits a frame, α is as coarse as that.
//!
//! # Source
//! Binder et al. 2021, section 3.4.1.
//!
//! # Limits today
//! Rust only: shares of 64-bit sums need divisions of 96 bits, which WGSL lacks.

use core::ops::Range;

use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::exact::MAX_DEPOSITS;
use hashcache_core::record::VertexRecord;

use crate::layout::Layout;
use crate::params::Params;
use crate::sums::{Sums, luminance};
use crate::table::Table;
use crate::vertex::{key_of_deposit, quantize_vertex};

/// What re-evaluated paths tell of a cell: sums over those that fell into it.
///
/// # Units
/// Luminance in quanta, as [`luminance`]/256.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Σ |light now − light before|.
    pub difference: u64,
    /// Σ max(light now, light before).
    pub magnitude: u64,
}

impl Change {
    /// One path, whose luminance was `before` and is `now` with the same random numbers.
    ///
    /// # Units
    /// 256ths of a quantum, as [`luminance`].
    #[must_use]
    pub const fn of(before: u64, now: u64) -> Self {
        let larger = if before > now { before } else { now };
        Self { difference: (before.abs_diff(now) + 128) >> 8, magnitude: (larger + 128) >> 8 }
    }

    /// difference/magnitude in 65536ths: 0 nothing changed (or nothing is known), 65536 everything.
    #[must_use]
    pub const fn share(self) -> u32 {
        if self.difference == 0 {
            return 0;
        }
        if self.difference >= self.magnitude {
            return 1 << 16;
        }
        (((self.difference as u128) << 16) / self.magnitude as u128) as u32
    }
}

/// What the history weighs beside a frame's deposits.
///
/// # Laws
/// `weight(old, …) ≤ old`: the history is never made more of.
pub trait Rule {
    /// The weight that `old` deposits keep beside `new` ones, when re-evaluated paths told `change`.
    fn weight(&self, old: u32, new: u32, change: Change) -> u32;

    /// History and frame in one. At most [`MAX_DEPOSITS`] deposits remain: more history than fits is scaled down.
    fn blend(&self, old: &Sums, new: &Sums, change: Change) -> Sums {
        let weight = self.weight(old.count, new.count, change).min(old.count);
        let room = MAX_DEPOSITS.saturating_sub(new.count);
        old.part(weight.min(room)).plus(new)
    }
}

/// True integration: every deposit of all frames weighs the same. For scenes that do not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Integrate;

impl Rule for Integrate {
    #[inline]
    fn weight(&self, old: u32, _: u32, _: Change) -> u32 {
        old
    }
}

/// Integration up to a count of deposits; from then on the history weighs that many. With n new deposits a frame, a step
/// in the light fades by count/(count + n) a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedCount {
    /// Most deposits that the history weighs.
    pub most: u32,
}

impl Rule for FixedCount {
    #[inline]
    fn weight(&self, old: u32, _: u32, _: Change) -> u32 {
        old.min(self.most)
    }
}

/// Scales what cells hold to at most `most` deposits, before a frame deposits into them: [`FixedCount`] without a frame's
/// table of its own. Each cell on its own, so that any number of threads may take parts.
///
/// # Panics
/// For slots beyond the table.
pub fn fade_cells<L: Layout>(table: &Table<'_, L>, slots: Range<u32>, most: u32) {
    for slot in slots {
        let sums = table.sums(slot);
        if sums.count > most {
            table.set_sums(slot, &sums.part(most));
        }
    }
}

/// Exponential moving average: the history keeps the share α whatever the number of new deposits, so that a step in the
/// light fades by α a frame.
///
/// # Deviation
/// While a cell has less history than that share would take, the rule integrates; the plain formula would give the
/// first frame's few samples the weight of many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovingAverage {
    keep: u32,
}

impl MovingAverage {
    /// An average that keeps `alpha` of the history, 0 to 0.9999 in 65536ths.
    ///
    /// # Errors
    /// [`ParamError`] outside that range.
    ///
    /// ```
    /// use hashgrid::temporal::{Change, MovingAverage, Rule};
    /// let rule = MovingAverage::new(0.75)?;
    /// assert_eq!(rule.weight(1000, 10, Change::default()), 30); // 30/(30 + 10) = 0.75
    /// # Ok::<(), hashcache_core::error::ParamError>(())
    /// ```
    pub fn new(alpha: f32) -> Result<Self, ParamError> {
        ParamError::check_range("alpha", f64::from(alpha), 0.0, 0.9999)?;
        Ok(Self { keep: (alpha * 65_536.0 + 0.5) as u32 })
    }
}

impl Rule for MovingAverage {
    #[inline]
    fn weight(&self, old: u32, new: u32, _: Change) -> u32 {
        if new == 0 {
            return old;
        }
        let rest = u64::from(65_536 - self.keep);
        ((u64::from(new) * u64::from(self.keep) + rest / 2) / rest).min(u64::from(old)) as u32
    }
}

/// Integration where nothing changed, nothing of the history where everything did: α blends from old/(old + new) to 0
/// with the share of light that re-evaluated paths saw change.
///
/// # Source
/// Binder et al. 2021, figure 9; Schied et al. 2018 for the gradient's normalisation by the larger of both values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Adaptive {
    /// How many times the [share](Change::share) of changed light counts, up to all of it. 1 follows the share; more
    /// lets a small change in many paths wipe a cell sooner.
    pub gain: u32,
    /// Most deposits that the history weighs, as in [`FixedCount`]; [`MAX_DEPOSITS`] for none.
    pub most: u32,
}

impl Rule for Adaptive {
    #[inline]
    fn weight(&self, old: u32, new: u32, change: Change) -> u32 {
        let lambda = u64::from(change.share()).saturating_mul(u64::from(self.gain)).min(65_536);
        let old = u64::from(old.min(self.most));
        let keep = 65_536 - lambda;
        if lambda == 0 || old == 0 {
            return old as u32;
        }
        if new == 0 {
            return ((old * keep + 32_768) >> 16) as u32;
        }
        // weight/(weight + new) = keep·old/(old + new), solved for weight.
        let (new, below) = (u64::from(new), (u64::from(new) << 16) + lambda * old);
        ((u128::from(new * old) * u128::from(keep) + u128::from(below / 2)) / u128::from(below)) as u32
    }
}

/// Adds what re-evaluated paths tell to the cells of a frame, between its claims and its merge: `before[i]` and `now[i]`
/// are one path traced with the same random numbers in the last and in this frame. Paths whose cell nobody claimed tell
/// nothing, and count as refusals.
///
/// Any number of threads may add parts of the same paths.
pub fn change_vertices<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    before: &[VertexRecord],
    now: &[VertexRecord],
    counters: &mut Counters,
) {
    let light = |vertex: &VertexRecord| luminance(&quantize_vertex(params, vertex).map(|channel| channel.value));
    for (before, now) in before.iter().zip(now).filter(|(before, now)| before.is_recordable() && now.is_recordable()) {
        let found = key_of_deposit(params, now).and_then(|key| table.find_named(&key));
        match found {
            Some(slot) => table.add_change(slot, Change::of(light(before), light(now))),
            None => counters.refusals += 1,
        }
    }
}
