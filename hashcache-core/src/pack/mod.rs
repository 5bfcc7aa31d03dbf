//! Directions and numbers in few bits.
//!
//! # A packed direction
//!
//! A direction is a point on the octahedron |x| + |y| + |z| = 1, unfolded into a square: 2 × 16 bits.
//!
//! | bits | meaning |
//! |---|---|
//! | 0..16 | x of the square, two's complement, −32767..=32767 stands for −1..=1 |
//! | 16..32 | y of the square, likewise |
//!
//! Example: (0.6, 0, −0.8). Divided by |x| + |y| + |z| = 1.4: (0.428571, 0, −0.571429). z is negative, so the lower
//! half is folded outwards: x' = 1 − |y| = 1, y' = 1 − |x| = 0.571429, with the signs of x and y (0 counts as
//! positive). Times 32767, rounded: x' = 32767, y' = 18724.
//!
//! ```text
//! y' = 18724          x' = 32767
//! 0100_1001_0010_0100 0111_1111_1111_1111 = 0x4924_7fff
//! ```
//!
//! # A packed pair of half floats
//!
//! | bits | meaning |
//! |---|---|
//! | 0..10 | first: mantissa |
//! | 10..15 | first: exponent + 15 |
//! | 15 | first: sign |
//! | 16..32 | second, likewise |
//!
//! Example: (1.5, −2). 1.5 = 1.1₂·2⁰: exponent 15, mantissa `10_0000_0000`. −2 = −1.0₂·2¹: exponent 16, mantissa 0.
//!
//! ```text
//! −2                  1.5
//! 1_10000_0000000000  0_01111_1000000000 = 0xc000_3e00
//! ```

mod half;
mod octahedral;

pub use half::{HALF_MAX, half_from_f32, half_to_f32, pack_half2, unpack_half2};
pub use octahedral::{OCTAHEDRAL_NONE, OCTAHEDRAL_ONE, octahedral_decode, octahedral_decode_int, octahedral_encode};
