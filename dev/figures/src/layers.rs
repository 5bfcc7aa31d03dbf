//! Layered filtering beside filtering by what is seen first, where mirrors and glass are seen.

use hashcache::{Image, Preview};
use image_metrics::{ImageView, WORST_SHARE, rel_mse, rel_mse_trimmed};

use crate::arguments::Arguments;
use crate::still::Still;
use crate::table;

/// Farthest taps in pixels.
const RADII: [&str; 6] = ["1", "2", "4", "8", "12", "20"];

/// Samples at which the radius has shrunk to a pixel; 0: it never shrinks.
const SAMPLES: [&str; 4] = ["0", "150", "600", "2400"];

/// Frames at rest.
const FRAMES: [u32; 2] = [1, 8];

/// A filter at some strength.
struct Found {
    /// relMSE over the pixels that count, the same without the worst of them, and over the whole picture.
    error: f64,
    trimmed: f64,
    whole: f64,
    strength: String,
}

/// For each scene the error of both filters, each at its best strength, over the pixels that show a mirror or glass first and
/// something diffuse in it.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!(
        "{}; relMSE over the pixels that show a mirror or glass first and something diffuse in it, each filter at that of {} \
         strengths with the least; trimmed: without the worst {} % of those pixels; ratios: layered over screen\n",
        arguments.changed(),
        RADII.len() * SAMPLES.len(),
        100.0 * WORST_SHARE,
    );
    let strengths: Vec<_> = RADII.iter().flat_map(|radius| SAMPLES.map(|samples| (*radius, samples))).collect();
    table::head(&[
        "scene",
        "frames",
        "pixels",
        "filter",
        "radius / samples",
        "relMSE",
        "trimmed",
        "of the picture",
        "ratio",
        "trimmed ratio",
    ]);
    for name in arguments.scenes(&["builtin:interior", "cornell-specular"]) {
        let still = Still::read(&name)?;
        let shown = mask(&still.open(&arguments.settings(&[("spp", "1")])?)?)?;
        let share = shown.iter().filter(|shown| **shown).count() as f64 / shown.len() as f64;
        for frames in FRAMES {
            let none = best(&still, arguments, frames, &shown, "none", &[("0", "0")])?;
            let [screen, layered] =
                ["screen", "layered"].map(|filter| best(&still, arguments, frames, &shown, filter, &strengths));
            let (screen, layered) = (screen?, layered?);
            let ratios = [layered.error / screen.error, layered.trimmed / screen.trimmed].map(table::ratio);
            let blank = || [String::new(), String::new()];
            let rows = [("none", none, blank()), ("screen", screen, blank()), ("layered", layered, ratios)];
            for (filter, found, [ratio, trimmed]) in rows {
                table::row(&[
                    name.clone(),
                    frames.to_string(),
                    format!("{:.1} %", 100.0 * share),
                    filter.to_owned(),
                    found.strength,
                    table::error(found.error),
                    table::error(found.trimmed),
                    table::error(found.whole),
                    ratio,
                    trimmed,
                ]);
            }
        }
    }
    Ok(())
}

/// The strength with the least error after some frames at rest.
fn best(
    still: &Still,
    arguments: &Arguments,
    frames: u32,
    shown: &[bool],
    filter: &str,
    strengths: &[(&str, &str)],
) -> Result<Found, String> {
    let say = |error: hashcache::Error| error.to_string();
    let preview = still.open(&arguments.settings(&[("filter", filter)])?)?;
    let mut backend = preview.backend().map_err(say)?;
    let mut session = preview.session(&mut backend).map_err(say)?;
    for _ in 0..frames {
        session.frame(preview.camera(), &mut |_| ()).map_err(say)?;
    }
    let mut best: Option<Found> = None;
    for (radius, samples) in strengths {
        let mut settings = preview.settings().clone();
        if filter != "none" {
            for (key, value) in [("filter.radius", radius), ("filter.samples", samples)] {
                settings.set(key, value).map_err(|error| error.to_string())?;
            }
        }
        let image = session.filtered(&settings).map_err(say)?.ok_or("the settings keep no sums")?;
        let [error, trimmed] = errors(&image, &still.reference, &|i| shown[i])?;
        if best.as_ref().is_none_or(|best| error < best.error) {
            let [whole, _] = errors(&image, &still.reference, &|_| true)?;
            best = Some(Found { error, trimmed, whole, strength: format!("{radius} / {samples}") });
        }
    }
    best.ok_or_else(|| "no strength to try".to_owned())
}

/// Pixels that show nothing diffuse first, and something diffuse behind it.
fn mask(preview: &Preview) -> Result<Vec<bool>, String> {
    let say = |error: hashcache::Error| error.to_string();
    let mut backend = preview.backend().map_err(say)?;
    let mut session = preview.session(&mut backend).map_err(say)?;
    session.frame(preview.camera(), &mut |_| ()).map_err(say)?;
    let aovs = session.aovs().map_err(say)?;
    let is_dark = |pixel: &[f32; 3]| pixel.iter().all(|&c| c <= 0.0);
    let first = aovs.iter().find(|(name, _)| *name == "albedo").ok_or("the settings keep no albedo")?;
    let behind: Vec<_> =
        aovs.iter().filter(|(name, _)| name.starts_with("layer") && name.ends_with("_albedo")).collect();
    let shows = |i: usize| is_dark(&first.1.pixels[i]) && behind.iter().any(|(_, image)| !is_dark(&image.pixels[i]));
    Ok((0..first.1.pixels.len()).map(shows).collect())
}

/// relMSE over the pixels that count, and the same without the worst of them.
fn errors(image: &Image, reference: &Image, counts: &dyn Fn(usize) -> bool) -> Result<[f64; 2], String> {
    // Neither error knows neighbours, so pixels may stand in a row.
    let row = |image: &Image| -> Vec<[f32; 3]> {
        image.pixels.iter().enumerate().filter(|(i, _)| counts(*i)).map(|(_, pixel)| *pixel).collect()
    };
    let say = |error: image_metrics::Error| error.to_string();
    let (image, reference) = (row(image), row(reference));
    let [image, reference] = [&image, &reference].map(|row| ImageView::new(row.len(), 1, row).map_err(say));
    let (image, reference) = (image?, reference?);
    Ok([rel_mse(image, reference).map_err(say)?, rel_mse_trimmed(image, reference).map_err(say)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_that_count_have_errors() {
        let black = Image { width: 2000, height: 1, pixels: vec![[0.0; 3]; 2000] };
        let mut image = black.clone();
        // Of the thousand that count one is the worst 0.1 %; the others do not count.
        image.pixels[7] = [10.0; 3];
        image.pixels[1500] = [10.0; 3];
        let [all, trimmed] = errors(&image, &black, &|i| i < 1000).unwrap();
        assert!((all - 10.0).abs() < 1e-9 && trimmed == 0.0, "{all} {trimmed}");
        let [all, _] = errors(&image, &black, &|_| true).unwrap();
        assert!((all - 10.0).abs() < 1e-9);
        assert!(errors(&image, &black, &|_| false).is_err(), "no pixel has no error");
    }
}
