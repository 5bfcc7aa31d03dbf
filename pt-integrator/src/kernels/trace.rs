//! Kernels that trace paths.

use core::marker::PhantomData;

use backend_api::{Access, BindingDecl, Kernel, Launch};
use bytemuck::Pod;
use glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Sampler;

use super::TraceParams;
use super::shared::{COUNTERS, SCENE, TEXELS, TRIANGLES, Tracing, tracing_bindings};
use crate::film::{FilmPixel, MomentPixel, PairedPixel};
use crate::path::{MAX_STORED, PathOutcome, PathSettings, trace_path, trace_path_vertices};
use crate::sampler::{Sobol, pixel_seed, vertex_seed};

/// Traces `samples` paths through each pixel and adds their radiance to the film.
///
/// Bindings: triangles, scene, texels, film ([`FilmPixel`] for each item), counters. Parameters: [`TraceParams`].
/// Paths whose radiance is NaN or infinite count as black samples, raise
/// [`Status::NON_FINITE`](backend_api::Status::NON_FINITE) and are counted.
pub static TRACE_FILM: Kernel = film_kernel::<FilmPixel>("pt.trace_film", trace_film::<FilmPixel>);

/// [`TRACE_FILM`] into a film of [`MomentPixel`]: the same radiance, and how it scatters.
pub static TRACE_MOMENTS: Kernel = film_kernel::<MomentPixel>("pt.trace_moments", trace_film::<MomentPixel>);

/// Traces `samples` paths for each half of the pixels that a film of [`PairedPixel`] names; the halves' numbers are
/// independent of each other.
///
/// Bindings and parameters as those of [`TRACE_FILM`]; [`TraceParams::first_pixel`] is not read. Item i is element i of
/// the film, whichever pixel that is.
pub static TRACE_PAIRS: Kernel = film_kernel::<PairedPixel>("pt.trace_pairs", trace_pairs);

const _: () = assert!(TRACE_FILM.is_well_formed() && TRACE_MOMENTS.is_well_formed() && TRACE_PAIRS.is_well_formed());

/// Bindings of kernels that trace into a film of such pixels.
struct FilmOf<P>(PhantomData<P>);

impl<P> FilmOf<P> {
    const BINDINGS: [BindingDecl; 5] = [
        TRIANGLES,
        SCENE,
        TEXELS,
        BindingDecl { name: "pt_film", access: Access::OutPerItem, stride: size_of::<P>() as u32 },
        COUNTERS,
    ];
}

const fn film_kernel<P: 'static>(name: &'static str, body: fn(&mut Launch<'_>)) -> Kernel {
    Kernel {
        name,
        bindings: &FilmOf::<P>::BINDINGS,
        params_size: size_of::<TraceParams>() as u32,
        body,
        wgsl: None,
        casts_rays: true,
    }
}

/// A pixel that samples are added to.
trait Film: Pod {
    fn add(&mut self, radiance: Vec3);
}

impl Film for FilmPixel {
    #[inline(always)]
    fn add(&mut self, radiance: Vec3) {
        self.add(radiance);
    }
}

impl Film for MomentPixel {
    #[inline(always)]
    fn add(&mut self, radiance: Vec3) {
        self.add(radiance);
    }
}

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

fn trace_film<P: Film>(launch: &mut Launch<'_>) {
    let pixels = launch.output::<P>(3);
    let params = launch.params::<TraceParams>();
    let Some(mut tracing) = Tracing::new(launch) else { return };
    let settings = params.settings();
    for (item, film) in launch.items().zip(pixels) {
        tracing.trace_pixel(params, settings, params.first_pixel + item, params.seed, film);
    }
    tracing.finish(launch);
}

fn trace_pairs(launch: &mut Launch<'_>) {
    let pixels = launch.output::<PairedPixel>(3);
    let params = launch.params::<TraceParams>();
    let Some(mut tracing) = Tracing::new(launch) else { return };
    let settings = params.settings();
    for pair in pixels {
        for (k, half) in (0..).zip(&mut pair.halves) {
            tracing.trace_pixel(params, settings, pair.pixel, params.seed.wrapping_add(k), half);
        }
    }
    tracing.finish(launch);
}

impl Tracing<'_> {
    /// All samples of one pixel.
    #[inline(always)]
    fn trace_pixel<P: Film>(
        &mut self,
        params: &TraceParams,
        settings: PathSettings,
        index: u32,
        seed: u32,
        film: &mut P,
    ) {
        let seed = pixel_seed(index, seed);
        for sample in 0..params.samples {
            let mut sampler = Sobol::new(params.first_sample.wrapping_add(sample), seed);
            let ray = params.camera.ray(params.pixel(index), sampler.next_2d());
            let Self { scene, caster, counts } = self;
            film.add(trace_path(scene, caster, &mut sampler, &ray, &settings, counts).radiance());
        }
    }
}
