//! The 64-bit words that a table is made of, on targets with 64-bit atomics and on those without.
//!
//! Both kinds have the same eight bytes on a little-endian machine: low half first. All accesses are relaxed; phases
//! (claim, deposit, lookup) are kept apart by whoever runs them, and joining threads orders memory between phases.

#[cfg(target_has_atomic = "64")]
mod wide {
    use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

    /// A word of a table's storage: `AtomicU64` where the target has it, else a pair of 32-bit atomics of the same bytes.
    pub type Word = AtomicU64;

    #[inline]
    pub fn get(word: &Word) -> u64 {
        word.load(Relaxed)
    }

    pub fn set(word: &Word, value: u64) {
        word.store(value, Relaxed);
    }

    #[inline]
    pub fn add(word: &Word, value: u64) {
        word.fetch_add(value, Relaxed);
    }

    /// Adds, and returns how often the word passed 2⁶⁴: 0 or 1.
    #[inline]
    pub fn add_carry(word: &Word, value: u64) -> u64 {
        u64::from(word.fetch_add(value, Relaxed).checked_add(value).is_none())
    }

    /// The smaller of the word and `value` stays; returns the word as it was.
    #[inline]
    pub fn min(word: &Word, value: u64) -> u64 {
        word.fetch_min(value, Relaxed)
    }

    /// Adds to the low half, which must not wrap.
    #[inline]
    pub fn add_low(word: &Word, value: u32) {
        word.fetch_add(u64::from(value), Relaxed);
    }

    /// Clears bits of the high half.
    #[inline]
    pub fn clear_high(word: &Word, bits: u32) {
        word.fetch_and(!(u64::from(bits) << 32), Relaxed);
    }

    /// The smaller of the high half and `value` stays; returns the high half as it was.
    #[inline]
    pub fn min_high(word: &Word, value: u32) -> u32 {
        let mut old = word.load(Relaxed);
        loop {
            let high = (old >> 32) as u32;
            if high <= value {
                return high;
            }
            let new = (u64::from(value) << 32) | (old & 0xffff_ffff);
            match word.compare_exchange_weak(old, new, Relaxed, Relaxed) {
                Ok(_) => return high,
                // Somebody else was faster, or the exchange failed for no reason: the same word again.
                Err(now) => old = now,
            }
        }
    }
}

#[cfg(any(test, not(target_has_atomic = "64")))]
mod pair {
    use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

    use hashcache_core::exact::{carry, hi, lo, pair};

    /// A word of a table's storage: `AtomicU64` where the target has it, else a pair of 32-bit atomics of the same bytes.
    #[derive(Debug)]
    #[repr(C, align(8))]
    pub struct Word {
        low: AtomicU32,
        high: AtomicU32,
    }

    impl Word {
        /// A word that holds `value`.
        pub const fn new(value: u64) -> Self {
            Self { low: AtomicU32::new(lo(value)), high: AtomicU32::new(hi(value)) }
        }
    }

    #[inline]
    pub fn get(word: &Word) -> u64 {
        pair(word.low.load(Relaxed), word.high.load(Relaxed))
    }

    pub fn set(word: &Word, value: u64) {
        word.low.store(lo(value), Relaxed);
        word.high.store(hi(value), Relaxed);
    }

    #[inline]
    pub fn add(word: &Word, value: u64) {
        let old = word.low.fetch_add(lo(value), Relaxed);
        let high = carry(old, value);
        if high != 0 {
            word.high.fetch_add(high, Relaxed);
        }
    }

    /// Adds, and returns how often the word passed 2⁶⁴: each wrap of the high half is seen by one addition.
    #[inline]
    pub fn add_carry(word: &Word, value: u64) -> u64 {
        let wraps = word.low.fetch_add(lo(value), Relaxed).checked_add(lo(value)).is_none();
        let mut passed = u64::from(word.high.fetch_add(hi(value), Relaxed).checked_add(hi(value)).is_none());
        if wraps {
            passed += u64::from(word.high.fetch_add(1, Relaxed) == u32::MAX);
        }
        passed
    }

    /// Adds to the low half, which must not wrap.
    #[inline]
    pub fn add_low(word: &Word, value: u32) {
        word.low.fetch_add(value, Relaxed);
    }

    /// Clears bits of the high half.
    #[inline]
    pub fn clear_high(word: &Word, bits: u32) {
        word.high.fetch_and(!bits, Relaxed);
    }

    /// The smaller of the high half and `value` stays; returns the high half as it was.
    #[inline]
    pub fn min_high(word: &Word, value: u32) -> u32 {
        word.high.fetch_min(value, Relaxed)
    }
}

#[cfg(not(target_has_atomic = "64"))]
pub use pair::Word;
#[cfg(not(target_has_atomic = "64"))]
pub(crate) use pair::{add, add_carry, add_low, clear_high, get, min_high, set};
#[cfg(target_has_atomic = "64")]
pub use wide::Word;
#[cfg(target_has_atomic = "64")]
pub(crate) use wide::{add, add_carry, add_low, clear_high, get, min, min_high, set};

#[cfg(all(test, target_has_atomic = "64"))]
mod tests {
    use std::thread;
    use std::vec::Vec;

    use hashcache_core::hash::pcg2d;

    use super::{pair, wide};

    /// Both kinds hold the same after the same steps by several threads at once.
    #[test]
    fn pairs_are_as_good_as_wide_words() {
        let (word, twin) = (wide::Word::new(u64::MAX - 3), pair::Word::new(u64::MAX - 3));
        let (head, head_twin) = (wide::Word::new(u64::MAX << 32), pair::Word::new(u64::MAX << 32));
        thread::scope(|scope| {
            for t in 0..3 {
                let (word, twin, head, head_twin) = (&word, &twin, &head, &head_twin);
                scope.spawn(move || {
                    for i in 0..10_000 {
                        let [a, b] = pcg2d([i, t]);
                        let value = (u64::from(a) << 20) + u64::from(b);
                        wide::add(word, value);
                        pair::add(twin, value);
                        wide::min_high(head, a);
                        pair::min_high(head_twin, a);
                        wide::add_low(head, 3);
                        pair::add_low(head_twin, 3);
                    }
                });
            }
        });
        wide::clear_high(&head, 0xf0);
        pair::clear_high(&head_twin, 0xf0);
        assert_eq!(wide::get(&word), pair::get(&twin));
        assert_eq!(wide::get(&head), pair::get(&head_twin));
        assert_eq!(wide::get(&head) as u32, 90_000);
        wide::set(&word, 7 << 40);
        pair::set(&twin, 7 << 40);
        assert_eq!(wide::get(&word), pair::get(&twin));
    }

    /// Carries of a 128-bit sum are seen once each, by several threads too.
    #[test]
    fn carries_are_seen_once() {
        let (word, twin) = (wide::Word::new(0), pair::Word::new(0));
        let value = |i: u32, t: u32| (u64::from(pcg2d([i, t])[0]) << 32) | u64::from(pcg2d([i, t])[1]);
        let passed: Vec<[u64; 2]> = thread::scope(|scope| {
            let (word, twin) = (&word, &twin);
            let one = move |t| {
                (0..10_000).fold([0; 2], |[a, b], i| {
                    [a + wide::add_carry(word, value(i, t)), b + pair::add_carry(twin, value(i, t))]
                })
            };
            let tasks: Vec<_> = (0..3).map(|t| scope.spawn(move || one(t))).collect();
            tasks.into_iter().map(|task| task.join().unwrap()).collect()
        });
        let exact: u128 = (0..3).flat_map(|t| (0..10_000).map(move |i| u128::from(value(i, t)))).sum();
        for (k, low) in [wide::get(&word), pair::get(&twin)].into_iter().enumerate() {
            let high: u64 = passed.iter().map(|one| one[k]).sum();
            assert_eq!((u128::from(high) << 64) | u128::from(low), exact);
        }
        let twin = pair::Word::new(u64::MAX);
        assert_eq!((pair::add_carry(&twin, u64::MAX), pair::get(&twin)), (1, u64::MAX - 1));
    }

    /// The smaller stays, and who asked is told what was there.
    #[test]
    fn minima_return_what_was_there() {
        let steps = [9, 5, 7, 5, 1];
        let (word, twin) = (wide::Word::new(0x8_0000_004d), pair::Word::new(0x8_0000_004d));
        let wide: Vec<u32> = steps.iter().map(|v| wide::min_high(&word, *v)).collect();
        let pair: Vec<u32> = steps.iter().map(|v| pair::min_high(&twin, *v)).collect();
        assert_eq!(wide, [8, 8, 5, 5, 5]);
        assert_eq!(pair, wide);
        assert_eq!((wide::get(&word), pair::get(&twin)), (0x1_0000_004d, 0x1_0000_004d));
    }
}
