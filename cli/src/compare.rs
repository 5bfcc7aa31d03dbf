//! `hashcache compare`: how far an image is from a reference.

use std::fmt::Write as _;
use std::path::Path;

use hashcache::image_file::{self, Image};
use image_metrics::{Error, ImageView, energy_ratio, mse, psnr};
use serde::Serialize;

use crate::args::Compare;
use crate::failure::Failure;
use crate::figures::{self, Figures};
use crate::heat_map::HeatMap;

/// What is printed. Its JSON keys are stable; more may stand beside them.
#[derive(Serialize)]
struct Report {
    image: String,
    reference: String,
    width: u32,
    height: u32,
    #[serde(flatten)]
    figures: Figures,
    mse: f64,
    /// None when a screen shows the same.
    psnr_db: Option<f64>,
    energy_ratio_rgb: [Option<f64>; 3],
}

/// What the command prints.
pub fn run(args: &Compare) -> Result<String, Failure> {
    let heat_map = args.heat_map.as_deref();
    let heat_map = heat_map.map(|path| HeatMap::check(path, args.heat_map_of, [&args.image, &args.reference]));
    let heat_map = heat_map.transpose()?;
    let (image, reference) = (image_file::read(&args.image)?, image_file::read(&args.reference)?);
    let (image, reference) = (view(&args.image, &image)?, view(&args.reference, &reference)?);
    let failed = |error: Error| Failure::other(format!("{}: {error}", args.image.display()));
    let report = Report::new(args, image, reference).map_err(failed)?;
    if let Some(heat_map) = heat_map {
        let picture = heat_map.draw(image, reference).map_err(failed)?;
        heat_map.write(&picture)?;
    }
    if args.json {
        serde_json::to_string(&report).map(|line| line + "\n").map_err(|error| Failure::other(error.to_string()))
    } else {
        Ok(report.text())
    }
}

fn view<'a>(path: &Path, image: &'a Image) -> Result<ImageView<'a>, Failure> {
    figures::view(image)
        .map_err(|error| Failure::other(format!("{}: {error}; such an image has no error to measure", path.display())))
}

impl Report {
    fn new(args: &Compare, image: ImageView, reference: ImageView) -> Result<Self, Error> {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        Ok(Self {
            image: args.image.display().to_string(),
            reference: args.reference.display().to_string(),
            width: image.width() as u32,
            height: image.height() as u32,
            figures: Figures::measure(image, reference)?,
            mse: mse(image, reference)?,
            psnr_db: finite(psnr(image, reference)?),
            energy_ratio_rgb: energy_ratio(image, reference)?.channels.map(finite),
        })
    }

    fn text(&self) -> String {
        let or = |value: Option<f64>, decimals: usize, otherwise: &str| {
            value.map_or(otherwise.to_owned(), |value| format!("{value:.decimals$}"))
        };
        let [r, g, b] = self.energy_ratio_rgb.map(|ratio| or(ratio, 6, "none"));
        let Figures { relmse, relmse_trimmed, ms_ssim, flip, energy_ratio } = self.figures;
        let mut text = String::new();
        let mut row = |name: &str, value: &str| {
            let _ = writeln!(text, "{name:<16}{value}");
        };
        row("relMSE", &figure(relmse));
        row("  less 0.1 %", &format!("{} (without the worst 0.1 % of pixels)", figure(relmse_trimmed)));
        row("MSE", &figure(self.mse));
        row("PSNR", &self.psnr_db.map_or("infinite: equal on a screen".to_owned(), |db| format!("{db:.3} dB")));
        row("MS-SSIM", &or(ms_ssim, 6, "none: it needs 176x176 pixels"));
        row("FLIP", &format!("{} (67 pixels a degree)", figure(flip)));
        row("energy ratio", &format!("{} (red {r}, green {g}, blue {b})", or(energy_ratio, 6, "none")));
        text
    }
}

/// Five digits that count, and no exponent where none is needed.
fn figure(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value) { format!("{value:.6}") } else { format!("{value:.4e}") }
}
