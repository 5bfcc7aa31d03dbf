//! What a cell holds beside its tag and its count, chosen by type: what is left out costs no byte and no instruction.
//!
//! | part | bytes | what for |
//! |---|---|---|
//! | tag and count | 8 | always |
//! | one sum of all light ([`Minimal`]) | 24 | mean illumination |
//! | sums of direct and of further light | 48 | means of both |
//! | [`Layout::MOMENTS`] | 16 | the standard error of the mean: [`crate::sums::Sums::standard_error`] |
//! | [`Layout::CHANGES`] | 16 | how much re-evaluated paths changed: [`crate::temporal::Adaptive`] |
//! | [`Layout::STAMP`] | 8 | the frame of the last use: [`crate::evict`] |
//! | [`Layout::Kept`] = [`Key`] | 16 | no false match at all; levels and eviction ([`crate::levels`]) |
//!
//! | layout | parts | bytes |
//! |---|---|---|
//! | [`Minimal`] | one sum | 32 |
//! | [`Standard`] | two sums | 64 |
//! | [`Measured`] | two sums, squares | 72 |
//! | `Lasting` | two sums, stamp, key | 80 |
//! | `Complete` | all | 112 |
//!
//! Seven words are filled up to eight, so that such a cell is a line of the memory's caches; no other size is padded.
//! A stamp is therefore free in the layout of [`Standard`].
//!
//! ```
//! use hashgrid::layout::{Layout, Minimal, Standard};
//! use hashgrid::{Settings, Params, Table, Word};
//!
//! #[derive(Clone, Copy, Debug)]
//! struct Timed; // Standard's sums and a stamp
//! impl Layout for Timed {
//!     const STAMP: bool = true;
//!     type Kept = ();
//! }
//! assert_eq!([Minimal::BYTES, Standard::BYTES, Timed::BYTES], [32, 64, 64]);
//!
//! let storage = [const { Word::new(0) }; 64 * Timed::WORDS];
//! let table = Table::<Timed>::with_layout(&storage, &Params::new(&Settings::default())?)?;
//! assert_eq!(table.capacity(), 64);
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```

use core::fmt::Debug;

use crate::key::Key;
use crate::names::Naming;
#[cfg(target_has_atomic = "64")]
use crate::word;
use crate::word::Word;

/// The parts of a cell. Implement it for a type of your own to combine parts as you need them: give [`Layout::Kept`] and
/// the constants that differ from [`Standard`]'s. The constants from [`Layout::SUMS`] on follow from the others; leave
/// them as they are.
pub trait Layout: Copy + Debug + Send + Sync + 'static {
    /// Direct and further light each have sums. Otherwise there is one sum of both; it is reported as further light.
    const SPLIT: bool = true;
    /// A sum of the squares of the light's luminance, 128 bits.
    const MOMENTS: bool = false;
    /// Two sums that tell how much the light of re-evaluated paths changed.
    const CHANGES: bool = false;
    /// The frame of the last use.
    const STAMP: bool = false;
    /// What is kept of the key beside the tag: `()`, nothing; or [`Key`], all of it (on targets with 64-bit atomics).
    type Kept: Keep;

    /// Sums of light.
    const SUMS: usize = if Self::SPLIT { 6 } else { 3 };
    /// First word of the squares.
    const MOMENTS_AT: usize = 1 + Self::SUMS;
    /// First word of the changes.
    const CHANGES_AT: usize = Self::MOMENTS_AT + if Self::MOMENTS { 2 } else { 0 };
    /// The word of the stamp.
    const STAMP_AT: usize = Self::CHANGES_AT + if Self::CHANGES { 2 } else { 0 };
    /// First word of the key.
    const KEPT_AT: usize = Self::STAMP_AT + if Self::STAMP { 1 } else { 0 };
    /// Words in use.
    const USED: usize = Self::KEPT_AT + <Self::Kept as Keep>::WORDS;
    /// 64-bit words of a cell.
    const WORDS: usize = if Self::USED == 7 { 8 } else { Self::USED };
    /// Bytes of a cell.
    const BYTES: usize = 8 * Self::WORDS;
}

/// What a cell may keep of its key: `()` or [`Key`].
pub trait Keep: Copy + Debug + Send + Sync + private::Sealed + 'static {
    /// Words of the cell.
    const WORDS: usize;

    /// What is kept of this key.
    fn of(key: &Key) -> Self;

    /// Whether the words hold it; always true of nothing.
    fn stands_in(self, words: &[Word]) -> bool;

    /// Writes it, while nobody else writes.
    fn write(self, words: &[Word]);

    /// Offers it as the name that the words hold, see [`crate::names`]; nothing to do for nothing.
    fn offer(self, words: &[Word], step: Naming);

    /// The key that the words hold, where they hold one.
    fn read(words: &[Word]) -> Option<Key>;
}

mod private {
    pub trait Sealed {}
    impl Sealed for () {}
    #[cfg(target_has_atomic = "64")]
    impl Sealed for crate::Key {}
}

impl Keep for () {
    const WORDS: usize = 0;

    #[inline]
    fn of(_: &Key) -> Self {}

    #[inline]
    fn stands_in(self, _: &[Word]) -> bool {
        true
    }

    fn write(self, _: &[Word]) {}

    #[inline]
    fn offer(self, _: &[Word], _: Naming) {}

    fn read(_: &[Word]) -> Option<Key> {
        None
    }
}

#[cfg(target_has_atomic = "64")]
impl Keep for Key {
    const WORDS: usize = 2;

    #[inline]
    fn of(key: &Key) -> Self {
        *key
    }

    #[inline]
    fn stands_in(self, words: &[Word]) -> bool {
        let [high, low] = self.words();
        word::get(&words[0]) == high && word::get(&words[1]) == low
    }

    fn write(self, words: &[Word]) {
        let [high, low] = self.words();
        word::set(&words[0], high);
        word::set(&words[1], low);
    }

    fn offer(self, words: &[Word], step: Naming) {
        let [first, second] = self.words();
        match step {
            Naming::First => {
                if word::min(&words[0], first) > first {
                    // The second word belonged to a larger name.
                    word::set(&words[1], u64::MAX);
                }
            }
            Naming::Second => {
                if word::get(&words[0]) == first {
                    word::min(&words[1], second);
                }
            }
        }
    }

    fn read(words: &[Word]) -> Option<Key> {
        let key = Key::from_words([word::get(&words[0]), word::get(&words[1])]);
        (key.attributes != crate::key::NO_KEY).then_some(key)
    }
}

/// Today's kernels' cell: sums of direct and of further light, one word spare. 64 bytes.
#[derive(Clone, Copy, Debug)]
pub struct Standard;

impl Layout for Standard {
    type Kept = ();
}

/// The smallest cell: one sum of all light. 32 bytes. To cache further light only, deposit none that is direct.
#[derive(Clone, Copy, Debug)]
pub struct Minimal;

impl Layout for Minimal {
    const SPLIT: bool = false;
    type Kept = ();
}

/// [`Standard`] and the squares, for the standard error of every mean. 72 bytes.
#[derive(Clone, Copy, Debug)]
pub struct Measured;

impl Layout for Measured {
    const MOMENTS: bool = true;
    type Kept = ();
}

/// [`Standard`], a stamp and the whole key: what lasts for many frames, changes levels and is evicted. 80 bytes.
#[cfg(target_has_atomic = "64")]
#[derive(Clone, Copy, Debug)]
pub struct Lasting;

#[cfg(target_has_atomic = "64")]
impl Layout for Lasting {
    const STAMP: bool = true;
    type Kept = Key;
}

/// Everything. 112 bytes.
#[cfg(target_has_atomic = "64")]
#[derive(Clone, Copy, Debug)]
pub struct Complete;

#[cfg(target_has_atomic = "64")]
impl Layout for Complete {
    const MOMENTS: bool = true;
    const CHANGES: bool = true;
    const STAMP: bool = true;
    type Kept = Key;
}
