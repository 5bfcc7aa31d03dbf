//! Images of illumination: a slice of [`Light`], row by row, with the guides of its pixels.

use hashcache_core::glam::Vec3;

use crate::guide::PreparedGuide;

/// A pixel's illumination: rgb, and the variance of its luminance.
///
/// The variance is that of the pixel's mean (its error squared), not of single samples. +∞: unknown. Below 0
/// ([`HOLE`]): the pixel has no illumination; its rgb is not read.
pub type Light = [f32; 4];

/// The variance that marks a pixel without illumination.
pub const HOLE: f32 = -1.0;

/// The largest luminance that counts as light, 2¹⁰⁰: sums of products over a pixel's neighbours stay finite.
pub const LARGEST: f32 = f32::from_bits((127 + 100) << 23);

/// Whether a pixel has no illumination. Light that is not finite, or beyond [`LARGEST`], is none.
#[inline]
pub fn is_hole(light: &Light) -> bool {
    // False for NaN.
    let known = light[3] >= 0.0 && luminance_of(light).abs() <= LARGEST;
    !known
}

/// Luminance of linear Rec. 709 light.
///
/// # Source
/// ITU-R BT.709-6, item 3.2.
#[inline]
pub fn luminance(rgb: Vec3) -> f32 {
    0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z
}

/// Luminance of a pixel's illumination.
#[inline]
pub(crate) fn luminance_of(light: &Light) -> f32 {
    luminance(Vec3::new(light[0], light[1], light[2]))
}

/// The size of an image and the guides of its pixels.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    width: u32,
    height: u32,
    guides: &'a [PreparedGuide],
}

impl<'a> View<'a> {
    /// An image of `width` × `height` pixels; `None` when the number of guides is another, or 0.
    pub fn new(width: u32, height: u32, guides: &'a [PreparedGuide]) -> Option<Self> {
        let pixels = u64::from(width) * u64::from(height);
        (pixels > 0 && pixels == guides.len() as u64).then_some(Self { width, height, guides })
    }

    /// Pixels of a row.
    #[inline]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[inline]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Pixels of the image.
    #[inline]
    pub const fn pixels(&self) -> usize {
        self.guides.len()
    }

    /// The guides, row by row.
    #[inline]
    pub const fn guides(&self) -> &'a [PreparedGuide] {
        self.guides
    }

    /// Whether all pixels up to `reach` away in both directions lie inside.
    #[inline]
    pub const fn is_inner(&self, x: u32, y: u32, reach: u32) -> bool {
        // In u64, so that no sum wraps.
        let (x, y, reach) = (x as u64, y as u64, reach as u64);
        x >= reach && y >= reach && x + reach < self.width as u64 && y + reach < self.height as u64
    }

    /// Index of the pixel at `(x + dx, y + dy)`, unless that is outside.
    #[inline]
    pub fn neighbour(&self, x: u32, y: u32, dx: i32, dy: i32) -> Option<usize> {
        // Wraps below 0 to numbers above any width.
        let (nx, ny) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
        (nx < self.width && ny < self.height).then(|| ny as usize * self.width as usize + nx as usize)
    }
}
