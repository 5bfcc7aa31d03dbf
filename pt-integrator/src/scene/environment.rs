//! Light from outside of the scene.

use alloc::vec::Vec;

/// What a ray sees that leaves the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// The same radiance (linear Rec. 709) from everywhere.
    Constant([f32; 3]),
    /// A picture of all directions.
    Image(EnvironmentImage),
}

/// An equirectangular picture of radiance.
///
/// +y is up, the image's centre is −z and u grows towards +x: `u = 0.5 + atan2(x, −z)/2π`, `v = acos(y)/π` from the
/// top row. Bilinear between texel centres `((i + 0.5)/width, (j + 0.5)/height)`, repeated in u, clamped in v.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// Texels a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// Radiance, linear Rec. 709, rows from the top; w is unused.
    pub texels: Vec<[f32; 4]>,
}
