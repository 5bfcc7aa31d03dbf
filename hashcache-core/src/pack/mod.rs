//! Directions and numbers in few bits.

mod half;
mod octahedral;

pub use half::{HALF_MAX, half_from_f32, half_to_f32, pack_half2, unpack_half2};
pub use octahedral::{OCTAHEDRAL_NONE, OCTAHEDRAL_ONE, octahedral_decode, octahedral_decode_int, octahedral_encode};
