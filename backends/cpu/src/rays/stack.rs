//! What is still to be visited.
#![expect(
    unsafe_code,
    reason = "a stack that is cleared for every ray costs 5 to 10 % of a short ray's time (`benches/rays.rs`); \
              every entry below `len` has been written"
)]

use core::mem::MaybeUninit;

/// A stack of fixed size whose entries start unwritten.
pub(super) struct Stack<T: Copy, const N: usize> {
    entries: [MaybeUninit<T>; N],
    len: usize,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; N], len: 0 }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// # Panics
    /// When it is full.
    #[inline(always)]
    pub(super) fn push(&mut self, entry: T) {
        self.entries[self.len] = MaybeUninit::new(entry);
        self.len += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<T> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        // SAFETY: `len` was above 0 and grows by `push` alone, which writes the entry it takes in.
        Some(unsafe { self.entries[self.len].assume_init() })
    }

    /// Inserts `entry` at or above `bottom`, above all entries that `is_farther` tells.
    ///
    /// # Panics
    /// When it is full.
    #[inline(always)]
    pub(super) fn insert(&mut self, bottom: usize, entry: T, below: impl Fn(&T) -> bool) {
        self.push(entry);
        let mut place = self.len - 1;
        while place > bottom {
            // SAFETY: `place` is below `len`; all those entries have been written.
            let other = unsafe { self.entries[place - 1].assume_init() };
            if !below(&other) {
                break;
            }
            self.entries[place] = MaybeUninit::new(other);
            place -= 1;
        }
        self.entries[place] = MaybeUninit::new(entry);
    }
}
