//! Levels of detail from a float's exponent bits: one multiplication, the rest integers.

/// The coarsest level. Cells of level `l` are `base·2^l` large, so 31 spans nine decimal orders of magnitude.
/// More would not fit the five bits that keys give a level.
pub const MAX_LEVEL: u32 = 31;

/// ⌊log₂|x|⌋ of a normal number, read from its exponent bits; −127 for 0 and subnormal numbers, 128 for infinite and
/// NaN.
///
/// ```
/// # use hashcache_core::level::exponent;
/// assert_eq!((exponent(1.0), exponent(-5.0), exponent(0.75)), (0, 2, -1));
/// ```
#[inline]
pub const fn exponent(x: f32) -> i32 {
    ((x.to_bits() >> 23) & 0xff) as i32 - 127
}

/// The level whose cells are nearest below the footprint: `⌊log₂(footprint·recip_base)⌋`, at least 0 and at most
/// [`MAX_LEVEL`].
///
/// `recip_base` is 1 / the size of cells of level 0. A product that is negative, NaN or below 1 gives 0, an infinite
/// one [`MAX_LEVEL`]. NaN is told by its bits: its sign differs between machines.
///
/// # Units
/// `footprint` in scene units, `recip_base` in 1 / scene units.
///
/// ```
/// # use hashcache_core::level::level_from_footprint;
/// // Cells of 1 cm; a pixel of 9 cm covers cells of 8 cm = 2³ cm.
/// assert_eq!(level_from_footprint(0.09, 100.0), 3);
/// ```
#[inline]
pub const fn level_from_footprint(footprint: f32, recip_base: f32) -> u32 {
    let bits = (footprint * recip_base).to_bits();
    // Above +infinity's bits lie NaN, and all negative numbers.
    if bits > 0x7f80_0000 {
        return 0;
    }
    let level = (bits >> 23).saturating_sub(127);
    if level > MAX_LEVEL { MAX_LEVEL } else { level }
}
