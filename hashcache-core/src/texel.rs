//! Which texels of an image lie beside a texture coordinate.

use crate::float;

/// What an image shows outside of `[0, 1)`, as two bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Wrap {
    /// The image again.
    Repeat = 0,
    /// Its border texels.
    Clamp = 1,
    /// The image again, every second time mirrored.
    Mirror = 2,
}

impl Wrap {
    /// The word that says how an image wraps: `s` (across) in bits 0..2, `t` (down) in bits 2..4.
    ///
    /// ```
    /// # use hashcache_core::texel::Wrap;
    /// assert_eq!(Wrap::word(Wrap::Mirror, Wrap::Clamp), 0b01_10);
    /// ```
    pub const fn word(s: Self, t: Self) -> u32 {
        s as u32 | (t as u32) << 2
    }
}

/// Two neighbours along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelPair {
    /// Index of the texel whose centre lies at the coordinate or before it.
    pub first: u32,
    /// Index of the texel after it.
    pub second: u32,
    /// How far the coordinate lies from the first centre towards the second, in `[0, 1]`.
    pub fraction: f32,
}

/// The two texels beside a coordinate. Centres lie at `(i + 0.5) / size`.
///
/// `wrap` is a [`Wrap`] in its two lowest bits; 3 repeats. `size` is above 0. A coordinate that is not finite gives
/// texel 0, or with [`Wrap::Clamp`] the border it lies beyond.
///
/// ```
/// # use hashcache_core::texel::{TexelPair, Wrap, texel_pair};
/// // A quarter of a texel left of the first centre: between the last texel and the first.
/// let pair = texel_pair(0.0625, 4, Wrap::Repeat as u32);
/// assert_eq!(pair, TexelPair { first: 3, second: 0, fraction: 0.75 });
/// assert_eq!(texel_pair(f32::NAN, 4, 0).fraction, 0.0);
/// ```
#[inline]
pub fn texel_pair(coordinate: f32, size: u32, wrap: u32) -> TexelPair {
    // Into one period first: coordinates far out then keep what precision they have, and the integers do not overflow.
    let inside = match wrap & 3 {
        1 => coordinate.clamp(0.0, 1.0),
        2 => coordinate - 2.0 * float::floor(coordinate * 0.5),
        _ => coordinate - float::floor(coordinate),
    };
    let x = inside * size as f32 - 0.5;
    let cell = float::floor(x);
    // At most 1, by the floor; `max` turns NaN into 0.
    let fraction = (x - cell).max(0.0);
    let cell = cell as i32;
    TexelPair { first: wrapped(cell, size, wrap), second: wrapped(cell.saturating_add(1), size, wrap), fraction }
}

/// A texel's index brought into the image; `i` is at most one period away. NaN coordinates arrive as texel 0.
#[inline]
fn wrapped(i: i32, size: u32, wrap: u32) -> u32 {
    let n = size as i32;
    let index = match wrap & 3 {
        2 if i < 0 => -1 - i,
        2 if i >= 2 * n => i - 2 * n,
        2 if i >= n => 2 * n - 1 - i,
        1 | 2 => i,
        _ if i < 0 => i + n,
        _ if i >= n => i - n,
        _ => i,
    };
    index.clamp(0, n - 1) as u32
}
