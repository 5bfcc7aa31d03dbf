//! Half floats by integers alone: GPU drivers differ in their own conversions (rounding, overflow, subnormals).

/// The largest finite half float, 65504. What is larger is stored as this.
pub const HALF_MAX: u32 = 0x7bff;

/// The half float (16 bits) nearest to a float given by its bits, ties to even.
///
/// Magnitudes above 65504, infinity included, become ±65504. NaN becomes the quiet NaN `0x7e00`.
///
/// ```
/// # use hashcache_core::pack::half_from_f32;
/// assert_eq!(half_from_f32(1.0_f32.to_bits()), 0x3c00);
/// assert_eq!(half_from_f32(f32::NEG_INFINITY.to_bits()), 0xfbff);
/// ```
#[inline]
pub const fn half_from_f32(bits: u32) -> u32 {
    let sign = (bits >> 16) & 0x8000;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude > 0x7f80_0000 {
        return 0x7e00;
    }
    // 65520 and above would round to infinity; what lies between 65504 and 65520 rounds down by itself.
    if magnitude >= 0x477f_f000 {
        return sign | HALF_MAX;
    }
    // Below 2⁻¹⁴ a half float is subnormal: its unit is 2⁻²⁴ whatever the exponent.
    let exponent = magnitude >> 23;
    if exponent < 113 {
        // 2⁻²⁵ is half the smallest subnormal and ties to the even 0.
        if exponent < 102 {
            return sign;
        }
        let mantissa = (magnitude & 0x007f_ffff) | 0x0080_0000;
        return sign | round_even(mantissa, 126 - exponent);
    }
    sign | (round_even(magnitude, 13) - (112 << 10))
}

/// `v / 2^shift` to the nearest integer, ties to even, for `1 <= shift <= 24`.
#[inline]
const fn round_even(v: u32, shift: u32) -> u32 {
    (v + (1 << (shift - 1)) - 1 + ((v >> shift) & 1)) >> shift
}

/// The float's bits of a half float (its low 16 bits); exact. Infinity stays infinity, NaN stays NaN (made quiet).
///
/// ```
/// # use hashcache_core::pack::half_to_f32;
/// assert_eq!(f32::from_bits(half_to_f32(0x3c00)), 1.0);
/// ```
#[inline]
pub const fn half_to_f32(half: u32) -> u32 {
    let sign = (half & 0x8000) << 16;
    let exponent = (half >> 10) & 31;
    let mantissa = half & 0x03ff;
    if exponent == 31 {
        let nan = if mantissa == 0 { 0 } else { 0x0040_0000 | (mantissa << 13) };
        return sign | 0x7f80_0000 | nan;
    }
    if exponent == 0 {
        if mantissa == 0 {
            return sign;
        }
        // A subnormal half is a normal float: move its leading bit to the hidden place.
        let shift = mantissa.leading_zeros() - 21;
        return sign | ((113 - shift) << 23) | (((mantissa << shift) & 0x03ff) << 13);
    }
    sign | ((exponent + 112) << 23) | (mantissa << 13)
}

/// Two floats as half floats, the first in the low 16 bits.
///
/// ```
/// # use hashcache_core::pack::pack_half2;
/// assert_eq!(pack_half2([1.5, -2.0]), 0xc000_3e00);
/// ```
#[inline]
pub const fn pack_half2(v: [f32; 2]) -> u32 {
    half_from_f32(v[0].to_bits()) | (half_from_f32(v[1].to_bits()) << 16)
}

/// The two floats of [`pack_half2`].
///
/// ```
/// # use hashcache_core::pack::unpack_half2;
/// assert_eq!(unpack_half2(0xc000_3e00), [1.5, -2.0]);
/// ```
#[inline]
#[must_use]
pub const fn unpack_half2(packed: u32) -> [f32; 2] {
    [f32::from_bits(half_to_f32(packed & 0xffff)), f32::from_bits(half_to_f32(packed >> 16))]
}
