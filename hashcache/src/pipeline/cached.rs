//! Frames with a cache or a filter: vertices in, each pixel's light out.

use backend_api::{Backend, Binding, Items};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CastsRays, EstimateRecord};
use layered_filter::{FilterStages, NoisePixel};
use pt_integrator::camera::CameraRays;
use pt_integrator::kernels::{FIRST_VERTICES, FirstParams, trace_records};
use pt_integrator::path::PathSettings;

use super::batches::{at_once, looks};
use super::cache::Cache;
use super::{Error, Pass, Resident, Work, create, look, part};
use crate::choice::CacheKind;
use crate::filter;
use crate::image_file::Image;
use crate::preview::{Preview, Progress};
use crate::settings::Settings;
use crate::stats::CacheStats;

/// A cache, a filter, and the buffers between them.
#[derive(Debug)]
pub(super) struct Cached {
    cache: Cache,
    filter: FilterStages,
    /// Paths of the cache pass, by columns and rows.
    paths: [u32; 2],
    /// Records of the cache pass; retained until all are taken when they are the picture's own.
    batches: Vec<Batch>,
    /// Records of a batch of pixels that are only looked at.
    visible: Binding,
    estimates: Binding,
    /// Samples in each pixel's sums.
    gathered: u32,
    /// Records of a sample of a pixel that is only looked at.
    layers: u32,
}

/// A run of paths or pixels whose records fit one binding.
#[derive(Clone, Copy, Debug)]
struct Batch {
    first: u32,
    count: u32,
    records: Binding,
}

impl Cached {
    pub fn new<B: CastsRays>(backend: &mut B, preview: &Preview, resident: &Resident) -> Result<Self, Error> {
        let (settings, camera) = (preview.settings(), preview.camera());
        let of_filter = |error| Error::refused("filter", &error);
        let plan = preview.plan();
        let filter = filter::settings(settings, plan, camera, preview.radius()).map_err(of_filter)?;
        let mut filter = FilterStages::new(&filter).map_err(of_filter)?;
        filter.prepare(backend)?;
        backend.submit()?;

        let scaled = |side: u32| ((f64::from(side) * f64::from(settings.crf)).round() as u32).max(1);
        let paths = [scaled(camera.width), scaled(camera.height)];
        let store = settings.store;
        let (total, at_once) = (paths[0].saturating_mul(paths[1]), at_once(store));
        let cache = Cache::new(backend, preview, resident, total.saturating_mul(store))?;
        let mut batches: Vec<Batch> = Vec::new();
        // Shown after the whole pass.
        let retained = settings.cache == CacheKind::None || plan.reuses_paths;
        for first in (0..total).step_by(at_once as usize) {
            let count = at_once.min(total - first);
            let records = match batches.first() {
                Some(batch) if !retained => part(batch.records, record_bytes(store), 0, count),
                _ => create(backend, "records", u64::from(count) * record_bytes(store) as u64)?,
            };
            batches.push(Batch { first, count, records });
        }
        let layers = plan.layers;
        let looks = looks(camera.pixels(), layers);
        let visible = create(backend, "visible", u64::from(looks) * record_bytes(1) as u64)?;
        let estimates = create(backend, "estimates", u64::from(looks) * size_of::<EstimateRecord>() as u64)?;
        Ok(Self { cache, filter, paths, batches, visible, estimates, gathered: 0, layers })
    }

    /// Fills the cache by `spp` paths a pixel, then looks at each pixel as often as the settings say, then filters.
    #[expect(clippy::too_many_arguments, reason = "one call, all of them borrowed from the caller")]
    pub fn frame<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        preview: &Preview,
        moved: bool,
        first_sample: u32,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Image, Error> {
        let fades = pass.settings.fades();
        // Sums over frames would keep what the cache lets fade.
        let anew = moved || fades;
        if anew {
            self.cache.look_from(preview, pass.camera)?;
            let angle = CameraRays::new(pass.camera).pixel_angle();
            self.filter.set_pixel_angle(angle).map_err(|error| Error::refused("filter", &error))?;
            work.stage(backend, "reconstruct", |backend| self.filter.clear(backend))?;
        }
        if first_sample > 0 && fades {
            work.stage(backend, "update", |backend| self.cache.fade(backend, pass.settings))?;
        }
        let spp = pass.settings.spp;
        let shown = samples(pass.settings);
        let total = if pass.settings.cache == CacheKind::None { spp } else { spp + shown };
        for sample in 0..spp {
            self.fill(backend, pass, first_sample.wrapping_add(sample), work)?;
            if pass.settings.cache == CacheKind::None {
                self.show_paths(backend, pass, work)?;
            }
            progress(Progress { stage: "trace", done: sample + 1, total });
        }
        let of_paths = |sample| sample + 1 == spp && preview.plan().reuses_paths;
        for sample in (0..shown).filter(|_| pass.settings.cache != CacheKind::None) {
            if of_paths(sample) {
                self.show_paths(backend, pass, work)?;
            } else {
                self.look(backend, pass, first_sample.wrapping_add(sample), work)?;
            }
            progress(Progress { stage: "reconstruct", done: spp + sample + 1, total });
        }
        self.gathered = if anew { shown } else { self.gathered.saturating_add(shown) };
        self.picture(backend, pass, work)
    }

    /// The picture of the sums, by the filter's strength in the pass's settings.
    pub fn picture<B: CastsRays>(&mut self, backend: &mut B, pass: &Pass<'_>, work: &mut Work) -> Result<Image, Error> {
        let filters = filter::filters(pass.settings, pass.camera, self.gathered)
            .map_err(|error| Error::refused("filter", &error))?;
        self.filter.set_filters(filters.further, filters.direct, filters.carried);
        work.stage(backend, "filter", |backend| self.filter.filter(backend))?;
        let radiance = self.filter.radiance().ok_or(backend_api::Error::UnknownBuffer { at: "lf.radiance" })?;
        Ok(pass.picture(&super::read(backend, radiance)?))
    }

    /// One path of every pixel of the cache pass into the cache.
    fn fill<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        sample: u32,
        work: &mut Work,
    ) -> Result<(), Error> {
        let Resident { triangles, scene, texels, counters, .. } = pass.resident;
        let store = pass.settings.store;
        let kernel = trace_records(store).ok_or(Error::Setting("cache.store"))?;
        for batch in &self.batches {
            let mut params = pass.trace_params(batch.first, sample, 1);
            params.camera = params.camera.with_size([pass.camera.width, pass.camera.height], self.paths);
            params.width = self.paths[0];
            params.roulette_depth = pass.settings.cache_roulette_depth.unwrap_or(PathSettings::NO_ROULETTE);
            let bindings = [triangles, scene, texels, batch.records, counters];
            work.stage(backend, "trace", |backend| {
                backend.dispatch(kernel, bytemuck::bytes_of(&params), &bindings, Items::Count(batch.count))
            })?;
            work.stage(backend, "update", |backend| self.cache.record(backend, batch.records, batch.count * store))?;
        }
        work.stage(backend, "update", |backend| self.cache.update(backend))?;
        Ok(())
    }

    /// The paths' first vertices, as a sample of every pixel.
    fn show_paths<B: CastsRays>(&mut self, backend: &mut B, pass: &Pass<'_>, work: &mut Work) -> Result<(), Error> {
        for k in 0..self.batches.len() {
            let Batch { first, count, .. } = self.batches[k];
            let records = self.first_vertices(backend, k, pass.settings.store, work)?;
            self.show(backend, records, 1, first, count, work)?;
        }
        Ok(())
    }

    /// The first vertex of each path of a batch.
    fn first_vertices<B: CastsRays>(
        &self,
        backend: &mut B,
        batch: usize,
        store: u32,
        work: &mut Work,
    ) -> Result<Binding, Error> {
        let Batch { count, records, .. } = self.batches[batch];
        if store == 1 {
            return Ok(records);
        }
        let first = part(self.visible, record_bytes(1), 0, count);
        let params = FirstParams { store, reserved: [0; 3] };
        work.stage(backend, "gather", |backend| {
            backend.dispatch(&FIRST_VERTICES, bytemuck::bytes_of(&params), &[records, first], Items::Count(count))
        })?;
        Ok(first)
    }

    /// One sample of every pixel's surface, answered by the cache.
    fn look<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        sample: u32,
        work: &mut Work,
    ) -> Result<(), Error> {
        let at_once = at_once(self.layers);
        for first in (0..pass.resident.pixels).step_by(at_once as usize) {
            let count = at_once.min(pass.resident.pixels - first);
            let records = part(self.visible, record_bytes(self.layers), 0, count);
            let params = look::params(pass, first, sample);
            work.stage(backend, "reconstruct", |backend| {
                look::dispatch(backend, &pass.resident, &params, self.layers, records, count)
            })?;
            self.show(backend, records, self.layers, first, count, work)?;
        }
        Ok(())
    }

    /// Answers records, `each` a pixel, by the cache and adds them to their pixels.
    fn show<B: CastsRays>(
        &mut self,
        backend: &mut B,
        records: Binding,
        each: u32,
        first: u32,
        count: u32,
        work: &mut Work,
    ) -> Result<(), Error> {
        let estimates = part(self.estimates, size_of::<EstimateRecord>() * each as usize, 0, count);
        work.stage(backend, "query", |backend| self.cache.query(backend, records, estimates, count * each))?;
        work.stage(backend, "gather", |backend| {
            self.filter.gather(backend, records, each, estimates, each, first, count)
        })?;
        Ok(())
    }

    /// The pixels' sums, layer by layer.
    pub fn sums<B: CastsRays>(&self, backend: &mut B) -> Result<Vec<Vec<u8>>, Error> {
        let sums = (0..self.layers).filter_map(|layer| self.filter.sums(layer));
        sums.map(|sums| Ok(super::read(backend, sums)?)).collect()
    }

    /// Each pixel's error before the filter.
    pub fn noise<B: CastsRays>(&self, backend: &mut B, pixels: u32) -> Result<Vec<NoisePixel>, Error> {
        let noise = create(backend, "noise", u64::from(pixels) * size_of::<NoisePixel>() as u64)?;
        self.filter.noise(backend, noise.buffer)?;
        backend.submit()?;
        backend.statuses()?;
        let bytes = super::read(backend, noise)?;
        Backend::destroy(backend, noise.buffer)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    pub fn wipe<B: CastsRays>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.cache.wipe(backend)
    }

    /// The lights changed.
    pub fn relight<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<(), Error> {
        self.cache.relight(backend, settings)
    }

    pub fn stats<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<Option<CacheStats>, Error> {
        self.cache.stats(backend, settings)
    }
}

/// Samples that show a pixel's surfaces in one frame.
pub(super) fn samples(settings: &Settings) -> u32 {
    match settings.cache {
        CacheKind::None => settings.spp,
        _ => settings.spp.max(settings.reconstruct_samples),
    }
}

const fn record_bytes(store: u32) -> usize {
    store as usize * size_of::<VertexRecord>()
}
