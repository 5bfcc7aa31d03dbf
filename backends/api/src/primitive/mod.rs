//! Classic parallel steps that kernels alone cannot say: integer payloads, equal bits on every backend.

#[cfg(feature = "alloc")]
pub mod model;

use crate::BufferId;

/// One of a closed set of operations that each backend implements. All buffers hold `u32`.
///
/// Words that an operation does not name keep their value: `output` beyond `count + 1`, `unique`, `sums` and `indices`
/// beyond what was written. A `count` of 0 is fine. What each does to the bits is said in code by the `model` module.
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

/// A buffer that a primitive works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operand {
    /// The field's name.
    pub name: &'static str,
    /// The buffer.
    pub buffer: BufferId,
    /// Words in use from the buffer's start; `None`: all.
    pub words: Option<u64>,
    /// Whether the primitive writes it.
    pub written: bool,
}

impl Primitive {
    /// The operation's name in messages.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Fill { .. } => "fill",
            Self::Scan { .. } => "scan",
            Self::SortPairs { .. } => "sort_pairs",
            Self::ReduceByKey { .. } => "reduce_by_key",
            Self::Compact { .. } => "compact",
        }
    }

    /// The buffers it works on, in the order of its fields.
    pub fn operands(&self) -> [Option<Operand>; 5] {
        let of = |name, buffer, words: u64, written| Some(Operand { name, buffer, words: Some(words), written });
        match *self {
            Self::Fill { buffer, .. } => {
                [Some(Operand { name: "buffer", buffer, words: None, written: true }), None, None, None, None]
            }
            Self::Scan { input, output, count } => {
                let n = u64::from(count);
                [of("input", input, n, false), of("output", output, n + 1, true), None, None, None]
            }
            Self::SortPairs { keys, values, count } => {
                let n = u64::from(count);
                [of("keys", keys, n, true), of("values", values, n, true), None, None, None]
            }
            Self::ReduceByKey { keys, values, unique, sums, runs, count } => {
                let n = u64::from(count);
                [
                    of("keys", keys, n, false),
                    of("values", values, n, false),
                    of("unique", unique, n, true),
                    of("sums", sums, n, true),
                    of("runs", runs, 1, true),
                ]
            }
            Self::Compact { flags, indices, kept, count } => {
                let n = u64::from(count);
                [of("flags", flags, n, false), of("indices", indices, n, true), of("kept", kept, 1, true), None, None]
            }
        }
    }
}
