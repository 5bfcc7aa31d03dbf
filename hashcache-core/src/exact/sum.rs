//! 64-bit words as pairs of 32-bit words, as they stand in buffers and in WGSL (`vec2<u32>`, low word first).

/// The low word.
#[inline]
pub const fn lo(v: u64) -> u32 {
    v as u32
}

/// The high word.
#[inline]
pub const fn hi(v: u64) -> u32 {
    (v >> 32) as u32
}

/// The 64-bit word of a low and a high word.
#[inline]
pub const fn pair(lo: u32, hi: u32) -> u64 {
    (hi as u64) << 32 | lo as u64
}

/// The sum modulo 2⁶⁴.
#[inline]
pub const fn add64(a: u64, b: u64) -> u64 {
    a.wrapping_add(b)
}

/// The difference modulo 2⁶⁴.
#[inline]
pub const fn sub64(a: u64, b: u64) -> u64 {
    a.wrapping_sub(b)
}

/// Whether `a` is below `b`.
#[inline]
pub const fn less64(a: u64, b: u64) -> bool {
    a < b
}

/// `v·2^shift` modulo 2⁶⁴, for shifts below 64.
#[inline]
pub const fn shl64(v: u64, shift: u32) -> u64 {
    debug_assert!(shift < 64);
    v << (shift & 63)
}

/// What to add to the high word of a sum after `add`'s low word was added to a low word that was `old_lo`.
///
/// With two 32-bit atomics: `old = atomicAdd(&low, lo(add)); atomicAdd(&high, carry(old, add))`. The low word's
/// additions are totally ordered and each wrap is seen by exactly one of them, so the pair is right once all have
/// ended, whatever the order; between the two steps a reader may see it one carry short.
///
/// ```
/// # use hashcache_core::exact::carry;
/// assert_eq!(carry(u32::MAX, (7 << 32) | 1), 8);
/// ```
#[inline]
pub const fn carry(old_lo: u32, add: u64) -> u32 {
    let wraps = old_lo.checked_add(lo(add)).is_none();
    hi(add).wrapping_add(wraps as u32)
}
