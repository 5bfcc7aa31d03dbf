//! One pipeline for every backend: runs a plan.

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error as BackendError, Items};
use hashcache_core::error::ParamError;
use hashcache_core::geometry::Geometry;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages, CastsRays, EstimateRecord};
use hashgrid::GridStages;
use pt_integrator::camera::CameraRays;
use pt_integrator::film::FilmPixel;
use pt_integrator::kernels::{COMPOSE_CACHED, ComposeParams, RESOLVE, TRACE_FILM, TRACE_RECORDS, TraceParams};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts};
use pt_integrator::scene::Camera;

use crate::choice::{CacheKind, DirectLight};
use crate::clock::{self, Elapsed};
use crate::grid;
use crate::image_file::Image;
use crate::plan::FramePlan;
use crate::preview::Progress;
use crate::settings::Settings;
use crate::stats::{Rays, Stats};

/// Vertex records of one batch: 2¹⁹ · 96 bytes stay below 64 MiB and below every device's binding limit.
const BATCH: u32 = 1 << 19;

/// Paths of one submission without a cache: often enough to show progress, seldom enough to cost nothing.
const PATHS_PER_SUBMIT: u64 = 1 << 21;

/// Everything a render reads.
pub(crate) struct Frame<'a> {
    pub scene: &'a PackedScene,
    pub geometry: Geometry<'a>,
    pub camera: &'a Camera,
    pub settings: &'a Settings,
    pub plan: &'a FramePlan,
    pub max_radiance: f32,
}

/// What a render gives.
pub(crate) struct Traced {
    pub image: Image,
    pub stats: Stats,
}

/// What can go wrong in it.
#[derive(Debug)]
pub(crate) enum Error {
    Backend(BackendError),
    Grid(ParamError),
}

impl From<BackendError> for Error {
    fn from(error: BackendError) -> Self {
        Self::Backend(error)
    }
}

impl From<ParamError> for Error {
    fn from(error: ParamError) -> Self {
        Self::Grid(error)
    }
}

/// Runs the plan on a backend and reads the picture back.
pub(crate) fn render<B: CastsRays>(
    backend: &mut B,
    frame: &Frame<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Traced, Error> {
    let mut stats = Stats::default();
    progress(Progress { stage: "build", done: 0, total: frame.settings.spp });
    let (built, build) = clock::measure(|| Resident::new(backend, frame));
    let resident = built?;
    stats.time_s.build = build.wall_s;
    stats.cpu_s.build = build.cpu_s;
    let (image, whole) = clock::measure(|| match frame.plan.cache {
        CacheKind::None => resident.paths(backend, frame, &mut stats, progress),
        CacheKind::Grid => resident.cached(backend, frame, &mut stats, progress),
    });
    stats.time_s.render = whole.wall_s;
    stats.cpu_s.render = whole.cpu_s;
    let image = image?;
    resident.ray_counts(backend, &mut stats)?;
    Ok(Traced { image, stats })
}

/// The buffers that stay for the whole render.
struct Resident {
    triangles: Binding,
    scene: Binding,
    texels: Binding,
    film: BufferId,
    counters: Binding,
    pixels: u32,
}

impl Resident {
    fn new<B: CastsRays>(backend: &mut B, frame: &Frame<'_>) -> Result<Self, BackendError> {
        backend.set_geometry(&frame.geometry)?;
        let triangles = upload(backend, "triangles", frame.scene.triangle_bytes())?;
        let scene = upload(backend, "scene", frame.scene.scene_bytes())?;
        let texels = upload(backend, "texels", frame.scene.texel_bytes())?;
        let pixels = frame.camera.pixels();
        let film = create(backend, "film", u64::from(pixels) * size_of::<FilmPixel>() as u64)?.buffer;
        let counters = create(backend, "ray counters", RayCounts::WORDS as u64 * 8)?;
        Ok(Self { triangles, scene, texels, film, counters, pixels })
    }

    /// Whole paths into the film.
    fn paths<B: CastsRays>(
        &self,
        backend: &mut B,
        frame: &Frame<'_>,
        stats: &mut Stats,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Image, Error> {
        let total = frame.settings.spp;
        let at_once = (PATHS_PER_SUBMIT / u64::from(self.pixels)).clamp(1, u64::from(total)) as u32;
        let mut done = 0;
        while done < total {
            let samples = at_once.min(total - done);
            let params = trace_params(frame, 0, done, samples);
            let bindings = [self.triangles, self.scene, self.texels, self.film_of(0, self.pixels), self.counters];
            stage(backend, stats, "trace", |backend| {
                backend.dispatch(&TRACE_FILM, bytemuck::bytes_of(&params), &bindings, Items::Count(self.pixels))
            })?;
            done += samples;
            progress(Progress { stage: "trace", done, total });
        }
        self.resolve(backend, frame, stats)
    }

    /// One sample a pixel at a time: records into the cache, then each pixel's light from it.
    fn cached<B: CastsRays>(
        &self,
        backend: &mut B,
        frame: &Frame<'_>,
        stats: &mut Stats,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Image, Error> {
        let mut cache = grid::stages(frame.settings, frame.camera, &frame.geometry, frame.max_radiance)?;
        stage(backend, stats, "update", |backend| cache.prepare(backend))?;
        let batches: Vec<Batch> = (0..self.pixels)
            .step_by(BATCH as usize)
            .map(|first| Batch::new(backend, first, BATCH.min(self.pixels - first)))
            .collect::<Result<_, _>>()?;
        let largest = batches.iter().map(|batch| batch.count).max().unwrap_or(0);
        let estimates = create(backend, "estimates", u64::from(largest) * size_of::<EstimateRecord>() as u64)?;
        let total = frame.settings.spp;
        for sample in 0..total {
            self.frame(backend, frame, stats, &mut cache, &batches, estimates, sample)?;
            progress(Progress { stage: "trace", done: sample + 1, total });
        }
        stats.cache = Some(grid::stats(backend, &cache, frame.settings)?);
        self.resolve(backend, frame, stats)
    }

    #[expect(clippy::too_many_arguments, reason = "one call, all of them borrowed from the caller")]
    fn frame<B: CastsRays>(
        &self,
        backend: &mut B,
        frame: &Frame<'_>,
        stats: &mut Stats,
        cache: &mut GridStages,
        batches: &[Batch],
        estimates: Binding,
        sample: u32,
    ) -> Result<(), BackendError> {
        for batch in batches {
            let params = trace_params(frame, batch.first, sample, 1);
            let bindings = [self.triangles, self.scene, self.texels, batch.records, self.counters];
            stage(backend, stats, "trace", |backend| {
                backend.dispatch(&TRACE_RECORDS, bytemuck::bytes_of(&params), &bindings, Items::Count(batch.count))
            })?;
            stage(backend, stats, "update", |backend| cache.record(backend, batch.records, batch.count))?;
        }
        stage(backend, stats, "update", |backend| cache.update(backend))?;
        let direct_from_record = u32::from(frame.plan.direct == DirectLight::Traced);
        let compose = ComposeParams { direct_from_record, reserved: [0; 3] };
        for batch in batches {
            let estimates = Binding { size: u64::from(batch.count) * size_of::<EstimateRecord>() as u64, ..estimates };
            stage(backend, stats, "query", |backend| cache.query(backend, batch.records, estimates, batch.count))?;
            let bindings = [batch.records, estimates, self.film_of(batch.first, batch.count)];
            stage(backend, stats, "compose", |backend| {
                backend.dispatch(&COMPOSE_CACHED, bytemuck::bytes_of(&compose), &bindings, Items::Count(batch.count))
            })?;
        }
        Ok(())
    }

    /// The film's mean as a picture.
    fn resolve<B: Backend>(&self, backend: &mut B, frame: &Frame<'_>, stats: &mut Stats) -> Result<Image, Error> {
        let radiance = create(backend, "radiance", u64::from(self.pixels) * 16)?;
        let film = self.film_of(0, self.pixels);
        stage(backend, stats, "resolve", |backend| {
            backend.dispatch(&RESOLVE, &[], &[film, radiance], Items::Count(self.pixels))
        })?;
        let bytes = read(backend, radiance)?;
        let pixels = bytes.chunks_exact(16).map(|texel| {
            let [r, g, b, _]: [f32; 4] = bytemuck::pod_read_unaligned(texel);
            [r, g, b]
        });
        Ok(Image { width: frame.camera.width, height: frame.camera.height, pixels: pixels.collect() })
    }

    fn ray_counts<B: Backend>(&self, backend: &mut B, stats: &mut Stats) -> Result<(), BackendError> {
        let bytes = read(backend, self.counters)?;
        let mut words = [0; RayCounts::WORDS];
        for (word, bytes) in words.iter_mut().zip(bytes.chunks_exact(8)) {
            *word = bytemuck::pod_read_unaligned(bytes);
        }
        let counts = RayCounts::from_words(words);
        stats.rays =
            Rays { closest: counts.closest, shadow_asked: counts.shadow_asked, shadow_traced: counts.shadow_traced };
        stats.non_finite = counts.non_finite;
        Ok(())
    }

    fn film_of(&self, first: u32, count: u32) -> Binding {
        let stride = size_of::<FilmPixel>() as u64;
        Binding { buffer: self.film, offset: u64::from(first) * stride, size: u64::from(count) * stride }
    }
}

/// Parameters of the tracing kernels for a run of pixels and samples.
fn trace_params(frame: &Frame<'_>, first_pixel: u32, first_sample: u32, samples: u32) -> TraceParams {
    let settings = frame.settings;
    TraceParams {
        camera: CameraRays::new(frame.camera),
        width: frame.camera.width,
        first_pixel,
        first_sample,
        samples,
        seed: settings.seed,
        max_bounces: settings.max_bounces,
        roulette_depth: settings.roulette_depth.unwrap_or(PathSettings::NO_ROULETTE),
        reserved: 0,
    }
}

/// A run of pixels whose records fit one binding.
struct Batch {
    first: u32,
    count: u32,
    records: Binding,
}

impl Batch {
    fn new<B: Backend>(backend: &mut B, first: u32, count: u32) -> Result<Self, BackendError> {
        let size = u64::from(count) * size_of::<VertexRecord>() as u64;
        Ok(Self { first, count, records: create(backend, "records", size)? })
    }
}

/// Records work, submits it, waits, and books its time under a stage's name.
fn stage<B: Backend>(
    backend: &mut B,
    stats: &mut Stats,
    name: &'static str,
    record: impl FnOnce(&mut B) -> Result<(), BackendError>,
) -> Result<(), BackendError> {
    let (result, elapsed): (Result<(), BackendError>, Elapsed) = clock::measure(|| {
        record(backend)?;
        backend.submit()?;
        backend.statuses().map(|_| ())
    });
    stats.add_stage(name, elapsed);
    result
}

fn create<B: Backend>(backend: &mut B, name: &'static str, size: u64) -> Result<Binding, BackendError> {
    let buffer = backend.create(&BufferDesc { name, size })?;
    Ok(Binding { buffer, offset: 0, size })
}

fn upload<B: Backend>(backend: &mut B, name: &'static str, bytes: &[u8]) -> Result<Binding, BackendError> {
    let binding = create(backend, name, bytes.len() as u64)?;
    backend.write(binding.buffer, 0, bytes)?;
    Ok(binding)
}

/// The bytes of a binding, waited for.
pub(crate) fn read<B: Backend>(backend: &mut B, binding: Binding) -> Result<Vec<u8>, BackendError> {
    let ticket = backend.read(binding.buffer, binding.offset, binding.size)?;
    backend.redeem(ticket, true)?.ok_or(BackendError::UnknownTicket)
}
