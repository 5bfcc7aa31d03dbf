//! Colours from textures.

mod srgb;

pub use srgb::{SRGB_TO_LINEAR, decode};

use glam::{Vec2, Vec3};
use hashcache_core::texel::texel_pair;

use crate::scene::Texture;

/// Linear red, green and blue of a texture where a vertex's coordinates `uv` point, bilinear between decoded texels.
///
/// Coordinates that are not finite, or leave f32's range under the texture's map, see a texel at the image's border.
///
/// ```
/// use hashcache_core::glam::{Vec2, Vec3};
/// use pt_integrator::scene::{Texture, Wrap};
/// use pt_integrator::texture::sample_texture;
/// let white = Texture::new(0, [1, 1], [Wrap::Repeat; 2]);
/// assert_eq!(sample_texture(&white, &[u32::MAX], Vec2::ZERO), Vec3::ONE);
/// ```
#[inline]
pub fn sample_texture(texture: &Texture, texels: &[u32], uv: Vec2) -> Vec3 {
    let place = Place::new(texture, uv);
    if texture.flags & Texture::LINEAR == 0 {
        place.bilinear(texture, texels, decode)
    } else {
        place.bilinear(texture, texels, decode_linear)
    }
}

/// Alpha of a texture, as [`sample_texture`].
#[inline]
pub fn sample_alpha(texture: &Texture, texels: &[u32], uv: Vec2) -> f32 {
    Place::new(texture, uv).bilinear(texture, texels, |word| Vec3::splat(channel(word, 24))).x
}

/// Linear red, green and blue of one of a texture's texels.
#[inline]
pub fn decode_texel(texture: &Texture, texel: u32) -> Vec3 {
    if texture.flags & Texture::LINEAR == 0 { decode(texel) } else { decode_linear(texel) }
}

#[inline]
fn decode_linear(word: u32) -> Vec3 {
    Vec3::new(channel(word, 0), channel(word, 8), channel(word, 16))
}

/// Eight bits of a word as a number in `[0, 1]`.
#[inline]
fn channel(word: u32, shift: u32) -> f32 {
    ((word >> shift) & 0xff) as f32 / 255.0
}

/// Four texels, upper left first, and how far a point lies towards the right and the lower ones.
struct Place {
    columns: [u32; 2],
    rows: [u32; 2],
    fraction: Vec2,
}

impl Place {
    #[inline]
    fn new(texture: &Texture, uv: Vec2) -> Self {
        let at = texture.map(uv);
        let x = texel_pair(at.x, texture.width, texture.flags);
        let y = texel_pair(at.y, texture.height, texture.flags >> 2);
        Self { columns: [x.first, x.second], rows: [y.first, y.second], fraction: Vec2::new(x.fraction, y.fraction) }
    }

    #[inline]
    fn bilinear(&self, texture: &Texture, texels: &[u32], decode: impl Fn(u32) -> Vec3) -> Vec3 {
        let texel = |x: u32, y: u32| decode(texels[(texture.first_texel + y * texture.width + x) as usize]);
        let [x0, x1] = self.columns;
        let [y0, y1] = self.rows;
        let upper = texel(x0, y0).lerp(texel(x1, y0), self.fraction.x);
        let lower = texel(x0, y1).lerp(texel(x1, y1), self.fraction.x);
        upper.lerp(lower, self.fraction.y)
    }
}
