//! The error of each pixel as a colour.

use std::path::Path;

use colorous::MAGMA;
use hashcache::image_file::{self, Format, Image};
use hashcache::{ToneMapping, srgb_decode};
use image_metrics::{Error, ImageView, flip_map, rel_mse_map};

use crate::args::HeatMetric;
use crate::failure::Failure;
use crate::interrupt::uninterrupted;
use crate::place::{Place, Staged};

/// Where a heat map is to be.
pub struct HeatMap {
    place: Place,
    metric: HeatMetric,
}

impl HeatMap {
    /// The file that a path names, if it is none of `inputs` and takes colours.
    pub fn check(path: &Path, metric: HeatMetric, inputs: [&Path; 2]) -> Result<Self, Failure> {
        if image_file::format_of(path).ok() != Some(Format::Png) {
            let line = format!("--heat-map {}: it is colours for a screen; name a .png", path.display());
            return Err(Failure::usage(line));
        }
        let place = uninterrupted(|| Place::check(path))?;
        place.refuse_inputs(inputs)?;
        Ok(Self { place, metric })
    }

    /// Draws it.
    pub fn draw(&self, image: ImageView, reference: ImageView) -> Result<Image, Error> {
        let errors: Vec<f64> = match self.metric {
            HeatMetric::Flip => flip_map(image, reference)?.into_iter().map(f64::from).collect(),
            HeatMetric::Relative => rel_mse_map(image, reference)?.into_iter().map(f64::sqrt).collect(),
        };
        let pixels = errors.into_iter().map(color).collect();
        Ok(Image { width: image.width() as u32, height: image.height() as u32, pixels })
    }

    /// Writes it, whole or not at all.
    pub fn write(self, image: &Image) -> Result<(), Failure> {
        uninterrupted(|| self.place.stage_image(image, ToneMapping::default()).and_then(Staged::commit))
    }
}

/// The colour of an error from 0 to 1, linear; that of 1 for all above.
///
/// Source: magma of Smith & van der Walt 2015, in which equal steps look equal, and brightness alone tells them too.
fn color(error: f64) -> [f32; 3] {
    let color = MAGMA.eval_continuous(error.clamp(0.0, 1.0));
    color.into_array().map(|byte| srgb_decode(f32::from(byte) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_magma_and_brighten_with_the_error() {
        let bytes = |error| color(error).map(|x| ToneMapping::default().byte(x));
        // The ends of matplotlib's table.
        assert_eq!((bytes(0.0), bytes(1.0)), ([0, 0, 4], [252, 253, 191]));
        assert_eq!((bytes(f64::INFINITY), bytes(7.0)), (bytes(1.0), bytes(1.0)));
        let light = |error| color(error).iter().zip([0.2126, 0.7152, 0.0722]).map(|(x, w)| x * w).sum::<f32>();
        let lights: Vec<f32> = (0..=64).map(|i| light(f64::from(i) / 64.0)).collect();
        assert!(lights.windows(2).all(|pair| pair[0] < pair[1]), "{lights:?}");
    }
}
