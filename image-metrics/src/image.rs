use crate::Error;

/// A borrowed image: linear light, Rec. 709 primaries, every number finite.
///
/// Pixels lie row by row, from the upper left. Negative values are allowed: filters make them.
///
/// ```
/// use image_metrics::ImageView;
///
/// let pixels = [[0.0, 0.5, 1.0]; 6];
/// let image = ImageView::new(3, 2, &pixels)?;
/// assert_eq!((image.width(), image.height(), image.pixels().len()), (3, 2, 6));
/// # Ok::<(), image_metrics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    pixels: &'a [[f32; 3]],
}

impl<'a> ImageView<'a> {
    /// Looks at `pixels` as an image of `width` × `height`.
    ///
    /// # Errors
    /// [`Error::Size`] when there are no pixels, [`Error::PixelCount`] when the slice has another length,
    /// [`Error::NonFinite`] when a channel is NaN or infinite: such pixels have no error that could be averaged.
    pub fn new(width: usize, height: usize, pixels: &'a [[f32; 3]]) -> Result<Self, Error> {
        let expected = width.checked_mul(height).filter(|&n| n > 0).ok_or(Error::Size { width, height })?;
        if pixels.len() != expected {
            return Err(Error::PixelCount { expected, found: pixels.len() });
        }
        let broken = |p: &[f32; 3]| p.iter().any(|c| !c.is_finite());
        match pixels.iter().position(broken) {
            None => Ok(Self { width, height, pixels }),
            Some(first) => {
                let count = pixels[first..].iter().filter(|p| broken(p)).count();
                Err(Error::NonFinite { count, of: expected, x: first % width, y: first / width })
            }
        }
    }

    /// Width in pixels, above 0.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels, above 0.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row from the upper left.
    pub const fn pixels(&self) -> &'a [[f32; 3]] {
        self.pixels
    }

    /// `Ok` when both images have the same size.
    pub(crate) fn same_size(&self, reference: &Self) -> Result<(), Error> {
        let (image, reference) = ([self.width, self.height], [reference.width, reference.height]);
        if image == reference { Ok(()) } else { Err(Error::SizesDiffer { image, reference }) }
    }

    /// Pairs of channel values, image first, in storage order.
    pub(crate) fn channels_beside(&self, reference: &Self) -> impl Iterator<Item = (f64, f64)> + use<'a> {
        let pairs = self.pixels.iter().zip(reference.pixels);
        pairs.flat_map(|(i, r)| i.iter().zip(r).map(|(&i, &r)| (f64::from(i), f64::from(r))))
    }
}
