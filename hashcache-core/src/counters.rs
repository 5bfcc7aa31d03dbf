//! What a cache tells about a frame: what it was asked, what it answered, and where the energy went.

use bytemuck::{Pod, Zeroable};

use crate::exact::{Outcome, Quantized};

macro_rules! counters {
    ($($(#[$doc:meta])* $field:ident, $index:ident = $value:literal;)*) => {
        /// Counts and energies of a frame, or of many: 64-bit words only, so that a buffer of them is read and written
        /// through `AtomicU64` on the host and through pairs of `u32` (low word first) in WGSL.
        ///
        /// Additions wrap, so the law of [`Counters::balance`] survives any number of deposits.
        /// Each constant is the index of its field's word; in WGSL the two `u32` stand at twice the index and behind.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
        #[repr(C)]
        pub struct Counters {
            $($(#[$doc])* pub $field: u64,)*
        }

        impl Counters {
            $(
                #[doc = concat!("Index of [`Counters::", stringify!($field), "`].")]
                pub const $index: usize = $value;
            )*

            /// Number of words.
            pub const WORDS: usize = size_of::<Self>() / 8;
        }

        const _: () = {
            $(assert!(core::mem::offset_of!(Counters, $field) == 8 * $value);)*
        };
    };
}

counters! {
    /// Lookups asked for.
    lookups, LOOKUPS = 0;
    /// Lookups answered from a cell.
    hits, HITS = 1;
    /// Lookups answered with the vertex's own value.
    fallbacks, FALLBACKS = 2;
    /// Slots that lookups and deposits looked at.
    probes, PROBES = 3;
    /// Vertices deposited.
    deposits, DEPOSITS = 4;
    /// Vertices left out because their key found no slot, or their cell was full.
    refusals, REFUSALS = 5;
    /// Channel values above the clamp.
    clamped, CLAMPED = 6;
    /// Channel values so far above the clamp that not all of what was cut off is in the energies.
    saturated, SATURATED = 7;
    /// Channel values above 0 that rounded to 0.
    underflowed, UNDERFLOWED = 8;
    /// Channel values that were NaN or infinite.
    non_finite, NON_FINITE = 9;
    /// Channel values below 0.
    negative, NEGATIVE = 10;
    /// Deposits refused because their cell holds [`crate::exact::MAX_DEPOSITS`].
    overflowed, OVERFLOWED = 11;
    /// Energy offered, in quanta: value and what was clamped away, over all channels.
    energy_recorded, ENERGY_RECORDED = 12;
    /// Energy in cells, in quanta.
    energy_stored, ENERGY_STORED = 13;
    /// Energy of refused deposits, in quanta, after the clamp.
    energy_refused, ENERGY_REFUSED = 14;
    /// Energy above the clamp, in quanta.
    energy_clamped, ENERGY_CLAMPED = 15;
    /// Energy that rounded to 0, in quantum·2^−[`crate::exact::UNDERFLOW_BITS`]; not part of the recorded energy,
    /// which counts whole quanta.
    energy_underflowed, ENERGY_UNDERFLOWED = 16;
    /// Deposits and lookups that got a cell of a coarser level than the one they asked for, because that one has no cell
    /// there or too few samples.
    coarser, COARSER = 17;
}

impl Counters {
    /// The counters of a buffer's words; missing words count as 0, further words are ignored.
    pub fn from_words(words: &[u64]) -> Self {
        let mut counters = Self::zeroed();
        let own = bytemuck::cast_slice_mut::<Self, u64>(core::slice::from_mut(&mut counters));
        for (to, from) in own.iter_mut().zip(words) {
            *to = *from;
        }
        counters
    }

    /// The words in the order of the constants.
    pub fn words(&self) -> &[u64] {
        bytemuck::cast_slice(core::slice::from_ref(self))
    }

    /// The sum of two frames' or two tables' counters.
    #[must_use]
    pub fn merge(&self, other: &Self) -> Self {
        let mut sum = *self;
        let own = bytemuck::cast_slice_mut::<Self, u64>(core::slice::from_mut(&mut sum));
        for (to, from) in own.iter_mut().zip(other.words()) {
            *to = to.wrapping_add(*from);
        }
        sum
    }

    /// Notes one channel value of a deposit: its outcome and the energies that follow from it. `stored` tells whether
    /// the value went into a cell or was refused.
    ///
    /// ```
    /// # use hashcache_core::{counters::Counters, exact::{Quantum, quantize}};
    /// let mut counters = Counters::default();
    /// counters.note(&quantize(Quantum::new(0).unwrap(), 10_000.0), true);
    /// assert_eq!((counters.clamped, counters.energy_clamped), (1, 1808 << 20));
    /// assert_eq!(counters.balance(), 0);
    /// ```
    pub fn note(&mut self, deposit: &Quantized, stored: bool) {
        let one = |outcome| u64::from(deposit.outcome == outcome);
        self.clamped += one(Outcome::Clamped);
        self.saturated += one(Outcome::Saturated);
        self.underflowed += one(Outcome::Underflow);
        self.non_finite += one(Outcome::NonFinite);
        self.negative += one(Outcome::Negative);
        let cut = if deposit.outcome == Outcome::Underflow { 0 } else { deposit.lost };
        let add = |sum: &mut u64, v: u64| *sum = sum.wrapping_add(v);
        add(&mut self.energy_recorded, deposit.value.wrapping_add(cut));
        add(&mut self.energy_clamped, cut);
        add(&mut self.energy_underflowed, deposit.lost - cut);
        add(if stored { &mut self.energy_stored } else { &mut self.energy_refused }, deposit.value);
    }

    /// Recorded − stored − refused − clamped, modulo 2⁶⁴: 0 unless energy got lost unseen.
    pub const fn balance(&self) -> u64 {
        self.energy_recorded
            .wrapping_sub(self.energy_stored)
            .wrapping_sub(self.energy_refused)
            .wrapping_sub(self.energy_clamped)
    }
}
