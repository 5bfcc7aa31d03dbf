//! Jitter in integers: where a point of a surface is looked for, in its tangent plane.
//!
//! All functions are tier 0: the same bits in WGSL (`wgsl/jitter.wgsl`, prefix `hc_`).

/// A whole number in `-range..range` from 16 random bits, uniform up to 2⁻¹⁶. `range` is at most 32768; 0 gives 0.
///
/// ```
/// # use hashcache_core::jitter::draw;
/// assert_eq!((draw(0, 128), draw(0xffff, 128), draw(0x8000, 128)), (-128, 127, 0));
/// ```
#[inline]
pub const fn draw(bits: u32, range: u32) -> i32 {
    (((bits & 0xffff) * (2 * range)) >> 16) as i32 - range as i32
}

/// Which component of `v` is the largest in magnitude, the first among equals.
///
/// ```
/// # use hashcache_core::jitter::max_component;
/// assert_eq!(max_component([3, -7, 7]), 1);
/// ```
#[inline]
pub const fn max_component(v: [i32; 3]) -> u32 {
    let [x, y, z] = [v[0].abs(), v[1].abs(), v[2].abs()];
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// `v` turned so that component `axis` comes first and the others follow in cyclic order.
#[inline]
#[must_use]
pub const fn turn(v: [i32; 3], axis: u32) -> [i32; 3] {
    match axis {
        0 => v,
        1 => [v[1], v[2], v[0]],
        _ => [v[2], v[0], v[1]],
    }
}

/// Undoes [`turn`].
#[inline]
#[must_use]
pub const fn turn_back(v: [i32; 3], axis: u32) -> [i32; 3] {
    turn(v, (3 - axis) % 3)
}

/// The offset in the plane with normal `n` whose components along the other two axes than the normal's largest are `u`
/// and `v`. For uniform `u` and `v` it is uniform in the plane.
///
/// # Units
/// `u`, `v` and the result in the same, at most 32767 in magnitude; `n` of any length, as from
/// [`crate::pack::octahedral_decode_int`].
///
/// # Source
/// Binder et al. 2021, algorithm 1, `jitter(n)`.
///
/// # Deviation
/// The paper leaves the kernel open. Here it is a square seen along the normal's largest axis, so its edge in the plane
/// is up to √2 longer on slanted surfaces; that keeps it in integers, and its density uniform.
///
/// ```
/// # use hashcache_core::jitter::tangent_offset;
/// assert_eq!(tangent_offset([0, 0, -5], 3, 4), [3, 4, 0]); // a wall: the offset stays in it
/// ```
#[inline]
#[must_use]
pub const fn tangent_offset(n: [i32; 3], u: i32, v: i32) -> [i32; 3] {
    let axis = max_component(n);
    let [a, b, c] = turn(n, axis);
    turn_back([-(b * u + c * v) / a, u, v], axis)
}
