//! Kernels between records and images.

use backend_api::{Access, BindingDecl, Kernel, Launch, Status};
use glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

use super::ComposeParams;
use crate::film::FilmPixel;

const RECORDS: BindingDecl =
    BindingDecl { name: "pt_records", access: Access::In, stride: size_of::<VertexRecord>() as u32 };
const FILM: BindingDecl =
    BindingDecl { name: "pt_film", access: Access::OutPerItem, stride: size_of::<FilmPixel>() as u32 };

/// Adds each record's own radiance to the film: what the path tracer saw, without a cache.
///
/// Bindings: records ([`VertexRecord`]), film ([`FilmPixel`]). No parameters. Radiance that is NaN or infinite counts
/// as a black sample and raises [`Status::NON_FINITE`].
pub static COMPOSE_TRACED: Kernel = Kernel {
    name: "pt.compose_traced",
    bindings: &[RECORDS, FILM],
    params_size: 0,
    body: compose_traced,
    wgsl: None,
    casts_rays: false,
};

/// Adds each record's radiance with the cache's illumination to the film:
/// `emitted + throughput · (direct + further)`.
///
/// Bindings: records ([`VertexRecord`]), estimates ([`EstimateRecord`]), film ([`FilmPixel`]). Parameters:
/// [`ComposeParams`]. Radiance that is NaN or infinite counts as a black sample and raises [`Status::NON_FINITE`].
pub static COMPOSE_CACHED: Kernel = Kernel {
    name: "pt.compose_cached",
    bindings: &[
        RECORDS,
        BindingDecl { name: "pt_estimates", access: Access::In, stride: size_of::<EstimateRecord>() as u32 },
        FILM,
    ],
    params_size: size_of::<ComposeParams>() as u32,
    body: compose_cached,
    wgsl: None,
    casts_rays: false,
};

/// The film's mean radiance; w: number of samples.
///
/// Bindings: film ([`FilmPixel`]), radiance (`[f32; 4]`). No parameters.
pub static RESOLVE: Kernel = Kernel {
    name: "pt.resolve",
    bindings: &[
        BindingDecl { name: "pt_film", access: Access::In, stride: size_of::<FilmPixel>() as u32 },
        BindingDecl { name: "pt_radiance", access: Access::OutPerItem, stride: 16 },
    ],
    params_size: 0,
    body: resolve,
    wgsl: None,
    casts_rays: false,
};

fn compose_traced(launch: &mut Launch<'_>) {
    let film = launch.output::<FilmPixel>(1);
    let records = of_items::<VertexRecord>(launch, 0);
    for (pixel, record) in film.iter_mut().zip(records) {
        add(launch, pixel, radiance(record, record.direct, record.further));
    }
}

fn compose_cached(launch: &mut Launch<'_>) {
    let film = launch.output::<FilmPixel>(2);
    let direct_from_record = launch.params::<ComposeParams>().direct_from_record != 0;
    let records = of_items::<VertexRecord>(launch, 0);
    let estimates = of_items::<EstimateRecord>(launch, 1);
    for ((pixel, record), estimate) in film.iter_mut().zip(records).zip(estimates) {
        let direct = if direct_from_record { record.direct } else { estimate.direct };
        add(launch, pixel, radiance(record, direct, estimate.further));
    }
}

fn resolve(launch: &mut Launch<'_>) {
    let radiance = launch.output::<[f32; 4]>(1);
    for (out, pixel) in radiance.iter_mut().zip(of_items::<FilmPixel>(launch, 0)) {
        *out = pixel.mean().to_array();
    }
}

/// The elements of an input that belong to the launch's items.
fn of_items<'a, T: bytemuck::Pod>(launch: &Launch<'a>, slot: usize) -> &'a [T] {
    &launch.input::<T>(slot)[launch.first as usize..][..launch.count as usize]
}

fn radiance(record: &VertexRecord, direct: [f32; 4], further: [f32; 4]) -> Vec3 {
    let emitted = xyz(record.emitted);
    if record.flags & VertexRecord::VALID == 0 {
        return emitted;
    }
    emitted + xyz(record.throughput) * (xyz(direct) + xyz(further))
}

fn add(launch: &Launch<'_>, pixel: &mut FilmPixel, radiance: Vec3) {
    let finite = radiance.is_finite();
    if !finite {
        launch.raise(Status::NON_FINITE);
    }
    pixel.add(if finite { radiance } else { Vec3::ZERO });
}

fn xyz(v: [f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
