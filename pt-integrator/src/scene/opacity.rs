//! Holes in triangles, in lists.

use alloc::vec::Vec;

use hashcache_core::geometry::{Opacity, OpacityMask};

/// Holes in triangles as a loader lists them; empty where there are none. [`Opacity::check`] says what fits together.
///
/// The ray caster alone reads it: a ray passes a hole as if there were no triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpacityData {
    /// For each triangle in [`SceneData::indices`](super::SceneData::indices) the index of its mask, or
    /// [`Opacity::NO_MASK`]; empty: no triangle has one.
    pub mask_of_triangle: Vec<u32>,
    /// Masks.
    pub masks: Vec<OpacityMask>,
    /// For each triangle the coordinates of its corners that its mask reads; empty when no triangle has a mask.
    pub uv: Vec<[[f32; 2]; 3]>,
    /// Alpha values of all masks, rows from the top, 255 is 1.
    pub alpha: Vec<u8>,
}

impl OpacityData {
    /// The lists, borrowed.
    pub fn view(&self) -> Opacity<'_> {
        Opacity { mask_of_triangle: &self.mask_of_triangle, masks: &self.masks, uv: &self.uv, alpha: &self.alpha }
    }
}
