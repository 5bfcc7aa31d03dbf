//! What features cost that a scene does without, by measurement.

use std::iter;

use backend_api::{Binding, Error as BackendError, Items};
use hashcache_core::stages::CastsRays;
use pt_integrator::camera::CameraRays;
use pt_integrator::film::FilmPixel;
use pt_integrator::kernels::{TRACE_FILM, TraceParams};
use pt_integrator::path::PathSettings;

use super::{Error, Resident, create};
use crate::clock;
use crate::feature::{FEATURES, FeatureSet, Saving};
use crate::preview::Preview;

/// Columns and rows of the picture that is traced.
const PROBE: [u32; 2] = [128, 128];

/// Samples a pixel of one run.
const SAMPLES: u32 = 4;

/// Runs of each variant, in turn; the fastest counts.
const ROUNDS: u32 = 5;

/// The least CPU-seconds of runs with some features forced.
struct Variant {
    /// The index of the feature among the savings; none for the scene as it is.
    saving: Option<usize>,
    /// Bits of the tracing loop.
    bits: u32,
    least: f64,
}

/// Fills in what each feature of the tracing loop would add to a sample, in CPU-nanoseconds.
pub(crate) fn savings<B: CastsRays>(backend: &mut B, preview: &Preview, saved: &mut [Saving]) -> Result<(), Error> {
    let mut variants = variants(saved);
    backend.set_geometry(&preview.geometry())?;
    let pixels = PROBE[0] * PROBE[1];
    let resident = Resident::new(backend, preview.packed(), pixels)?;
    let measured = match create(backend, "film", u64::from(pixels) * size_of::<FilmPixel>() as u64) {
        Ok(film) => {
            let measured = measure(backend, preview, &resident, film, &mut variants);
            backend.destroy(film.buffer).and(measured)
        }
        Err(error) => Err(error),
    };
    resident.release(backend).and(measured)?;
    let base = variants[0].least;
    for Variant { saving, least, .. } in &variants {
        if let Some(index) = saving {
            saved[*index].ns_per_sample = Some((least - base) * 1e9 / f64::from(pixels * SAMPLES));
        }
    }
    Ok(())
}

/// The scene as it is, and with each feature of the tracing loop that it does without.
fn variants(saved: &[Saving]) -> Vec<Variant> {
    let bits = |saving: &Saving| {
        let feature = FEATURES.iter().find(|feature| feature.name == saving.feature && !feature.is_layers())?;
        Some(FeatureSet::of(feature).loop_bits())
    };
    let forced = saved.iter().enumerate().filter_map(|(index, saving)| Some((Some(index), bits(saving)?)));
    let all = iter::once((None, 0)).chain(forced);
    all.map(|(saving, bits)| Variant { saving, bits, least: f64::INFINITY }).collect()
}

/// Traces each variant some times.
fn measure<B: CastsRays>(
    backend: &mut B,
    preview: &Preview,
    resident: &Resident,
    film: Binding,
    variants: &mut [Variant],
) -> Result<(), BackendError> {
    let (camera, settings) = (preview.camera(), preview.settings());
    let params = TraceParams {
        camera: CameraRays::new(camera).with_size([camera.width, camera.height], PROBE),
        width: PROBE[0],
        first_pixel: 0,
        first_sample: 0,
        samples: SAMPLES,
        seed: settings.seed,
        max_bounces: settings.max_bounces,
        roulette_depth: settings.roulette_depth.unwrap_or(PathSettings::NO_ROULETTE),
        store_length: u32::MAX,
    };
    let bindings = [resident.triangles, resident.scene, resident.texels, film, resident.counters];
    for _ in 0..ROUNDS {
        for Variant { bits, least, .. } in &mut *variants {
            let needs = preview.packed().forced_needs(*bits);
            backend.write(resident.scene.buffer, 0, bytemuck::bytes_of(&needs))?;
            let (run, elapsed) = clock::measure(|| {
                backend.dispatch(&TRACE_FILM, bytemuck::bytes_of(&params), &bindings, Items::Count(resident.pixels))?;
                backend.submit()?;
                backend.statuses().map(|_| ())
            });
            run?;
            *least = least.min(elapsed.cpu_s);
        }
    }
    Ok(())
}
