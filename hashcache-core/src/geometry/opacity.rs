//! Triangles with holes: which points of a triangle let rays pass.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

use super::OpacityError;
use crate::texel::texel_pair;

/// Where a surface has holes: an image of alpha values and a cutoff. 64 bytes.
///
/// A point lets rays pass where `factor · alpha < cutoff`; alpha is bilinear between texels, 255 is 1.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct OpacityMask {
    /// Index of the upper left value in [`Opacity::alpha`].
    pub first_alpha: u32,
    /// Values a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// [`Wrap::word`](crate::texel::Wrap::word).
    pub wrap: u32,
    /// From the triangle's coordinates to the image's: `u' = rows[0]·(u, v, 1, 0)`, `v' = rows[1]·(u, v, 1, 0)`.
    pub uv_rows: [[f32; 4]; 2],
    /// Values below this let rays pass.
    pub cutoff: f32,
    /// Multiplies all values.
    pub factor: f32,
    /// Zero.
    pub reserved: [u32; 2],
}

/// Steps from one texel's centre to the next: 2¹². The four weights then add up to exactly 2²⁴, and 255 times that
/// still fits 32 bits: an image that is 255 everywhere has alpha 1 to the last bit, so a cutoff of 1 keeps it.
const STEPS: u32 = 1 << 12;

/// The sum that stands for alpha 1.
const ONE: f32 = 255.0 * (STEPS * STEPS) as f32;

impl OpacityMask {
    /// Coordinates taken as they are.
    pub const IDENTITY: [[f32; 4]; 2] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];

    /// Whether the point with these coordinates of the triangle lets rays pass.
    ///
    /// Weights are rounded to 1/4096 of a texel; from there on to the comparison everything is integers. Coordinates
    /// that are not finite are answered too.
    ///
    /// # Panics
    /// When the image is not within `alpha`; see [`Opacity::check`].
    ///
    /// ```
    /// use hashcache_core::geometry::OpacityMask;
    /// use hashcache_core::glam::Vec2;
    /// use hashcache_core::texel::Wrap;
    ///
    /// // Left half empty, right half full.
    /// let mask = OpacityMask {
    ///     first_alpha: 0,
    ///     width: 2,
    ///     height: 1,
    ///     wrap: Wrap::word(Wrap::Clamp, Wrap::Clamp),
    ///     uv_rows: OpacityMask::IDENTITY,
    ///     cutoff: 0.5,
    ///     factor: 1.0,
    ///     reserved: [0; 2],
    /// };
    /// assert!(mask.passes(&[0, 255], Vec2::new(0.4, 0.0)));
    /// assert!(!mask.passes(&[0, 255], Vec2::new(0.6, 0.0)));
    /// ```
    #[inline]
    pub fn passes(&self, alpha: &[u8], uv: Vec2) -> bool {
        let row = |r: &[f32; 4]| r[0] * uv.x + r[1] * uv.y + r[2];
        let x = texel_pair(row(&self.uv_rows[0]), self.width, self.wrap);
        let y = texel_pair(row(&self.uv_rows[1]), self.height, self.wrap >> 2);
        let steps = |fraction: f32| (fraction * STEPS as f32 + 0.5) as u32;
        let (fx, fy) = (steps(x.fraction), steps(y.fraction));
        let across = |y: u32| {
            let at =
                |x: u32| u32::from(alpha[self.first_alpha as usize + y as usize * self.width as usize + x as usize]);
            at(x.first) * (STEPS - fx) + at(x.second) * fx
        };
        let sum = across(y.first) * (STEPS - fy) + across(y.second) * fy;
        self.is_below(sum)
    }

    /// Whether the mask lets rays pass anywhere, as far as its values alone can tell.
    ///
    /// # Panics
    /// As [`OpacityMask::passes`].
    ///
    /// ```
    /// # use hashcache_core::geometry::OpacityMask;
    /// let mut mask: OpacityMask = bytemuck::Zeroable::zeroed();
    /// (mask.width, mask.height, mask.cutoff, mask.factor) = (2, 1, 0.5, 1.0);
    /// assert!(mask.has_holes(&[255, 127]));
    /// assert!(!mask.has_holes(&[255, 128]));
    /// ```
    pub fn has_holes(&self, alpha: &[u8]) -> bool {
        self.has_holes_in(self.alpha_range(alpha))
    }

    /// Smallest and largest of the mask's values. Masks that share an image share them.
    ///
    /// # Panics
    /// As [`OpacityMask::passes`].
    pub fn alpha_range(&self, alpha: &[u8]) -> [u8; 2] {
        let first = self.first_alpha as usize;
        let image = &alpha[first..first + self.width as usize * self.height as usize];
        image.iter().fold([u8::MAX, 0], |[low, high], &x| [low.min(x), high.max(x)])
    }

    /// [`OpacityMask::has_holes`] where the [range](OpacityMask::alpha_range) of the values is known.
    ///
    /// ```
    /// # use hashcache_core::geometry::OpacityMask;
    /// let mut mask: OpacityMask = bytemuck::Zeroable::zeroed();
    /// (mask.cutoff, mask.factor) = (0.5, 1.0);
    /// assert!(mask.has_holes_in([127, 255]));
    /// assert!(!mask.has_holes_in([128, 255]));
    /// ```
    pub fn has_holes_in(&self, range: [u8; 2]) -> bool {
        // What lies between values lies between their ends, so the extremes speak for all.
        range.iter().any(|&x| self.is_below(u32::from(x) * STEPS * STEPS))
    }

    #[inline]
    fn is_below(&self, sum: u32) -> bool {
        self.factor * (sum as f32) < self.cutoff * ONE
    }
}

/// The holes of a geometry's triangles. Empty ([`Opacity::NONE`]) where no triangle has any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Opacity<'a> {
    /// For each triangle the index of its mask, or `u32::MAX`; an empty slice: no triangle has one.
    pub mask_of_triangle: &'a [u32],
    /// Masks.
    pub masks: &'a [OpacityMask],
    /// For each triangle the coordinates of its corners that its mask reads; empty when no triangle has a mask.
    pub uv: &'a [[[f32; 2]; 3]],
    /// Alpha values of all masks, rows from the top, 255 is 1.
    pub alpha: &'a [u8],
}

impl Opacity<'_> {
    /// No holes.
    pub const NONE: Self = Self { mask_of_triangle: &[], masks: &[], uv: &[], alpha: &[] };

    /// `mask_of_triangle` of a triangle without a mask.
    pub const NO_MASK: u32 = u32::MAX;

    /// Whether any triangle has a mask.
    pub fn is_in_use(&self) -> bool {
        self.mask_of_triangle.iter().any(|&mask| mask != Self::NO_MASK)
    }

    /// Whether a ray passes the triangle at these barycentric weights of its second and third corner.
    ///
    /// # Panics
    /// When there are coordinates for fewer triangles, or a mask's image is not there; see [`Opacity::check`].
    #[inline]
    pub fn passes(&self, triangle: u32, u: f32, v: f32) -> bool {
        let Some(&mask) = self.mask_of_triangle.get(triangle as usize) else { return false };
        if mask == Self::NO_MASK {
            return false;
        }
        let [a, b, c] = self.uv[triangle as usize].map(Vec2::from_array);
        self.masks[mask as usize].passes(self.alpha, a * (1.0 - u - v) + b * u + c * v)
    }

    /// Checks everything that [`Opacity::passes`] relies on, for a geometry of so many triangles.
    ///
    /// # Errors
    /// The first thing found wrong.
    ///
    /// ```
    /// # use hashcache_core::geometry::{Opacity, OpacityError};
    /// assert_eq!(Opacity::NONE.check(7), Ok(()));
    /// let short = Opacity { mask_of_triangle: &[u32::MAX], ..Opacity::NONE };
    /// let refused = OpacityError::Length { list: "masks of triangles", found: 1, expected: 7 };
    /// assert_eq!(short.check(7), Err(refused));
    /// ```
    pub fn check(&self, triangles: usize) -> Result<(), OpacityError> {
        if self.mask_of_triangle.is_empty() {
            return Ok(());
        }
        let length = |list, found: usize| {
            let (found, expected) = (found as u64, triangles as u64);
            if found == expected { Ok(()) } else { Err(OpacityError::Length { list, found, expected }) }
        };
        length("masks of triangles", self.mask_of_triangle.len())?;
        if self.is_in_use() {
            length("coordinates of masks", self.uv.len())?;
        }
        let index = |at, element: usize, index: u64, length: usize| {
            let (element, length) = (element as u64, length as u64);
            if index < length { Ok(()) } else { Err(OpacityError::Index { at, element, index, length }) }
        };
        for (triangle, &mask) in self.mask_of_triangle.iter().enumerate() {
            if mask != Self::NO_MASK {
                index("triangle's mask", triangle, mask.into(), self.masks.len())?;
            }
        }
        for (number, mask) in self.masks.iter().enumerate() {
            let values = u64::from(mask.width) * u64::from(mask.height);
            // Sides are compared and counted as signed numbers, mirrored ones twice.
            if values == 0 || mask.width.max(mask.height) >= 1 << 30 {
                return Err(OpacityError::Size { mask: number as u64, width: mask.width, height: mask.height });
            }
            index("mask's image", number, u64::from(mask.first_alpha) + values - 1, self.alpha.len())?;
            let numbers = [mask.cutoff, mask.factor];
            if !numbers.iter().chain(mask.uv_rows.as_flattened()).all(|x| x.is_finite()) {
                return Err(OpacityError::Number { at: "mask", element: number as u64 });
            }
        }
        match self.uv.iter().position(|uv| !uv.as_flattened().iter().all(|x| x.is_finite())) {
            None => Ok(()),
            Some(triangle) => Err(OpacityError::Number { at: "coordinates of masks", element: triangle as u64 }),
        }
    }
}
