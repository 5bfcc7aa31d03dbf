//! What is told about each frame.

use hashcache::Image;
use hashcache::clock::Elapsed;
use hashcache::scene::View;
use image_metrics::{Error, flicker};
use serde::Serialize;

use crate::figures::{Figures, view};
use crate::table::cell;

/// A frame's figures, as summary.json holds them. What is not known is null there and an empty cell in metrics.csv.
#[derive(Debug, Serialize)]
pub struct Frame {
    index: usize,
    time_s: f64,
    cpu_s: f64,
    relmse: Option<f64>,
    relmse_trimmed: Option<f64>,
    ms_ssim: Option<f64>,
    flip: Option<f64>,
    energy_ratio: Option<f64>,
    flicker: Option<f64>,
}

/// A frame as the next one sees it.
pub struct Previous {
    pub image: Image,
    pub reference: Option<Image>,
    pub view: View,
    pub light: f32,
}

impl Frame {
    /// Measures a frame beside the one before it.
    pub fn measure(index: usize, elapsed: Elapsed, now: &Previous, before: Option<&Previous>) -> Result<Self, Error> {
        let figures = match &now.reference {
            Some(reference) => Some(Figures::measure(view(&now.image)?, view(reference)?)?),
            None => None,
        };
        let [relmse, relmse_trimmed, ms_ssim, flip, energy_ratio] =
            figures.map_or([None; 5], |figures| figures.values());
        let flicker = before.map_or(Ok(None), |before| now.flicker(before))?;
        let Elapsed { wall_s, cpu_s } = elapsed;
        Ok(Self { index, time_s: wall_s, cpu_s, relmse, relmse_trimmed, ms_ssim, flip, energy_ratio, flicker })
    }

    /// The names of metrics.csv's columns.
    pub fn columns() -> Vec<String> {
        let times = ["frame", "time_s", "cpu_s"].into_iter();
        times.chain(Figures::NAMES).chain(["flicker"]).map(str::to_owned).collect()
    }

    /// A row of metrics.csv.
    pub fn cells(&self) -> Vec<String> {
        let Self { index, time_s, cpu_s, relmse, relmse_trimmed, ms_ssim, flip, energy_ratio, flicker } = self;
        let figures = [relmse, relmse_trimmed, ms_ssim, flip, energy_ratio, flicker];
        let times = [index.to_string(), time_s.to_string(), cpu_s.to_string()];
        times.into_iter().chain(figures.into_iter().map(|value| cell(*value))).collect()
    }

    pub fn relmse(&self) -> Option<f64> {
        self.relmse
    }

    pub fn flicker(&self) -> Option<f64> {
        self.flicker
    }
}

impl Previous {
    /// The flicker from the frame `before` to this one; `None` where what should have changed is not known.
    fn flicker(&self, before: &Self) -> Result<Option<f64>, Error> {
        let rests = self.view == before.view && self.light.to_bits() == before.light.to_bits();
        let references = match (&before.reference, &self.reference) {
            (Some(before), Some(now)) => Some([before, now]),
            (Some(one), None) | (None, Some(one)) if rests => Some([one, one]),
            (None, None) if rests => Some([&before.image, &before.image]),
            _ => None,
        };
        let Some([r0, r1]) = references else { return Ok(None) };
        flicker([view(&before.image)?, view(&self.image)?], [view(r0)?, view(r1)?]).map(Some)
    }
}
