//! Forgetting between frames: cells of the lowest priority leave the table, and their light goes into the coarser cell
//! around them.
//!
//! A cell's *rank* is its priority in the upper 6 bits and a hash of its key below: among equal priorities, eviction is
//! spread evenly over the scene and depends on the keys only. Lower ranks leave first. [`evict`] brings the number of
//! cells down to a target in four steps: cells without deposits leave; the ranks' histogram tells the rank to cut
//! at; cells up to it are marked; and each marked cell is [removed](Table::remove) and its sums added to the cell of the
//! next coarser level, which is made where there is none (or to one above, where there is no room for it). So one call
//! may leave more cells than the target, and later ones go on.
//!
//! *Energy before = energy after + lost*, to the last quantum. Lost is what had no coarser level or found no room there.
//!
//! # Source
//! Binder et al. 2021, section 3.4.3 (priorities above hash bits), section 5 (accumulating at a coarser level).
//!
//! # Deviation
//! The paper lets a claim's atomicMin evict. Here priorities stay out of claims, so that a table's layout depends on its
//! keys alone, and eviction happens between frames.
//!
//! # Limits today
//! On the host, on one thread: a pass over the table for each of nine steps.

use core::iter;

use crate::key::coarser;
use crate::layout::Layout;
use crate::sums::Sums;
use crate::table::Table;
use crate::tag::{EMPTY, tag_fingerprint};
use crate::temporal::{Change, Integrate, Rule};

/// The largest priority: what the 6 bits above a rank's hash hold.
pub const MAX_PRIORITY: u32 = 63;

/// How much a cell is worth keeping.
pub trait Priority {
    /// 0 (first to leave) to [`MAX_PRIORITY`], of a cell with `count` deposits that was last used `age` frames ago.
    fn priority(&self, count: u32, age: u32) -> u32;
}

/// The longest unused cells leave first; ages of 63 frames and above are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeastRecent;

impl Priority for LeastRecent {
    #[inline]
    fn priority(&self, _: u32, age: u32) -> u32 {
        MAX_PRIORITY - age.min(MAX_PRIORITY)
    }
}

/// Cells with few deposits leave first, where a number of unused frames halves what deposits count: twice the binary
/// logarithm of count·2^(−age/`half_life`), rounded down.
///
/// ```
/// use hashgrid::evict::{CountAndAge, Priority};
/// let by = CountAndAge { half_life: 10 };
/// assert_eq!(by.priority(1024, 0), 20);
/// assert_eq!(by.priority(1024, 10), by.priority(512, 0));
/// assert!(by.priority(1024, 100) < by.priority(2, 0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CountAndAge {
    /// Frames without use that halve a cell's worth; 0 counts as 1.
    pub half_life: u32,
}

impl Priority for CountAndAge {
    #[inline]
    fn priority(&self, count: u32, age: u32) -> u32 {
        let count = count.max(1);
        // The half logarithm: whether the count is at least √2 of its power of two, 181/128.
        let power = count.ilog2();
        let half = u32::from((u64::from(count) << 7) >> power >= 181);
        let faded = (u64::from(age) * 2 / u64::from(self.half_life.max(1))).min(u64::from(MAX_PRIORITY)) as u32;
        (2 * power + half).saturating_sub(faded)
    }
}

/// What [`evict`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evicted {
    /// Cells without deposits that left.
    pub empty: u32,
    /// Cells that left with light.
    pub removed: u32,
    /// Those of them whose light went into a coarser cell.
    pub folded: u32,
    /// Coarser cells made for it.
    pub made: u32,
    /// Energy that found no coarser cell, in quanta.
    pub energy_lost: u64,
}

/// The rank of a settled cell.
fn rank<L: Layout, P: Priority>(table: &Table<'_, L>, slot: u32, frame: u32, priority: &P) -> u32 {
    let cell = table.cell(slot);
    let age = frame.saturating_sub(table.stamp(slot));
    (priority.priority(cell.count, age).min(MAX_PRIORITY) << 26) | (tag_fingerprint(cell.tag) << 1)
}

/// Removes cells until at most `target` remain, apart from the coarser cells made for their light; see
/// [`crate::evict`]. `frame` is the frame that has just ended. While nobody else works on the table, between frames.
///
/// The layout needs [stamps](Layout::STAMP); in layouts without keys all evicted light is lost, and counted.
pub fn evict<L: Layout, P: Priority>(table: &Table<'_, L>, target: u32, frame: u32, priority: &P) -> Evicted {
    const { assert!(L::STAMP, "eviction needs stamps") }
    let slots = table.capacity() as u32;
    let mut evicted = Evicted::default();
    remove_all(table, |slot| table.head(slot) as u32 == 0, |_| evicted.empty += 1);
    let occupied = (0..slots).filter(|slot| is_occupied(table, *slot)).count() as u32;
    if occupied <= target {
        return evicted;
    }
    let cut = smallest(occupied - target, || {
        (0..slots).filter(|slot| is_occupied(table, *slot)).map(|slot| rank(table, slot, frame, priority))
    });
    for slot in (0..slots).filter(|slot| is_occupied(table, *slot)) {
        if rank(table, slot, frame, priority) <= cut {
            table.mark(slot);
        }
    }
    fold_marked(table, &mut evicted);
    evicted
}

fn is_occupied<L: Layout>(table: &Table<'_, L>, slot: u32) -> bool {
    (table.head(slot) >> 32) as u32 != EMPTY
}

/// Removes every occupied cell that is `chosen`, after `seen`.
fn remove_all<L: Layout>(table: &Table<'_, L>, chosen: impl Fn(u32) -> bool, mut seen: impl FnMut(u32)) {
    for slot in 0..table.capacity() as u32 {
        // What moves up into the slot is judged, too.
        while is_occupied(table, slot) && chosen(slot) {
            seen(slot);
            table.remove(slot);
        }
    }
}

/// The `n`-th smallest of some numbers, n from 1: byte by byte from the highest, by histograms.
fn smallest<I: Iterator<Item = u32>>(n: u32, numbers: impl Fn() -> I) -> u32 {
    let (mut prefix, mut rest) = (0_u32, n);
    for byte in (0..4).rev() {
        let shift = 8 * byte;
        let mut counts = [0_u32; 256];
        for number in numbers().filter(|number| (u64::from(number ^ prefix) >> shift) >> 8 == 0) {
            counts[(number >> shift) as usize & 255] += 1;
        }
        for (value, count) in counts.into_iter().enumerate() {
            if rest <= count {
                prefix |= (value as u32) << shift;
                break;
            }
            rest -= count;
        }
    }
    prefix
}

/// Removes every marked cell and adds its sums to the coarser cell around it.
fn fold_marked<L: Layout>(table: &Table<'_, L>, evicted: &mut Evicted) {
    for slot in 0..table.capacity() as u32 {
        while is_occupied(table, slot) && table.is_marked(slot) {
            let (sums, stamp, key) = (table.sums(slot), table.stamp(slot), table.key(slot));
            table.remove(slot);
            evicted.removed += 1;
            // Where the next level has no room, one above it may.
            let mut levels = iter::successors(key, coarser).skip(1);
            let Some(to) = levels.find_map(|above| table.open(&above)) else {
                evicted.energy_lost = evicted.energy_lost.wrapping_add(sums.energy());
                continue;
            };
            let there = table.sums(to);
            evicted.folded += 1;
            evicted.made += u32::from(there == Sums::default());
            let both = Integrate.blend(&there, &sums, Change::default());
            let together = there.energy().wrapping_add(sums.energy());
            evicted.energy_lost = evicted.energy_lost.wrapping_add(together.wrapping_sub(both.energy()));
            table.set_sums(to, &both);
            // The later of both uses, without wiping a mark.
            if stamp > table.stamp(to) {
                let marked = table.is_marked(to);
                table.touch(to, stamp);
                if marked {
                    table.mark(to);
                }
            }
        }
    }
}
