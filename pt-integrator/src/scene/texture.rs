//! Textures.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
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

    /// Where coordinates of a vertex lie on the image, by [`Texture::uv_rows`].
    ///
    /// ```
    /// use pt_integrator::glam::Vec2;
    /// use pt_integrator::scene::{Texture, Wrap};
    /// let mut turned = Texture::new(0, [1, 1], [Wrap::Repeat; 2]);
    /// turned.uv_rows = [[0.0, 2.0, 0.5, 0.0], [-1.0, 0.0, 0.0, 0.0]];
    /// assert_eq!(turned.map(Vec2::new(3.0, 1.0)), Vec2::new(2.5, -3.0));
    /// ```
    #[inline]
    pub fn map(&self, uv: Vec2) -> Vec2 {
        let row = |r: &[f32; 4]| r[0] * uv.x + r[1] * uv.y + r[2];
        Vec2::new(row(&self.uv_rows[0]), row(&self.uv_rows[1]))
    }

    /// Which of a triangle's two sets of coordinates the texture reads; zeros in place of a set that there is not.
    #[inline]
    pub(crate) fn reads(&self, first: &[[f32; 2]; 3], second: Option<&[[f32; 2]; 3]>) -> [Vec2; 3] {
        let uv = if self.flags & Self::SECOND_UV == 0 { *first } else { second.copied().unwrap_or_default() };
        uv.map(Vec2::from_array)
    }

    /// The bits of [`Texture::flags`] that say what is outside.
    pub const fn wrap_word(s: Wrap, t: Wrap) -> u32 {
        Wrap::word(s, t)
    }
}
