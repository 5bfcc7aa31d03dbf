//! The word that tells whose a slot is.
//!
//! | bits | meaning |
//! |---|---|
//! | 0..6 | distance from home: this slot − the key's home, modulo the table's size |
//! | 6..31 | fingerprint of the key, 25 bits, never all ones |
//! | 31 | 1: new, claimed and still without deposits; 0: settled |
//!
//! Home and fingerprint both tell keys apart: since home = slot − distance, the tag and its place say
//! 25 + log₂(cells) bits about the key, though 25 are stored (quotienting). A lookup compares with the keys that share
//! its home only, so it meets a wrong cell with a probability of about load·2⁻²⁵.
//!
//! Example: fingerprint 5, two slots from home, new: `1 0000000000000000000000101 000010` = `0x8000_0142`. With the
//! first deposit it becomes `0 0000000000000000000000101 000010` = `0x0000_0142`.
//!
//! As numbers, tags are priorities: a smaller tag wins a slot. Settled ones are smaller than all new ones, [`EMPTY`]
//! is larger than all.

/// The tag of a slot without a key. The fingerprint of all ones, which it holds, belongs to no key.
pub const EMPTY: u32 = u32::MAX;

/// Flag of a key that has no deposits yet.
pub const NEW: u32 = 1 << 31;

/// Bits of the distance from home.
pub const DISTANCE_BITS: u32 = 6;

/// Bits of the fingerprint: what 32 leave beside flag and distance.
pub const FINGERPRINT_BITS: u32 = 25;

/// The largest fingerprint that a key has.
pub const FINGERPRINT_MAX: u32 = (1 << FINGERPRINT_BITS) - 2;

const DISTANCE_MASK: u32 = (1 << DISTANCE_BITS) - 1;

/// The settled tag of a fingerprint `distance` slots from home.
///
/// ```
/// # use hashgrid::tag::{NEW, tag};
/// assert_eq!(NEW | tag(5, 2), 0x8000_0142);
/// ```
#[inline]
pub const fn tag(fingerprint: u32, distance: u32) -> u32 {
    (fingerprint << DISTANCE_BITS) | distance
}

/// Slots from home.
#[inline]
pub const fn tag_distance(tag: u32) -> u32 {
    tag & DISTANCE_MASK
}

/// The key's fingerprint.
#[inline]
pub const fn tag_fingerprint(tag: u32) -> u32 {
    (tag & !NEW) >> DISTANCE_BITS
}

/// Whether the key still has no deposits. False for [`EMPTY`].
#[inline]
pub const fn tag_is_new(tag: u32) -> bool {
    tag >= NEW && tag != EMPTY
}
