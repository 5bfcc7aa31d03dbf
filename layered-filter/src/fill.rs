//! Fills holes, and finds the variance of pixels whose own samples do not tell it, both from like neighbours.

use hashcache_core::glam::Vec4;

use crate::atrous::TWENTY_FIVE;
use crate::image::{HOLE, Light, View, is_hole, luminance_of};
use crate::mean::{Mean, add_at};
use crate::weights::Weights;

/// Rings that are searched for a hole's neighbours: 1, 2, 4 … 2⁵ = 32 pixels away. A hole is a cell's size wide, which
/// is a few pixels; what is farther than 32 is another place.
pub const RINGS: u32 = 6;

/// What [`fill`] did to a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// The pixel had illumination.
    Kept,
    /// A hole that neighbours filled.
    Filled,
    /// A hole without a like neighbour; it stays one and counts as black.
    Empty,
}

/// The pixel with its hole filled and its variance known, as far as neighbours help.
///
/// A hole gets the mean of its eight neighbours on the nearest ring where any has light, weighted by guides. An unknown
/// variance is replaced by that of the luminances in the 5×5 pixels around, weighted by guides, where at least
/// two say something.
///
/// # Source
/// Roth et al. 2020, section 3.3, item 2 (holes; there without weights); Schied et al. 2017, section 4.2 (variance).
#[inline]
pub fn fill(weights: &Weights, view: &View<'_>, input: &[Light], x: u32, y: u32) -> (Light, Filled) {
    let p = y as usize * view.width() as usize + x as usize;
    let own = &input[p];
    if is_hole(own) {
        return match neighbours_mean(weights, view, input, x, y) {
            Some(light) => (light, Filled::Filled),
            None => (*own, Filled::Empty),
        };
    }
    let [r, g, b, variance] = *own;
    if weights.by_deviation() && variance == f32::INFINITY && view.guides()[p].has_vertex() {
        return ([r, g, b, spatial_variance(weights, view, input, x, y)], Filled::Kept);
    }
    (*own, Filled::Kept)
}

#[inline(never)]
fn neighbours_mean(weights: &Weights, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Option<Light> {
    const AROUND: [(i32, i32); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    let guides = view.guides();
    let guide = &guides[y as usize * view.width() as usize + x as usize];
    let around = weights.luminance_of(None, 0.0);
    (0..RINGS).find_map(|ring| {
        let mut mean = Mean::new(weights, guide, &[0.0, 0.0, 0.0, HOLE], around);
        for four in AROUND.as_chunks::<4>().0 {
            let near = four.map(|(dx, dy)| view.neighbour(x, y, dx << ring, dy << ring));
            let factor = near.map(|q| f32::from(q.is_some()));
            // The pixel itself is a hole and is left out.
            let own = y as usize * view.width() as usize + x as usize;
            add_at(&mut mean, guides, input, near.map(|q| q.unwrap_or(own)), Vec4::from_array(factor));
        }
        mean.finish()
    })
}

#[inline(never)]
fn spatial_variance(weights: &Weights, view: &View<'_>, input: &[Light], x: u32, y: u32) -> f32 {
    let guides = view.guides();
    let p = y as usize * view.width() as usize + x as usize;
    // About the pixel's own luminance, so that squares do not cancel.
    let base = luminance_of(&input[p]);
    let [mut total, mut squares, mut sum, mut sum_of_squares] = [Vec4::ZERO; 4];
    for four in TWENTY_FIVE.as_chunks::<4>().0 {
        let near = four.map(|(dx, dy, _)| view.neighbour(x, y, dx, dy).filter(|&q| !is_hole(&input[q])));
        let counted = Vec4::from_array(near.map(|q| f32::from(q.is_some())));
        // What does not count has the pixel's own luminance: no difference.
        let at = near.map(|q| q.unwrap_or(p));
        let weight = weights.guides_of_four(&guides[p], at.map(|q| &guides[q])) * counted;
        let difference = Vec4::from_array(at.map(|q| luminance_of(&input[q]) - base));
        total += weight;
        squares += weight * weight;
        sum += weight * difference;
        sum_of_squares += weight * difference * difference;
    }
    let total = 1.0 + total.element_sum();
    let mean = sum.element_sum() / total;
    let variance = (sum_of_squares.element_sum() / total - mean * mean).max(0.0);
    // Bessel's correction for weighted values; none left when all the weight is the pixel's own.
    let rest = 1.0 - (1.0 + squares.element_sum()) / (total * total);
    if rest > 1e-3 { (variance / rest).min(f32::MAX) } else { f32::INFINITY }
}
