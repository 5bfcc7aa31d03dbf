//! The kernels that find what a pixel shows, in layers.

use backend_api::{BindingDecl, Kernel, Launch};
use bytemuck::{Pod, Zeroable};
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Sampler;

use super::shared::{Tracing, tracing_bindings};
use crate::camera::CameraRays;
use crate::path::{self, DirectSettings, MAX_LAYERS, PathOutcome, Strategy, VisibleSettings};
use crate::sampler::{Sobol, pixel_seed, vertex_seed};

/// Parameters of the kernels of [`super::trace_visible`]. 96 bytes.
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
    /// [`VisibleSettings::max_bounces`].
    pub max_bounces: u32,
}

impl VisibleParams {
    /// What is looked for.
    #[inline]
    pub const fn settings(&self) -> VisibleSettings {
        VisibleSettings { direct: self.direct(), max_bounces: self.max_bounces }
    }

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

/// Traces one camera ray through each pixel and writes the vertex that it meets: [`trace_visible`] of one layer.
pub static TRACE_VISIBLE: Kernel = Layers::<1>::kernel("pt.trace_visible");

static TRACE_DEEPER: [Kernel; MAX_LAYERS - 1] = [
    Layers::<2>::kernel("pt.trace_visible_2"),
    Layers::<3>::kernel("pt.trace_visible_3"),
    Layers::<4>::kernel("pt.trace_visible_4"),
    Layers::<5>::kernel("pt.trace_visible_5"),
    Layers::<6>::kernel("pt.trace_visible_6"),
    Layers::<7>::kernel("pt.trace_visible_7"),
    Layers::<8>::kernel("pt.trace_visible_8"),
];

/// The kernel that traces one camera ray through each pixel and writes the vertices that it shows in 1 to [`MAX_LAYERS`]
/// layers, with direct light when asked for, to be answered by a cache; `None` for other numbers. All but the last are
/// those of the chain that follows the strongest lobe through mirrors and glass; the last is that of one of the lobes
/// that the chain passed by. See [`crate::path::trace_visible`].
///
/// Bindings: triangles, scene, texels, records (`layers` times [`VertexRecord`] for each item, the first layer first),
/// counters. Parameters: [`VisibleParams`]. `further` is 0, and valid records have [`VertexRecord::VISIBLE_ONLY`] set.
/// Surfaces without a diffuse lobe are [`VertexRecord::GUIDE`]s; where a segment met nothing, only `emitted` is set;
/// records of layers without either are zero. Light that is NaN or infinite is left out, raises
/// [`Status::NON_FINITE`](backend_api::Status::NON_FINITE) and is counted.
///
/// ```
/// use pt_integrator::kernels::trace_visible;
/// assert_eq!(trace_visible(4).unwrap().bindings[3].stride, 4 * 96);
/// assert!(trace_visible(0).is_none());
/// ```
pub fn trace_visible(layers: u32) -> Option<&'static Kernel> {
    match layers {
        1 => Some(&TRACE_VISIBLE),
        _ => TRACE_DEEPER.get(layers.checked_sub(2)? as usize),
    }
}

/// Part the numbers of direct light and chains from those of paths.
const SALTS: [u32; 3] = [0x6c69_6768, 0x7363_6174, 0x6368_6169];

/// Chains of `LAYERS` layers.
struct Layers<const LAYERS: usize>;

impl<const LAYERS: usize> Layers<LAYERS> {
    const BINDINGS: [BindingDecl; 5] = tracing_bindings((LAYERS * size_of::<VertexRecord>()) as u32);

    const fn kernel(name: &'static str) -> Kernel {
        Kernel {
            name,
            bindings: &Self::BINDINGS,
            params_size: size_of::<VisibleParams>() as u32,
            body: Self::run,
            wgsl: None,
            casts_rays: true,
        }
    }

    fn run(launch: &mut Launch<'_>) {
        let records = launch.output::<VertexRecord>(3);
        let params = launch.params::<VisibleParams>();
        let Some(mut tracing) = Tracing::new(launch) else { return };
        let mut settings = params.settings();
        settings.direct = settings.direct.for_scene(&tracing.scene);
        let first = [settings.direct.all(), settings.direct.scattered, 1].map(|n| params.sample.wrapping_mul(n));
        let angle = params.camera.pixel_angle();
        for (item, records) in launch.items().zip(records.chunks_exact_mut(LAYERS)) {
            let index = params.first_pixel + item;
            let seed = pixel_seed(index, params.seed);
            let u = Sobol::new(params.sample, seed).next_2d();
            let ray = params.camera.ray([index % params.width, index / params.width], u);
            let seeds = SALTS.map(|salt| vertex_seed(seed, salt));
            let numbers = |strategy: Strategy, layer, i: u32| {
                let seed = of_layer(seeds[strategy as usize], layer);
                Sobol::new(first[strategy as usize].wrapping_add(i), seed)
            };
            let mut layers = [PathOutcome::NONE; LAYERS];
            let Tracing { scene, caster, counts } = &mut tracing;
            path::trace_visible(scene, caster, &ray, &settings, &mut layers, numbers, counts);
            let seed = vertex_seed(seed, params.sample);
            for (k, (record, outcome)) in (0..).zip(records.iter_mut().zip(&layers)) {
                let written = k == 0 || *outcome != PathOutcome::NONE;
                *record = if written { outcome.record(angle, of_layer(seed, k)) } else { Zeroable::zeroed() };
                if outcome.has_vertex {
                    record.flags |= VertexRecord::VISIBLE_ONLY;
                }
            }
        }
        tracing.finish(launch);
    }
}

/// The seed of a deeper layer.
#[inline]
fn of_layer(seed: u32, layer: u32) -> u32 {
    if layer == 0 { seed } else { vertex_seed(seed, layer) }
}
