//! The errors of a picture.

use hashcache::Image;
use image_metrics::{ImageView, energy_ratio, flip, ms_ssim, rel_mse, rel_mse_trimmed};

use crate::table;

/// How far a picture is from its reference.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    /// relMSE.
    pub relmse: f64,
    /// relMSE without the worst 0.1 % of pixels.
    pub trimmed: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// MS-SSIM.
    pub ms_ssim: f64,
    /// ΣI/ΣR.
    pub energy: f64,
}

impl Score {
    /// The columns of [`Score::cells`].
    pub const COLUMNS: [&'static str; 5] = ["relMSE", "trimmed", "FLIP", "MS-SSIM", "energy"];

    /// Compares a picture with its reference.
    pub fn of(image: &Image, reference: &Image) -> Result<Self, String> {
        let (image, reference) = (view(image)?, view(reference)?);
        let say = |error: image_metrics::Error| error.to_string();
        Ok(Self {
            relmse: rel_mse(image, reference).map_err(say)?,
            trimmed: rel_mse_trimmed(image, reference).map_err(say)?,
            flip: flip(image, reference).map_err(say)?,
            ms_ssim: ms_ssim(image, reference).map_err(say)?,
            energy: energy_ratio(image, reference).map_err(say)?.whole,
        })
    }

    /// relMSE alone, for pictures too small for the other errors.
    pub fn relmse(image: &Image, reference: &Image) -> Result<f64, String> {
        rel_mse(view(image)?, view(reference)?).map_err(|error| error.to_string())
    }

    /// The errors as a table's cells.
    pub fn cells(&self) -> [String; 5] {
        [
            table::error(self.relmse),
            table::error(self.trimmed),
            format!("{:.3}", self.flip),
            format!("{:.4}", self.ms_ssim),
            format!("{:.4}", self.energy),
        ]
    }
}

fn view(image: &Image) -> Result<ImageView<'_>, String> {
    ImageView::new(image.width as usize, image.height as usize, &image.pixels).map_err(|error| error.to_string())
}
