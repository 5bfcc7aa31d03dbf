//! Counters that threads and kernels share.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use crate::counters::Counters;
use crate::exact::{carry, lo, pair};

/// Words of shared counters.
pub const COUNTER_WORDS: usize = 2 * Counters::WORDS;

/// Adds counters to shared ones: two words each, low word first.
pub fn add_counters(shared: &[AtomicU32], counters: &Counters) {
    for (to, from) in shared.chunks_exact(2).zip(counters.words()) {
        if *from == 0 {
            continue;
        }
        let high = carry(to[0].fetch_add(lo(*from), Relaxed), *from);
        if high != 0 {
            to[1].fetch_add(high, Relaxed);
        }
    }
}

/// Shared counters as they stand.
pub fn read_counters(shared: &[AtomicU32]) -> Counters {
    let mut words = [0; Counters::WORDS];
    for (to, from) in words.iter_mut().zip(shared.chunks_exact(2)) {
        *to = pair(from[0].load(Relaxed), from[1].load(Relaxed));
    }
    Counters::from_words(&words)
}
