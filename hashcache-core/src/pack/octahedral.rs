//! Directions as points on an octahedron, unfolded into a square.
//!
//! # Source
//! Meyer et al. 2010; Cigolle et al. 2014 (`oct32`).

use glam::Vec3;

use crate::float;

/// The square's half side: what stands for 1, and the sum |x| + |y| + |z| of every [`octahedral_decode_int`].
/// 32767 is the largest number for which both signs fit 16 bits, so that mirrored directions have mirrored codes.
pub const OCTAHEDRAL_ONE: i32 = 32767;

/// A code that [`octahedral_encode`] never gives (it holds −32768): free for "no direction".
pub const OCTAHEDRAL_NONE: u32 = 0x8000_8000;

/// A direction of any length in 32 bits, within 0.0038° (6.6·10⁻⁵ radians) of the given one.
///
/// A vector that is zero (or subnormal, which GPUs read as zero), or has a component that is not finite, becomes +z.
///
/// ```
/// # use hashcache_core::{glam::Vec3, pack::octahedral_encode};
/// assert_eq!(octahedral_encode(Vec3::new(0.6, 0.0, -0.8)), 0x4924_7fff);
/// ```
#[inline]
pub fn octahedral_encode(n: Vec3) -> u32 {
    // By the largest component first: the plain sum overflows for long vectors and loses bits for short ones.
    let magnitude = |v: f32| v.to_bits() & 0x7fff_ffff;
    let largest = magnitude(n.x).max(magnitude(n.y)).max(magnitude(n.z));
    if !(0x0080_0000..0x7f80_0000).contains(&largest) {
        return 0;
    }
    let v = n / f32::from_bits(largest);
    let a = v.abs();
    let sum = a.x + a.y + a.z;
    let (x, y) = (v.x / sum, v.y / sum);
    let (x, y) = if v.z < 0.0 { (outward(1.0 - y.abs(), x), outward(1.0 - x.abs(), y)) } else { (x, y) };
    (snorm(x) as u32 & 0xffff) | ((snorm(y) as u32) << 16)
}

/// `v` with the sign of `s`, 0 counting as positive whatever its sign bit.
#[inline]
fn outward(v: f32, s: f32) -> f32 {
    if s < 0.0 { -v } else { v }
}

/// Nearest integer of `v·32767`, halves away from 0 so that mirrored directions have mirrored codes.
#[inline]
fn snorm(v: f32) -> i32 {
    let magnitude = float::floor(v.abs() * OCTAHEDRAL_ONE as f32 + 0.5) as i32;
    if v < 0.0 { -magnitude } else { magnitude }
}

/// The unit vector of a code.
///
/// ```
/// # use hashcache_core::{glam::Vec3, pack::octahedral_decode};
/// assert_eq!(octahedral_decode(0), Vec3::Z);
/// ```
#[inline]
pub fn octahedral_decode(code: u32) -> Vec3 {
    let [x, y, z] = octahedral_decode_int(code);
    let v = Vec3::new(x as f32, y as f32, z as f32);
    // |v|² lies between 32767²/3 and 32767².
    v / float::sqrt(v.length_squared())
}

/// The direction of a code as an integer vector on the octahedron: |x| + |y| + |z| = [`OCTAHEDRAL_ONE`], no rounding.
///
/// Defined for all 2³² codes (−32768 reads as −32767). Encoding the result gives a code of the same vector.
///
/// ```
/// # use hashcache_core::pack::octahedral_decode_int;
/// assert_eq!(octahedral_decode_int(0x4924_7fff), [14043, 0, -18724]);
/// ```
#[inline]
#[must_use]
pub const fn octahedral_decode_int(code: u32) -> [i32; 3] {
    let x = octahedral_component(code, 0);
    let y = octahedral_component(code, 16);
    let z = OCTAHEDRAL_ONE - x.abs() - y.abs();
    // Below the middle, x and y are folded towards 0 by as much; without a branch, which random directions would miss.
    let folded = if z < 0 { -z } else { 0 };
    let (x_sign, y_sign) = (x >> 31, y >> 31);
    [x - ((folded ^ x_sign) - x_sign), y - ((folded ^ y_sign) - y_sign), z]
}

#[inline]
const fn octahedral_component(code: u32, offset: u32) -> i32 {
    let v = (code >> offset) as i16 as i32;
    if v < -OCTAHEDRAL_ONE { -OCTAHEDRAL_ONE } else { v }
}
