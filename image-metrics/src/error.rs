use core::fmt;

/// Why images could not be compared.
///
/// ```
/// let error = image_metrics::ImageView::new(1, 2, &[[0.0; 3], [f32::NAN, 0.0, 1.0]]).unwrap_err();
/// assert_eq!(error.to_string(), "1 of 2 pixels is NaN or infinite, the first at x = 0, y = 1");
/// ```
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The image has no pixels, or more than can be counted.
    Size {
        /// Width asked for, in pixels.
        width: usize,
        /// Height asked for, in pixels.
        height: usize,
    },
    /// The slice does not hold width × height pixels.
    PixelCount {
        /// Width × height.
        expected: usize,
        /// Pixels in the slice.
        found: usize,
    },
    /// Some pixels have a NaN or infinite channel.
    NonFinite {
        /// How many pixels.
        count: usize,
        /// Pixels of the image.
        of: usize,
        /// Column of the first, from the left.
        x: usize,
        /// Row of the first, from the top.
        y: usize,
    },
    /// Two images that should be compared differ in size.
    SizesDiffer {
        /// Width and height of the image.
        image: [usize; 2],
        /// Width and height of the reference.
        reference: [usize; 2],
    },
    /// The image is too small for the five scales of MS-SSIM.
    TooSmall {
        /// Width and height of the image.
        size: [usize; 2],
        /// The least width and height.
        least: usize,
    },
    /// Fewer than two runs: their variance is unknown.
    TooFewRuns {
        /// Runs given.
        runs: usize,
    },
    /// Some pixels of a variance image are negative.
    NegativeVariance {
        /// How many pixels.
        count: usize,
    },
    /// The margin of a test is negative or NaN.
    Margin,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Size { width, height } => write!(f, "an image of {width}x{height} pixels cannot be compared"),
            Self::PixelCount { expected, found } => write!(f, "{expected} pixels expected, {found} given"),
            Self::NonFinite { count, of, x, y } => {
                let verb = if count == 1 { "is" } else { "are" };
                write!(f, "{count} of {of} pixels {verb} NaN or infinite, the first at x = {x}, y = {y}")
            }
            Self::SizesDiffer { image: [w, h], reference: [rw, rh] } => {
                write!(f, "the image is {w}x{h} and the reference {rw}x{rh} pixels; they must be equal")
            }
            Self::TooSmall { size: [w, h], least } => {
                write!(f, "MS-SSIM needs {least}x{least} pixels or more for its five scales, the image is {w}x{h}")
            }
            Self::TooFewRuns { runs } => write!(f, "two runs or more are needed to know their variance, {runs} given"),
            Self::NegativeVariance { count } => write!(f, "{count} pixels of the variance image are negative"),
            Self::Margin => write!(f, "the margin must be 0 or more"),
        }
    }
}

impl core::error::Error for Error {}
