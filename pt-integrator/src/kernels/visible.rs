//! The kernel that asks for more of a pixel's first vertices.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use bytemuck::{Pod, Zeroable};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Sampler;

use super::shared::{COUNTERS, SCENE, TEXELS, TRIANGLES, Tracing};
use crate::camera::CameraRays;
use crate::path::{DirectSettings, trace_visible};
use crate::sampler::{Sobol, pixel_seed, vertex_seed};

/// Parameters of [`TRACE_VISIBLE`]. 96 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VisibleParams {
    /// The camera's rays.
    pub camera: CameraRays,
    /// Pixels a row of the picture, above 0.
    pub width: u32,
    /// Pixel of item 0.
    pub first_pixel: u32,
    /// Index of the sample. Points on the film are those of a path of the same index and seed ([`super::TRACE_RECORDS`]),
    /// so indices that no path of the pixel has are stratified together with the paths.
    pub sample: u32,
    /// Seed of all random numbers.
    pub seed: u32,
    /// [`DirectSettings::samples`]; 0: no direct light.
    pub direct_samples: u32,
    /// [`DirectSettings::candidates`].
    pub direct_candidates: u32,
    /// [`DirectSettings::scattered`].
    pub direct_scattered: u32,
    /// Zero.
    pub reserved: u32,
}

impl VisibleParams {
    /// How direct light is found.
    #[inline]
    pub const fn direct(&self) -> DirectSettings {
        DirectSettings {
            samples: self.direct_samples,
            candidates: self.direct_candidates,
            scattered: self.direct_scattered,
        }
    }
}

/// Traces one camera ray through each pixel and writes its first vertex, with direct light when asked for, to be
/// answered by a cache.
///
/// Bindings: triangles, scene, texels, records ([`VertexRecord`] for each item), counters. Parameters:
/// [`VisibleParams`]. `further` is 0, and valid records have [`VertexRecord::VISIBLE_ONLY`] set. Light that is NaN or
/// infinite is left out, raises [`Status::NON_FINITE`](backend_api::Status::NON_FINITE) and is counted.
pub static TRACE_VISIBLE: Kernel = Kernel {
    name: "pt.trace_visible",
    bindings: &[
        TRIANGLES,
        SCENE,
        TEXELS,
        BindingDecl { name: "pt_records", access: Access::OutPerItem, stride: size_of::<VertexRecord>() as u32 },
        COUNTERS,
    ],
    params_size: size_of::<VisibleParams>() as u32,
    body: run,
    wgsl: None,
    casts_rays: true,
};

/// Part the numbers of direct light from those of paths.
const SALTS: [u32; 2] = [0x6c69_6768, 0x7363_6174];

fn run(launch: &mut Launch<'_>) {
    let records = launch.output::<VertexRecord>(3);
    let params = launch.params::<VisibleParams>();
    let Some(mut tracing) = Tracing::new(launch) else { return };
    let settings = params.direct().for_scene(&tracing.scene);
    let first = [settings.all(), settings.scattered].map(|n| params.sample.wrapping_mul(n));
    for (item, record) in launch.items().zip(records) {
        let index = params.first_pixel + item;
        let seed = pixel_seed(index, params.seed);
        let u = Sobol::new(params.sample, seed).next_2d();
        let ray = params.camera.ray([index % params.width, index / params.width], u);
        let seeds = SALTS.map(|salt| vertex_seed(seed, salt));
        let numbers = |strategy, i: u32| Sobol::new(first[strategy as usize].wrapping_add(i), seeds[strategy as usize]);
        let Tracing { scene, caster, counts } = &mut tracing;
        let vertex = trace_visible(scene, caster, &ray, &settings, numbers, counts);
        *record = vertex.record(params.camera.pixel_angle(), vertex_seed(seed, params.sample));
        if vertex.has_vertex {
            record.flags |= VertexRecord::VISIBLE_ONLY;
        }
    }
    tracing.finish(launch);
}
