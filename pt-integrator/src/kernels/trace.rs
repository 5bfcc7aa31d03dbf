//! Kernels that trace paths.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Sampler;

use super::TraceParams;
use super::shared::{COUNTERS, SCENE, TEXELS, TRIANGLES, Tracing, tracing_bindings};
use crate::film::FilmPixel;
use crate::path::{MAX_STORED, PathOutcome, trace_path, trace_path_vertices};
use crate::sampler::{Sobol, pixel_seed, vertex_seed};

/// Traces `samples` paths through each pixel and adds their radiance to the film.
///
/// Bindings: triangles, scene, texels, film ([`FilmPixel`] for each item), counters. Parameters: [`TraceParams`].
/// Paths whose radiance is NaN or infinite count as black samples, raise
/// [`Status::NON_FINITE`](backend_api::Status::NON_FINITE) and are counted.
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

/// Traces one path through each pixel and writes its first vertex: [`trace_records`] of one vertex.
pub static TRACE_RECORDS: Kernel = Records::<1>::kernel("pt.trace_records");

static TRACE_MORE: [Kernel; MAX_STORED - 1] = [
    Records::<2>::kernel("pt.trace_records_2"),
    Records::<3>::kernel("pt.trace_records_3"),
    Records::<4>::kernel("pt.trace_records_4"),
    Records::<5>::kernel("pt.trace_records_5"),
    Records::<6>::kernel("pt.trace_records_6"),
    Records::<7>::kernel("pt.trace_records_7"),
    Records::<8>::kernel("pt.trace_records_8"),
];

/// The kernel that traces one path through each pixel and writes its first `store` vertices that scatter diffusely, 1 to
/// [`MAX_STORED`]; `None` for other numbers.
///
/// Bindings: triangles, scene, texels, records (`store` times [`VertexRecord`] for each item, the first vertex first),
/// counters. Parameters: [`TraceParams`]. Records behind a path's end are zero, so not valid; the further vertices'
/// have [`VertexRecord::SECONDARY`] set, the product of all albedos from the camera as `throughput`, the path's length
/// in their footprint and a seed of their own. Paths whose radiance is NaN or infinite leave records without light,
/// raise [`Status::NON_FINITE`](backend_api::Status::NON_FINITE) and are counted.
///
/// A cache that is fed by a picture of another size than the one shown: [`TraceParams::camera`] of
/// [`CameraRays::with_size`](crate::camera::CameraRays::with_size).
///
/// ```
/// use pt_integrator::kernels::trace_records;
/// assert_eq!(trace_records(3).unwrap().bindings[3].stride, 3 * 96);
/// assert!(trace_records(0).is_none());
/// ```
pub fn trace_records(store: u32) -> Option<&'static Kernel> {
    match store {
        1 => Some(&TRACE_RECORDS),
        _ => TRACE_MORE.get(store.checked_sub(2)? as usize),
    }
}

/// Paths of which `STORE` vertices are kept.
struct Records<const STORE: usize>;

impl<const STORE: usize> Records<STORE> {
    const BINDINGS: [BindingDecl; 5] = tracing_bindings((STORE * size_of::<VertexRecord>()) as u32);

    const fn kernel(name: &'static str) -> Kernel {
        Kernel {
            name,
            bindings: &Self::BINDINGS,
            params_size: size_of::<TraceParams>() as u32,
            body: Self::run,
            wgsl: None,
            casts_rays: true,
        }
    }

    fn run(launch: &mut Launch<'_>) {
        let records = launch.output::<VertexRecord>(3);
        let params = launch.params::<TraceParams>();
        let Some(mut tracing) = Tracing::new(launch) else { return };
        let settings = params.vertex_settings();
        let angle = params.camera.pixel_angle();
        for (item, records) in launch.items().zip(records.chunks_exact_mut(STORE)) {
            let index = params.first_pixel + item;
            let seed = pixel_seed(index, params.seed);
            let mut sampler = Sobol::new(params.first_sample, seed);
            let ray = params.camera.ray(params.pixel(index), sampler.next_2d());
            let mut vertices = [PathOutcome::NONE; STORE];
            let Tracing { scene, caster, counts } = &mut tracing;
            trace_path_vertices(scene, caster, &mut sampler, &ray, &settings, &mut vertices, counts);
            let seed = vertex_seed(seed, params.first_sample);
            for (k, (record, vertex)) in (0..).zip(records.iter_mut().zip(&vertices)) {
                let seed = if k == 0 { seed } else { vertex_seed(seed, k) };
                // Behind the path's end there is nothing at all, not even a seed.
                let written = k == 0 || vertex.has_vertex;
                *record = if written { vertex.record(angle, seed) } else { bytemuck::Zeroable::zeroed() };
            }
        }
        tracing.finish(launch);
    }
}

fn trace_film(launch: &mut Launch<'_>) {
    let pixels = launch.output::<FilmPixel>(3);
    let params = launch.params::<TraceParams>();
    let Some(mut tracing) = Tracing::new(launch) else { return };
    let settings = params.settings();
    for (item, film) in launch.items().zip(pixels) {
        let index = params.first_pixel + item;
        let seed = pixel_seed(index, params.seed);
        for sample in 0..params.samples {
            let mut sampler = Sobol::new(params.first_sample.wrapping_add(sample), seed);
            let ray = params.camera.ray(params.pixel(index), sampler.next_2d());
            let Tracing { scene, caster, counts } = &mut tracing;
            film.add(trace_path(scene, caster, &mut sampler, &ray, &settings, counts).radiance());
        }
    }
    tracing.finish(launch);
}
