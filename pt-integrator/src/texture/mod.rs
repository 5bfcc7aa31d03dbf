//! Colours from textures.

mod srgb;

pub use srgb::{SRGB_TO_LINEAR, decode};

use glam::{Vec2, Vec3};
use hashcache_core::float;

use crate::scene::Texture;

/// The linear colour of a texture at `uv`, bilinear between decoded texels.
#[inline]
pub fn sample_texture(texture: &Texture, texels: &[u32], uv: Vec2) -> Vec3 {
    let (x0, x1, fx) = axis(uv.x, texture.width, texture.flags & 3);
    let (y0, y1, fy) = axis(uv.y, texture.height, (texture.flags >> 2) & 3);
    let texel = |x: u32, y: u32| decode(texels[(texture.first_texel + y * texture.width + x) as usize]);
    let upper = texel(x0, y0).lerp(texel(x1, y0), fx);
    let lower = texel(x0, y1).lerp(texel(x1, y1), fx);
    upper.lerp(lower, fy)
}

/// The two texels beside a coordinate and how far it lies towards the second.
#[inline]
fn axis(coordinate: f32, size: u32, wrap: u32) -> (u32, u32, f32) {
    // Into one period first: coordinates far out then keep what precision they have, and the integers do not overflow.
    let inside = match wrap {
        1 => coordinate.clamp(0.0, 1.0),
        2 => coordinate - 2.0 * float::floor(coordinate * 0.5),
        _ => coordinate - float::floor(coordinate),
    };
    let x = inside * size as f32 - 0.5;
    let cell = float::floor(x);
    let fraction = (x - cell).clamp(0.0, 1.0);
    let cell = cell as i32;
    (wrapped(cell, size, wrap), wrapped(cell + 1, size, wrap), fraction)
}

/// A texel's index brought into the image; `i` is at most one period away. NaN coordinates arrive as texel 0.
#[inline]
fn wrapped(i: i32, size: u32, wrap: u32) -> u32 {
    let n = size as i32;
    let index = match wrap {
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
