//! Textures.

use bytemuck::{Pod, Zeroable};
pub use hashcache_core::texel::Wrap;

/// An image in the scene's list of texels, with how it is read. 48 bytes. Several textures may share texels.
///
/// Texels are RGBA8 words, red in the lowest byte, rows from the top. Centres lie at
/// `((i + 0.5) / width, (j + 0.5) / height)`; texels are decoded before the bilinear filter.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Texture {
    /// Index of the upper left texel.
    pub first_texel: u32,
    /// Texels a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// [`Wrap`] of s in bits 0..2, of t in bits 2..4; [`Texture::LINEAR`], [`Texture::SECOND_UV`].
    pub flags: u32,
    /// Rows of the map from the vertices' coordinates to the image's: `u' = rows[0]·(u, v, 1, 0)`, …; w is 0.
    pub uv_rows: [[f32; 4]; 2],
}

impl Texture {
    /// Flag: red, green and blue are linear. Without it they are sRGB-encoded. Alpha is linear in either case.
    pub const LINEAR: u32 = 16;
    /// Flag: reads the second set of texture coordinates; (0, 0) everywhere in a scene without one.
    pub const SECOND_UV: u32 = 32;
    /// The map that leaves coordinates as they are.
    pub const IDENTITY: [[f32; 4]; 2] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];

    /// An sRGB-encoded image that reads the first set of coordinates as they are.
    ///
    /// ```
    /// use pt_integrator::scene::{Texture, Wrap};
    /// let map = Texture { flags: Texture::LINEAR, ..Texture::new(0, [4, 2], [Wrap::Repeat; 2]) };
    /// assert_eq!((map.width, map.height, map.uv_rows), (4, 2, Texture::IDENTITY));
    /// ```
    pub const fn new(first_texel: u32, [width, height]: [u32; 2], [s, t]: [Wrap; 2]) -> Self {
        Self { first_texel, width, height, flags: Self::wrap_word(s, t), uv_rows: Self::IDENTITY }
    }

    /// The bits of [`Texture::flags`] that say what is outside.
    pub const fn wrap_word(s: Wrap, t: Wrap) -> u32 {
        Wrap::word(s, t)
    }
}
