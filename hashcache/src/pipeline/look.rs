//! Looking at surfaces without tracing on.

use backend_api::{Backend, Binding, Error as BackendError, Items};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::CastsRays;
use pt_integrator::camera::CameraRays;
use pt_integrator::kernels::{VisibleParams, trace_visible};
use pt_integrator::path::PathSettings;
use pt_integrator::scene::Camera;

use super::{Pass, Resident, create, read};
use crate::choice::DirectLight;

/// Columns and rows of the picture by which the median footprint is found: 1,024 rays know it to a few percent.
const PROBE: [u32; 2] = [32, 32];

/// Parameters for sample `sample` of the pixels from `first_pixel` on.
pub(super) fn params(pass: &Pass<'_>, first_pixel: u32, sample: u32) -> VisibleParams {
    let settings = pass.settings;
    let traced = settings.direct == DirectLight::Traced;
    VisibleParams {
        camera: CameraRays::new(pass.camera),
        width: pass.camera.width,
        first_pixel,
        sample,
        seed: settings.seed,
        direct_samples: if traced { settings.direct_samples } else { 0 },
        direct_candidates: settings.direct_candidates,
        direct_scattered: if traced { settings.direct_scattered } else { 0 },
        max_bounces: settings.max_bounces,
    }
}

/// Records the vertices of `count` pixels, `layers` each.
pub(super) fn dispatch<B: CastsRays>(
    backend: &mut B,
    resident: &Resident,
    params: &VisibleParams,
    layers: u32,
    records: Binding,
    count: u32,
) -> Result<(), BackendError> {
    let kernel = trace_visible(layers).ok_or(BackendError::Unsupported { what: "layers" })?;
    let &Resident { triangles, scene, texels, counters, .. } = resident;
    let bindings = [triangles, scene, texels, records, counters];
    backend.dispatch(kernel, bytemuck::bytes_of(params), &bindings, Items::Count(count))
}

/// The median footprint of a camera's pixels that show a surface; 0 when none does.
pub(super) fn median_footprint<B: CastsRays>(
    backend: &mut B,
    camera: &Camera,
    resident: &Resident,
) -> Result<f32, BackendError> {
    let [width, height] = PROBE;
    let count = width * height;
    let params = VisibleParams {
        camera: CameraRays::new(camera).with_size([camera.width, camera.height], PROBE),
        width,
        first_pixel: 0,
        sample: 0,
        seed: 0,
        direct_samples: 0,
        direct_candidates: 1,
        direct_scattered: 0,
        max_bounces: PathSettings::default().max_bounces,
    };
    let records = create(backend, "probe", u64::from(count) * size_of::<VertexRecord>() as u64)?;
    dispatch(backend, resident, &params, 1, records, count)?;
    backend.submit()?;
    backend.statuses()?;
    let bytes = read(backend, records)?;
    Backend::destroy(backend, records.buffer)?;
    let mut footprints: Vec<f32> = bytes
        .chunks_exact(size_of::<VertexRecord>())
        .map(bytemuck::pod_read_unaligned::<VertexRecord>)
        .filter(VertexRecord::is_valid)
        .map(|record| record.position_footprint[3])
        .collect();
    footprints.sort_by(f32::total_cmp);
    Ok(footprints.get(footprints.len() / 2).copied().unwrap_or(0.0))
}
