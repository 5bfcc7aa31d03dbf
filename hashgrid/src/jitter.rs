//! Jitter in integers: where a vertex is looked for, in its tangent plane (the core's functions), and which way its
//! normal leans.

pub use hashcache_core::jitter::{draw, max_component, tangent_offset, turn, turn_back};

/// Salt of the draws of a deposit (and of its claim).
pub const SALT_DEPOSIT: u32 = 0x9e37_79b9;

/// Salt of the draws of a lookup: another one, so that a vertex does not meet its own deposit more often than others.
pub const SALT_LOOKUP: u32 = 0x7f4a_7c15;

/// The bin of the normal `n` after its components along the other two axes than its largest were moved by `u` and `v`.
///
/// A bin is a part of a face of the cube around the directions: `((axis·2 + sign)·bins + row)·bins + column`.
/// Moving a normal over the edge of a face brings it to the face beyond. An axis-aligned normal stays in the middle
/// bin of its face for all `|u|, |v|` up to half a bin.
///
/// # Units
/// `u`, `v` in 32768ths of half a face's edge: half a bin is 32768/`bins`.
#[inline]
pub const fn normal_bin(n: [i32; 3], u: i32, v: i32, bins: u32) -> u32 {
    let axis = max_component(n);
    let [a, b, c] = turn(n, axis);
    let m = a.abs();
    let moved = [a, b + ((m * u) >> 15), c + ((m * v) >> 15)];
    let beyond = max_component(moved);
    let [a, b, c] = turn(moved, beyond);
    let face = ((axis + beyond) % 3) * 2 + (a < 0) as u32;
    (face * bins + face_bin(a.abs(), b, bins)) * bins + face_bin(a.abs(), c, bins)
}

/// Which of `bins` parts of -m..=m holds `t`.
#[inline]
const fn face_bin(m: i32, t: i32, bins: u32) -> u32 {
    let bin = ((t + m) as u32 * bins) / (2 * m as u32);
    if bin < bins { bin } else { bins - 1 }
}

/// How much longer the path gets when its end moves by `offset`: their component along the `direction` of its last ray.
///
/// # Units
/// `offset` and the result in the same; `direction` as from `octahedral_decode_int`.
///
/// # Deviation
/// The direction's length is estimated by α·max + β·mid + γ·min, within 6 %: an error of 6 % in how far the jitter carries
/// a vertex towards the next level, in exchange for no square root.
#[inline]
pub const fn path_change(offset: [i32; 3], direction: [i32; 3]) -> i32 {
    let dot = offset[0] * direction[0] + offset[1] * direction[1] + offset[2] * direction[2];
    let [x, y, z] = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
    let largest = max(x, max(y, z));
    let smallest = min(x, min(y, z));
    let middle = x + y + z - largest - smallest;
    dot / ((962 * largest + 399 * middle + 306 * smallest) >> 10)
}

const fn max(a: i32, b: i32) -> i32 {
    if a > b { a } else { b }
}

const fn min(a: i32, b: i32) -> i32 {
    if a < b { a } else { b }
}
