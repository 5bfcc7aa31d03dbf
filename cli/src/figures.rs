//! How far a picture is from its reference, in the figures that all commands show.

use hashcache::Image;
use image_metrics::{Error, ImageView, energy_ratio, flip, ms_ssim, rel_mse, rel_mse_trimmed};
use serde::Serialize;

/// The difference of a picture from its reference. Its JSON keys are stable, and the same in all files.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    pub relmse: f64,
    pub relmse_trimmed: f64,
    /// None below 176×176 pixels.
    pub ms_ssim: Option<f64>,
    /// LDR-FLIP, 0 to 1.
    pub flip: f64,
    /// None when the reference alone is black.
    pub energy_ratio: Option<f64>,
}

impl Figures {
    /// Their names, in the order of [`Figures::values`].
    pub const NAMES: [&str; 5] = ["relmse", "relmse_trimmed", "ms_ssim", "flip", "energy_ratio"];

    /// Measures a picture.
    pub fn measure(image: ImageView, reference: ImageView) -> Result<Self, Error> {
        Ok(Self {
            relmse: rel_mse(image, reference)?,
            relmse_trimmed: rel_mse_trimmed(image, reference)?,
            ms_ssim: match ms_ssim(image, reference) {
                Err(Error::TooSmall { .. }) => None,
                other => Some(other?),
            },
            flip: flip(image, reference)?,
            energy_ratio: Some(energy_ratio(image, reference)?.whole).filter(|ratio| ratio.is_finite()),
        })
    }

    /// The figures; what does not exist is `None`.
    pub fn values(&self) -> [Option<f64>; 5] {
        [Some(self.relmse), Some(self.relmse_trimmed), self.ms_ssim, Some(self.flip), self.energy_ratio]
    }
}

/// A picture as the metrics take it.
pub fn view(image: &Image) -> Result<ImageView<'_>, Error> {
    ImageView::new(image.width as usize, image.height as usize, &image.pixels)
}
