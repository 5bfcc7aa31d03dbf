//! Errors that change from frame to frame.

use crate::{Error, ImageView, REL_MSE_EPSILON};

/// Flicker: the mean over pixels and channels of ((I₁ − I₀) − (R₁ − R₀))² / (R₁² + ε), with ε = [`REL_MSE_EPSILON`].
///
/// `frames` are I₀ and I₁, a frame and the next one, `references` what they should be. Errors that are the same in both
/// frames don't flicker. Noise of relMSE e that is new in each frame flickers by 2·e. Where the view rests, both
/// references are the same picture; when it is not known, I₀ in its place twice leaves the change itself, relMSE(I₁, I₀).
///
/// # Errors
/// [`Error::SizesDiffer`] when any two sizes differ.
///
/// # Units
/// None: a ratio, 0 for a sequence that changes as its references do.
///
/// # Source
/// Chaitanya et al. 2017, the temporal loss: the mean difference of finite differences in time.
///
/// # Deviation
/// The difference is squared and relative as in [`rel_mse`](crate::rel_mse), so that both figures of a frame compare.
///
/// ```
/// # use image_metrics::{ImageView, flicker};
/// let [dark, light] = [[[1.0; 3]; 4], [[2.0; 3]; 4]];
/// let [dark, light] = [ImageView::new(2, 2, &dark)?, ImageView::new(2, 2, &light)?];
/// // Too dark by the same amount in both frames: wrong, but steady.
/// assert_eq!(flicker([dark, dark], [light, light])?, 0.0);
/// assert!((flicker([dark, light], [dark, dark])? - 1.0 / 1.01).abs() < 1e-12);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn flicker(frames: [ImageView; 2], references: [ImageView; 2]) -> Result<f64, Error> {
    let [before, now] = frames;
    let [should_before, should_now] = references;
    for other in [before, should_before, should_now] {
        now.same_size(&other)?;
    }
    let change = now.channels_beside(&before);
    let should_change = should_now.channels_beside(&should_before);
    let errors = change.zip(should_change).map(|((i1, i0), (r1, r0))| {
        let error = (i1 - i0) - (r1 - r0);
        error * error / (r1 * r1 + REL_MSE_EPSILON)
    });
    Ok(errors.sum::<f64>() / (3 * now.pixels().len()) as f64)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these laws are exact")]
mod tests {
    use super::*;
    use crate::rel_mse;

    const N: usize = 64 * 64;

    /// A number from −1 to 1 for each channel of a frame.
    fn noise(frame: u32) -> impl Fn(usize) -> f32 {
        move |i| {
            let mut h = (i as u32 ^ frame.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
            h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
            h ^= h >> 16;
            h as f32 / u32::MAX as f32 * 2.0 - 1.0
        }
    }

    fn noisy(base: f32, frame: u32, size: f32) -> Vec<[f32; 3]> {
        let noise = noise(frame);
        (0..N).map(|p| core::array::from_fn(|c| base + size * noise(3 * p + c))).collect()
    }

    fn view(pixels: &[[f32; 3]]) -> ImageView<'_> {
        ImageView::new(64, 64, pixels).unwrap()
    }

    #[test]
    fn new_noise_flickers_by_twice_its_error() {
        let [a, b] = [noisy(1.0, 1, 0.1), noisy(3.0, 2, 0.3)];
        let [ra, rb] = [noisy(1.0, 0, 0.0), noisy(3.0, 0, 0.0)];
        let found = flicker([view(&a), view(&b)], [view(&ra), view(&rb)]).unwrap();
        // Frame 1's error is added at frame 2's scale, a third of its own.
        let expected = rel_mse(view(&b), view(&rb)).unwrap() + rel_mse(view(&a), view(&ra)).unwrap() * 1.01 / 9.01;
        // 12,288 products of independent errors: their mean is off by less than 5 % at five standard deviations.
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
        let same = flicker([view(&a), view(&a)], [view(&ra), view(&ra)]).unwrap();
        assert_eq!(same, 0.0);
    }

    #[test]
    fn at_rest_without_a_reference_it_is_the_relative_change() {
        let [a, b] = [noisy(1.0, 1, 0.1), noisy(1.0, 2, 0.1)];
        let [a, b] = [view(&a), view(&b)];
        assert_eq!(flicker([a, b], [a, a]).unwrap(), rel_mse(b, a).unwrap());
    }

    #[test]
    fn sizes_and_extremes() {
        let all = [[f32::MAX; 3], [-f32::MAX; 3]];
        let [wide, high] = [ImageView::new(2, 1, &all).unwrap(), ImageView::new(1, 2, &all).unwrap()];
        assert!(matches!(flicker([wide, wide], [wide, high]), Err(Error::SizesDiffer { .. })));
        assert!(matches!(flicker([high, wide], [wide, wide]), Err(Error::SizesDiffer { .. })));
        let black = [[0.0; 3]; 2];
        let black = ImageView::new(2, 1, &black).unwrap();
        assert!(flicker([wide, black], [black, black]).unwrap().is_finite());
        assert_eq!(flicker([black, black], [black, black]).unwrap(), 0.0);
    }
}
