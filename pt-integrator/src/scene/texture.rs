//! Base colour textures.

use bytemuck::{Pod, Zeroable};

/// An image in the scene's list of texels. 16 bytes.
///
/// Texels are RGBA8 words, red in the lowest byte, sRGB-encoded, rows from the top. Centres lie at
/// `((i + 0.5) / width, (j + 0.5) / height)`; texels are decoded before the bilinear filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Texture {
    /// Index of the upper left texel.
    pub first_texel: u32,
    /// Texels a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// [`Wrap`] of s in bits 0..2, of t in bits 2..4.
    pub wrap: u32,
}

/// What a texture shows outside of `[0, 1)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Wrap {
    /// The image again.
    Repeat = 0,
    /// Its border texels.
    Clamp = 1,
    /// The image again, every second time mirrored.
    Mirror = 2,
}

impl Texture {
    /// The word that [`Texture::wrap`] holds.
    pub const fn wrap_word(s: Wrap, t: Wrap) -> u32 {
        s as u32 | (t as u32) << 2
    }
}
