//! Integer hashes of two independent families, and uniform numbers made from them.
//!
//! The PCG family turns counters into random words and coordinates into slots; the Murmur family ([`mix`], [`finish`])
//! supplies fingerprints, so that two keys that collide in one family are unlikely to collide in the other.
//! All functions are tier 0: the same bits in WGSL (`wgsl/hash.wgsl`, prefix `hc_`).

/// Multiplier of the linear congruential step that [`pcg2d`], [`pcg3d`] and [`pcg4d`] share (Numerical Recipes).
/// Another value changes every image.
pub const LCG_MULTIPLIER: u32 = 1_664_525;

/// Increment of that step. Another value changes every image.
pub const LCG_INCREMENT: u32 = 1_013_904_223;

/// One word from one word: a bijection (PCG-RXS-M-XS).
///
/// # Source
/// Jarzynski & Olano 2020, listing `pcg`; O'Neill 2014 for the permutation.
///
/// ```
/// # use hashcache_core::hash::pcg;
/// assert_eq!(pcg(0), 129_708_002);
/// ```
#[inline]
pub const fn pcg(v: u32) -> u32 {
    let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[inline]
const fn lcg(v: u32) -> u32 {
    v.wrapping_mul(LCG_MULTIPLIER).wrapping_add(LCG_INCREMENT)
}

#[inline]
const fn madd(a: u32, b: u32, c: u32) -> u32 {
    a.wrapping_add(b.wrapping_mul(c))
}

/// Two words from two words: a bijection.
///
/// # Source
/// Jarzynski & Olano 2020, listing `pcg2d`.
#[inline]
#[must_use]
pub const fn pcg2d(v: [u32; 2]) -> [u32; 2] {
    let [mut x, mut y] = [lcg(v[0]), lcg(v[1])];
    x = madd(x, y, LCG_MULTIPLIER);
    y = madd(y, x, LCG_MULTIPLIER);
    x ^= x >> 16;
    y ^= y >> 16;
    x = madd(x, y, LCG_MULTIPLIER);
    y = madd(y, x, LCG_MULTIPLIER);
    [x ^ (x >> 16), y ^ (y >> 16)]
}

/// Three words from three words: a bijection.
///
/// # Source
/// Jarzynski & Olano 2020, listing `pcg3d`.
///
/// ```
/// # use hashcache_core::hash::pcg3d;
/// assert_ne!(pcg3d([1, 2, 3]), pcg3d([1, 3, 2]));
/// ```
#[inline]
#[must_use]
pub const fn pcg3d(v: [u32; 3]) -> [u32; 3] {
    let [mut x, mut y, mut z] = [lcg(v[0]), lcg(v[1]), lcg(v[2])];
    x = madd(x, y, z);
    y = madd(y, z, x);
    z = madd(z, x, y);
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x = madd(x, y, z);
    y = madd(y, z, x);
    z = madd(z, x, y);
    [x, y, z]
}

/// Four words from four words: a bijection.
///
/// # Source
/// Jarzynski & Olano 2020, listing `pcg4d`.
#[inline]
#[must_use]
pub const fn pcg4d(v: [u32; 4]) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] = [lcg(v[0]), lcg(v[1]), lcg(v[2]), lcg(v[3])];
    x = madd(x, y, w);
    y = madd(y, z, x);
    z = madd(z, x, y);
    w = madd(w, y, z);
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x = madd(x, y, w);
    y = madd(y, z, x);
    z = madd(z, x, y);
    w = madd(w, y, z);
    [x, y, z, w]
}

/// Takes one more word `v` into the running hash `h`; end with [`finish`]. For fixed `v` a bijection of `h`, for fixed
/// `h` a bijection of `v`.
///
/// # Source
/// Appleby 2011, `MurmurHash3_x86_32`, body.
#[inline]
#[must_use]
pub const fn mix(h: u32, v: u32) -> u32 {
    let k = v.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    (h ^ k).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
}

/// Spreads the running hash `h` over all bits: a bijection, 0 stays 0.
///
/// # Source
/// Appleby 2011, `fmix32`.
///
/// ```
/// # use hashcache_core::hash::{finish, mix};
/// // MurmurHash3_x86_32 of the four bytes "test", seed 0; the length is added before the end.
/// assert_eq!(finish(mix(0, u32::from_le_bytes(*b"test")) ^ 4), 0xba6b_d213);
/// ```
#[inline]
#[must_use]
pub const fn finish(h: u32) -> u32 {
    let h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    let h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// A number in `[0, 1)` from the top 24 bits: a multiple of 2⁻²⁴, so that it is exact and never rounds up to 1.
///
/// ```
/// # use hashcache_core::hash::to_unit_f32;
/// assert_eq!(to_unit_f32(u32::MAX), 1.0 - 2.0_f32.powi(-24));
/// ```
#[inline]
pub const fn to_unit_f32(v: u32) -> f32 {
    (v >> 8) as f32 * (1.0 / 16_777_216.0)
}
