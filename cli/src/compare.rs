//! `hashcache compare`: how far an image is from a reference.

use std::fmt::Write as _;
use std::path::Path;

use hashcache::image_file::{self, Image};
use image_metrics::{Error, ImageView, energy_ratio, ms_ssim, mse, psnr, rel_mse, rel_mse_trimmed};
use serde::Serialize;

use crate::args::Compare;
use crate::failure::Failure;

/// What is printed. Its JSON keys are stable; more may stand beside them.
#[derive(Serialize)]
struct Report {
    image: String,
    reference: String,
    width: u32,
    height: u32,
    relmse: f64,
    relmse_trimmed: f64,
    mse: f64,
    /// None when a screen shows the same.
    psnr_db: Option<f64>,
    /// None below 176×176 pixels.
    ms_ssim: Option<f64>,
    /// None when the reference alone is black.
    energy_ratio: Option<f64>,
    energy_ratio_rgb: [Option<f64>; 3],
}

/// What the command prints.
pub fn run(args: &Compare) -> Result<String, Failure> {
    let (image, reference) = (image_file::read(&args.image)?, image_file::read(&args.reference)?);
    let report = Report::new(args, view(&args.image, &image)?, view(&args.reference, &reference)?)
        .map_err(|error| Failure::other(format!("{}: {error}", args.image.display())))?;
    if args.json {
        serde_json::to_string(&report).map(|line| line + "\n").map_err(|error| Failure::other(error.to_string()))
    } else {
        Ok(report.text())
    }
}

fn view<'a>(path: &Path, image: &'a Image) -> Result<ImageView<'a>, Failure> {
    ImageView::new(image.width as usize, image.height as usize, &image.pixels)
        .map_err(|error| Failure::other(format!("{}: {error}; such an image has no error to measure", path.display())))
}

impl Report {
    fn new(args: &Compare, image: ImageView, reference: ImageView) -> Result<Self, Error> {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let energy = energy_ratio(image, reference)?;
        let ms_ssim = match ms_ssim(image, reference) {
            Err(Error::TooSmall { .. }) => None,
            other => Some(other?),
        };
        Ok(Self {
            image: args.image.display().to_string(),
            reference: args.reference.display().to_string(),
            width: image.width() as u32,
            height: image.height() as u32,
            relmse: rel_mse(image, reference)?,
            relmse_trimmed: rel_mse_trimmed(image, reference)?,
            mse: mse(image, reference)?,
            psnr_db: finite(psnr(image, reference)?),
            ms_ssim,
            energy_ratio: finite(energy.whole),
            energy_ratio_rgb: energy.channels.map(finite),
        })
    }

    fn text(&self) -> String {
        let or = |value: Option<f64>, decimals: usize, otherwise: &str| {
            value.map_or(otherwise.to_owned(), |value| format!("{value:.decimals$}"))
        };
        let [r, g, b] = self.energy_ratio_rgb.map(|ratio| or(ratio, 6, "none"));
        let mut text = String::new();
        let mut row = |name: &str, value: &str| {
            let _ = writeln!(text, "{name:<16}{value}");
        };
        row("relMSE", &figure(self.relmse));
        row("  less 0.1 %", &format!("{} (without the worst 0.1 % of pixels)", figure(self.relmse_trimmed)));
        row("MSE", &figure(self.mse));
        row("PSNR", &self.psnr_db.map_or("infinite: equal on a screen".to_owned(), |db| format!("{db:.3} dB")));
        row("MS-SSIM", &or(self.ms_ssim, 6, "none: it needs 176x176 pixels"));
        row("energy ratio", &format!("{} (red {r}, green {g}, blue {b})", or(self.energy_ratio, 6, "none")));
        text
    }
}

/// Five digits that count, and no exponent where none is needed.
fn figure(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value) { format!("{value:.6}") } else { format!("{value:.4e}") }
}
