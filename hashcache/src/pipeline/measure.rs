//! What features cost that a scene does without, by measurement.

use backend_api::Items;
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

/// Fills in what each feature of the tracing loop would add to a sample, in CPU-nanoseconds.
pub(crate) fn savings<B: CastsRays>(backend: &mut B, preview: &Preview, saved: &mut [Saving]) -> Result<(), Error> {
    let named =
        |saving: &Saving| FEATURES.iter().find(|feature| feature.name == saving.feature && !feature.is_layers());
    let mut variants = vec![(None, 0, f64::INFINITY)];
    for (index, saving) in saved.iter().enumerate() {
        variants.extend(named(saving).map(|feature| (Some(index), FeatureSet::of(feature).loop_bits(), f64::INFINITY)));
    }
    backend.set_geometry(&preview.geometry())?;
    let pixels = PROBE[0] * PROBE[1];
    let resident = Resident::new(backend, preview.packed(), pixels)?;
    let film = create(backend, "film", u64::from(pixels) * size_of::<FilmPixel>() as u64)?;
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
    for _ in 0..ROUNDS {
        for (_, bits, least) in &mut variants {
            let mut forced = preview.packed().clone();
            forced.force_needs(*bits);
            backend.write(resident.scene.buffer, 0, forced.scene_bytes())?;
            let bindings = [resident.triangles, resident.scene, resident.texels, film, resident.counters];
            let (run, elapsed) = clock::measure(|| {
                backend.dispatch(&TRACE_FILM, bytemuck::bytes_of(&params), &bindings, Items::Count(pixels))?;
                backend.submit()?;
                backend.statuses().map(|_| ())
            });
            run?;
            *least = least.min(elapsed.cpu_s);
        }
    }
    let base = variants[0].2;
    for (index, _, least) in variants {
        if let Some(index) = index {
            saved[index].ns_per_sample = Some((least - base) * 1e9 / f64::from(pixels * SAMPLES));
        }
    }
    for buffer in [resident.triangles, resident.scene, resident.texels, film, resident.counters] {
        backend.destroy(buffer.buffer)?;
    }
    Ok(())
}
