//! Classic parallel steps that kernels alone cannot say: integer payloads, equal bits on every backend.

use crate::BufferId;

/// One of a closed set of operations that each backend implements. All buffers hold `u32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitive {
    /// Sets every word of `buffer` to `word`.
    Fill {
        /// Written.
        buffer: BufferId,
        /// The value.
        word: u32,
    },
    /// `output[i]` = sum (modulo 2³²) of `input[0..i]`; `output[count]` = the whole sum.
    Scan {
        /// `count` words.
        input: BufferId,
        /// `count + 1` words.
        output: BufferId,
        /// Number of words.
        count: u32,
    },
    /// Sorts `keys` ascending and moves `values` along; equal keys keep their order.
    SortPairs {
        /// Sorted in place.
        keys: BufferId,
        /// Permuted in place.
        values: BufferId,
        /// Number of pairs.
        count: u32,
    },
    /// Each run of equal neighbours in `keys` becomes one entry: its key and the sum (modulo 2³²) of its values.
    ReduceByKey {
        /// `count` words.
        keys: BufferId,
        /// `count` words.
        values: BufferId,
        /// Room for `count` words.
        unique: BufferId,
        /// Room for `count` words.
        sums: BufferId,
        /// One word: the number of runs.
        runs: BufferId,
        /// Number of pairs.
        count: u32,
    },
    /// Writes the indices `i` with `flags[i] != 0`, ascending.
    Compact {
        /// `count` words.
        flags: BufferId,
        /// Room for `count` words.
        indices: BufferId,
        /// One word: how many were written.
        kept: BufferId,
        /// Number of flags.
        count: u32,
    },
}
