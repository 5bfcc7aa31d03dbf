//! Kernels that trace paths.

use core::sync::atomic::Ordering;

use backend_api::{Access, BindingDecl, Kernel, Launch, Status};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::LaunchRays;

use super::TraceParams;
use crate::film::FilmPixel;
use crate::packed::SceneTriangle;
use crate::path::{PathOutcome, RayCounts, trace_path};
use crate::sampler::{Sobol, pixel_seed, vertex_seed};
use crate::view::SceneView;

const TRIANGLES: BindingDecl =
    BindingDecl { name: "pt_triangles", access: Access::In, stride: size_of::<SceneTriangle>() as u32 };
const SCENE: BindingDecl = BindingDecl { name: "pt_scene", access: Access::In, stride: 4 };
const TEXELS: BindingDecl = BindingDecl { name: "pt_texels", access: Access::In, stride: 4 };
const COUNTERS: BindingDecl = BindingDecl { name: "pt_counters", access: Access::AtomicU64, stride: 8 };

/// Traces `samples` paths through each pixel and adds their radiance to the film.
///
/// Bindings: triangles, scene, texels, film ([`FilmPixel`] for each item), counters. Parameters: [`TraceParams`].
/// Paths whose radiance is NaN or infinite count as black samples, raise [`Status::NON_FINITE`] and are counted.
pub static TRACE_FILM: Kernel = Kernel {
    name: "pt.trace_film",
    bindings: &[
        TRIANGLES,
        SCENE,
        TEXELS,
        BindingDecl { name: "pt_film", access: Access::OutPerItem, stride: size_of::<FilmPixel>() as u32 },
        COUNTERS,
    ],
    params_size: size_of::<TraceParams>() as u32,
    body: trace_film,
    wgsl: None,
    casts_rays: true,
};

/// Traces one path through each pixel and writes its first vertex.
///
/// Bindings: triangles, scene, texels, records ([`VertexRecord`] for each item), counters. Parameters:
/// [`TraceParams`]. Paths whose radiance is NaN or infinite leave a record without light, raise
/// [`Status::NON_FINITE`] and are counted.
pub static TRACE_RECORDS: Kernel = Kernel {
    name: "pt.trace_records",
    bindings: &[
        TRIANGLES,
        SCENE,
        TEXELS,
        BindingDecl { name: "pt_records", access: Access::OutPerItem, stride: size_of::<VertexRecord>() as u32 },
        COUNTERS,
    ],
    params_size: size_of::<TraceParams>() as u32,
    body: trace_records,
    wgsl: None,
    casts_rays: true,
};

fn trace_film(launch: &mut Launch<'_>) {
    let pixels = launch.output::<FilmPixel>(3);
    run(launch, pixels, |params, pixel, path| {
        for sample in 0..params.samples {
            pixel.add(path(params.first_sample.wrapping_add(sample)).0.radiance());
        }
    });
}

fn trace_records(launch: &mut Launch<'_>) {
    let records = launch.output::<VertexRecord>(3);
    run(launch, records, |params, record, path| {
        let (outcome, seed) = path(params.first_sample);
        *record = outcome.record(params.camera.pixel_angle(), seed);
    });
}

/// Runs `item` for each item's output; the function it is given traces the path of one sample of the item's pixel and
/// returns the vertex's seed along.
#[inline]
fn run<T>(
    launch: &Launch<'_>,
    output: &mut [T],
    mut item: impl FnMut(&TraceParams, &mut T, &mut dyn FnMut(u32) -> (PathOutcome, u32)),
) {
    let params = launch.params::<TraceParams>();
    let Some(scene) = SceneView::new(launch.input(0), launch.input(1), launch.input(2)) else {
        debug_assert!(false, "the scene buffer was not packed by this crate");
        return;
    };
    let caster = LaunchRays(launch.rays());
    let settings = params.settings();
    let mut counts = RayCounts::default();
    for (k, output) in output.iter_mut().enumerate() {
        let index = params.first_pixel + launch.first + k as u32;
        let pixel = [index % params.width, index / params.width];
        let seed = pixel_seed(index, params.seed);
        item(params, output, &mut |sample| {
            let mut sampler = Sobol::new(sample, seed);
            let ray = params.camera.ray(pixel, hashcache_core::traits::Sampler::next_2d(&mut sampler));
            let outcome = trace_path(&scene, &caster, &mut sampler, &ray, &settings, &mut counts);
            (outcome, vertex_seed(seed, sample))
        });
    }
    for (counter, count) in launch.atomic_u64(4).iter().zip(counts.to_words()) {
        counter.fetch_add(count, Ordering::Relaxed);
    }
    if counts.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
}
