//! How bright a part of a texture is.

use alloc::vec::Vec;

use glam::Vec2;
use hashcache_core::texel::Wrap;

use super::luminance;
use crate::scene::Texture;
use crate::texture::decode_texel;

/// Running sums of a texture's luminance: the mean of any box of texels in constant time.
///
/// # Source
/// Crow 1984.
pub(super) struct LuminanceSums {
    width: usize,
    height: usize,
    /// Entry (x, y) of `(width + 1) × (height + 1)`: sum over all texels left of x and above y. In integers, so that
    /// what is subtracted cancels to the last bit: 2³² texels of 24 bits have room.
    sums: Vec<u64>,
}

/// Steps from black to white.
const STEPS: f32 = 16_777_216.0;

/// Coordinates further out than this many texels are too coarse to tell which texels they point at.
const FURTHEST: f32 = 4_194_304.0;

impl LuminanceSums {
    /// Of all of a texture's texels.
    pub(super) fn new(texture: &Texture, texels: &[u32]) -> Self {
        let (width, height) = (texture.width as usize, texture.height as usize);
        let mut sums = alloc::vec![0; (width + 1) * (height + 1)];
        let first = texture.first_texel as usize;
        for y in 0..height {
            let mut row = 0;
            for x in 0..width {
                let texel = decode_texel(texture, texels[first + y * width + x]);
                // Rounded up: only black is 0.
                row += round_up(luminance(texel));
                sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
            }
        }
        Self { width, height, sums }
    }

    /// Mean luminance of a box that holds all texels which a triangle with these coordinates shows, and its number of
    /// texels. 0 only when these are black.
    pub(super) fn mean_about(&self, texture: &Texture, uv: &[Vec2; 3]) -> (f64, usize) {
        let places = uv.map(|uv| texture.map(uv));
        let axis = |places: [f32; 3], size: usize, wrap: u32| {
            spans(places.map(|place| place * size as f32 - 0.5), size, wrap & 3)
        };
        let columns = axis(places.map(|place| place.x), self.width, texture.flags);
        let rows = axis(places.map(|place| place.y), self.height, texture.flags >> 2);
        let (mut sum, mut count) = (0, 0);
        for [left, right] in columns {
            for [top, bottom] in rows {
                count += (right - left) * (bottom - top);
                let at = |x: usize, y: usize| self.sums[y * (self.width + 1) + x];
                sum += (at(right, bottom) - at(right, top)) - (at(left, bottom) - at(left, top));
            }
        }
        (sum as f64 / (count.max(1) as f64 * f64::from(STEPS)), count)
    }
}

/// A luminance in steps; only black has none.
fn round_up(luminance: f32) -> u64 {
    (luminance * STEPS) as u64 + u64::from(luminance > 0.0)
}

/// Runs `[first, end)` of texel indices, the second perhaps empty, that hold all texels between three places on an
/// axis, and their neighbours: one more on each side than the bilinear filter reads, since the places are rounded.
fn spans(places: [f32; 3], size: usize, wrap: u32) -> [[usize; 2]; 2] {
    let whole = [[0, size], [0, 0]];
    let [a, b, c] = places;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if !(low > -FURTHEST && high < FURTHEST) {
        return whole;
    }
    let n = size as i64;
    let (first, last) = (low as i64 - 2, high as i64 + 3);
    if wrap == Wrap::Clamp as u32 {
        return [[first.clamp(0, n - 1) as usize, last.clamp(0, n - 1) as usize + 1], [0, 0]];
    }
    if last - first + 1 >= n || wrap == Wrap::Mirror as u32 && !(0 <= first && last < n) {
        return whole;
    }
    let (first, last) = (first.rem_euclid(n) as usize, last.rem_euclid(n) as usize);
    if first <= last { [[first, last + 1], [0, 0]] } else { [[first, size], [0, last + 1]] }
}
