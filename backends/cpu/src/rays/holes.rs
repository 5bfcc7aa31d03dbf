//! Triangles with holes: which meetings a ray passes as if nothing were there.
//!
//! The traversal is compiled twice, with [`Solid`] and with [`Masked`]. A scene without masks runs the first, in which
//! nothing here is left. In the second, the word of a triangle in its block says whether it has a mask; only then is
//! anything looked up.

use std::collections::HashMap;

use hashcache_core::geometry::{Geometry, Opacity, OpacityMask};

/// What is asked of a meeting before it counts.
pub(super) trait Holes: Copy {
    /// The triangle's number, from its word in a block.
    fn number(self, word: u32) -> u32;

    /// Whether the ray passes the triangle at these barycentric weights of its second and third corner.
    fn passes(self, word: u32, weights: impl FnOnce() -> [f32; 2]) -> bool;
}

/// No triangle has a hole.
#[derive(Clone, Copy)]
pub(super) struct Solid;

impl Holes for Solid {
    #[inline(always)]
    fn number(self, word: u32) -> u32 {
        word
    }

    #[inline(always)]
    fn passes(self, _: u32, _: impl FnOnce() -> [f32; 2]) -> bool {
        false
    }
}

/// Bit of a triangle's word that says that it has a mask. Numbers stay below it: a scene has fewer than 2³⁰ triangles.
pub(super) const MASKED: u32 = 1 << 30;

/// Some triangles have masks.
#[derive(Clone, Copy)]
pub(super) struct Masked<'a> {
    /// The masks.
    pub(super) masks: &'a Masks,
    /// Instance and triangle of each number; empty: numbers are those of the scene's triangles.
    pub(super) names: &'a [[u32; 2]],
}

impl Holes for Masked<'_> {
    #[inline(always)]
    fn number(self, word: u32) -> u32 {
        // Unused places keep all bits set, and are never met.
        word & !MASKED
    }

    #[inline(always)]
    fn passes(self, word: u32, weights: impl FnOnce() -> [f32; 2]) -> bool {
        word & MASKED != 0 && self.looked_up(self.number(word), weights())
    }
}

impl Masked<'_> {
    #[inline(never)]
    fn looked_up(self, number: u32, [u, v]: [f32; 2]) -> bool {
        let triangle = self.names.get(number as usize).map_or(number, |name| name[1]);
        self.masks.view().passes(self.masks.slots[triangle as usize], u, v)
    }
}

/// A scene's masks: coordinates of the triangles that have one, the others leave 4 bytes.
pub(super) struct Masks {
    /// For each triangle of the scene its place in the next two lists, or `u32::MAX`.
    slots: Vec<u32>,
    mask_of_slot: Vec<u32>,
    uv: Vec<[[f32; 2]; 3]>,
    kinds: Vec<OpacityMask>,
    alpha: Vec<u8>,
}

impl Masks {
    /// The masks of a checked geometry; `None` when no ray could pass any.
    pub(super) fn new(geometry: &Geometry<'_>) -> Option<Self> {
        let opacity = &geometry.opacity;
        // Many masks may share an image, which is looked through once.
        let mut ranges = HashMap::new();
        let is_open = |mask: &OpacityMask| {
            let image = (mask.first_alpha, mask.width, mask.height);
            mask.has_holes_in(*ranges.entry(image).or_insert_with(|| mask.alpha_range(opacity.alpha)))
        };
        let open: Vec<bool> = opacity.masks.iter().map(is_open).collect();
        let mut masks =
            Self { slots: Vec::new(), mask_of_slot: Vec::new(), uv: Vec::new(), kinds: Vec::new(), alpha: Vec::new() };
        for (triangle, &mask) in opacity.mask_of_triangle.iter().enumerate() {
            if mask == Opacity::NO_MASK || !open[mask as usize] {
                masks.slots.push(u32::MAX);
                continue;
            }
            masks.slots.push(masks.mask_of_slot.len() as u32);
            masks.mask_of_slot.push(mask);
            masks.uv.push(opacity.uv[triangle]);
        }
        if masks.mask_of_slot.is_empty() {
            return None;
        }
        masks.kinds.extend_from_slice(opacity.masks);
        masks.alpha.extend_from_slice(opacity.alpha);
        Some(masks)
    }

    /// Whether a triangle of the scene has holes.
    pub(super) fn has(&self, triangle: u32) -> bool {
        self.slots[triangle as usize] != u32::MAX
    }

    /// Bytes of all lists.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.slots.as_slice())
            + size_of_val(self.mask_of_slot.as_slice())
            + size_of_val(self.uv.as_slice())
            + size_of_val(self.kinds.as_slice())
            + self.alpha.len()
    }

    #[inline]
    fn view(&self) -> Opacity<'_> {
        Opacity { mask_of_triangle: &self.mask_of_slot, masks: &self.kinds, uv: &self.uv, alpha: &self.alpha }
    }
}
