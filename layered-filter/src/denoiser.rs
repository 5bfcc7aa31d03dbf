//! What a denoiser is: a pure function of a pixel's neighbourhood, pass by pass.

use crate::image::{Light, View};

/// Removes noise from an image of illumination, guided by the vertices that its pixels show.
///
/// A denoiser runs in passes; each reads the whole image that the pass before wrote, and one call computes one pixel of
/// one pass. So any number of threads and any split into rows give the same bits, and a GPU can do it too.
/// It knows one layer at a time: [`crate::layers`] calls it for each.
///
/// # Laws
/// - `pixel` depends on its arguments only, and not on pixels that the pass writes.
/// - The result is a mean with weights that are not negative and add up to 1: an image of one colour stays as it is, and
///   no result is outside the range of the input.
/// - A pixel that nothing may be mixed into keeps its value; a pixel without a vertex keeps its value.
/// - NaN in guides of other pixels changes nothing.
///
/// # Example
/// The mean over a row of three, wherever there is a vertex:
///
/// ```
/// use layered_filter::{Denoiser, GuideRecord, GuideScale, Light, PreparedGuide, View, filter};
///
/// struct Box3;
///
/// impl Denoiser for Box3 {
///     fn passes(&self) -> u32 {
///         1
///     }
///
///     fn pixel(&self, _pass: u32, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Light {
///         let mut mean = [0.0; 4];
///         let near = [-1, 0, 1].map(|dx| view.neighbour(x, y, dx, 0));
///         let valid = || near.into_iter().flatten().filter(|&i| view.guides()[i].has_vertex());
///         for i in valid() {
///             for (sum, value) in mean.iter_mut().zip(input[i]) {
///                 *sum += value / valid().count() as f32;
///             }
///         }
///         mean
///     }
/// }
///
/// let scale = GuideScale::new(1.0)?;
/// let vertex = GuideRecord { normal_segment: [0.0, 0.0, 1.0, 1.0], albedo_shininess: [0.5, 0.5, 0.5, 0.0], ..GuideRecord::NONE };
/// let guides = [PreparedGuide::new(&scale, &vertex); 5];
/// let view = View::new(5, 1, &guides).unwrap();
/// let mut image = [0.0, 0.0, 3.0, 0.0, 0.0].map(|v| [v, v, v, 0.0]);
/// filter(&Box3, &view, &mut image, &mut [[0.0; 4]; 5]);
/// assert_eq!(image.map(|light| light[0]), [0.0, 1.0, 1.0, 1.0, 0.0]);
/// # Ok::<(), hashcache_core::error::ParamError>(())
/// ```
pub trait Denoiser {
    /// Number of passes.
    fn passes(&self) -> u32;

    /// Pixel `(x, y)` after pass `pass`, from the whole image before it.
    fn pixel(&self, pass: u32, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Light;
}

/// One pass over the pixels from `first` on, as many as `output` has: any split of an image gives the same image.
///
/// # Panics
/// When `input` has fewer pixels than the view, or `first` and `output` reach beyond it.
pub fn filter_pixels<D: Denoiser + ?Sized>(
    denoiser: &D,
    pass: u32,
    view: &View<'_>,
    input: &[Light],
    first: usize,
    output: &mut [Light],
) {
    assert!(input.len() >= view.pixels() && first + output.len() <= view.pixels(), "slices of the view's size");
    let width = view.width() as usize;
    let (mut x, mut y) = ((first % width) as u32, (first / width) as u32);
    for out in output {
        *out = denoiser.pixel(pass, view, input, x, y);
        x += 1;
        if x == view.width() {
            (x, y) = (0, y + 1);
        }
    }
}

/// All passes over an image, on this thread; `scratch` has as many pixels.
///
/// # Panics
/// When a slice has another number of pixels than the view.
pub fn filter<D: Denoiser + ?Sized>(denoiser: &D, view: &View<'_>, image: &mut [Light], scratch: &mut [Light]) {
    assert!(image.len() == view.pixels() && scratch.len() == view.pixels(), "slices of the view's size");
    for pass in 0..denoiser.passes() {
        filter_pixels(denoiser, pass, view, image, 0, scratch);
        image.copy_from_slice(scratch);
    }
}
