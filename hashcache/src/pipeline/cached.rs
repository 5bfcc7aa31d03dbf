//! Frames with a cache: records in, each pixel's light out.

use backend_api::{Binding, Items};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages as _, CastsRays, EstimateRecord};
use hashgrid::GridStages;
use pt_integrator::film::FilmPixel;
use pt_integrator::kernels::{COMPOSE_CACHED, ComposeParams, TRACE_RECORDS};

use super::{Error, Pass, Resident, Work, create, part};
use crate::choice::DirectLight;
use crate::grid;
use crate::preview::{Preview, Progress};
use crate::settings::Settings;
use crate::stats::CacheStats;

/// Vertex records of one batch: 2¹⁹ · 96 bytes stay below 64 MiB and below every device's binding limit.
const BATCH: u32 = 1 << 19;

/// A cache and the buffers that feed it.
#[derive(Debug)]
pub(super) struct Cached {
    grid: GridStages,
    batches: Vec<Batch>,
    estimates: Binding,
}

/// A run of pixels whose records fit one binding.
#[derive(Clone, Copy, Debug)]
struct Batch {
    first: u32,
    count: u32,
    records: Binding,
}

impl Cached {
    pub fn new<B: CastsRays>(backend: &mut B, preview: &Preview) -> Result<Self, Error> {
        let pixels = preview.camera().pixels();
        let mut grid = grid::stages(preview.settings(), preview.camera(), &preview.geometry(), preview.max_radiance())
            .map_err(|error| Error::of_cache("grid", error))?;
        grid.prepare(backend)?;
        backend.submit()?;
        let mut batches = Vec::new();
        for first in (0..pixels).step_by(BATCH as usize) {
            let count = BATCH.min(pixels - first);
            let records = create(backend, "records", u64::from(count) * size_of::<VertexRecord>() as u64)?;
            batches.push(Batch { first, count, records });
        }
        let largest = batches.iter().map(|batch| batch.count).max().unwrap_or(0);
        let estimates = create(backend, "estimates", u64::from(largest) * size_of::<EstimateRecord>() as u64)?;
        Ok(Self { grid, batches, estimates })
    }

    /// One sample a pixel at a time: records into the cache, then each pixel's light from it.
    #[expect(clippy::too_many_arguments, reason = "one call, all of them borrowed from the caller")]
    pub fn frame<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        preview: &Preview,
        moved: bool,
        traced: u32,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(), Error> {
        if moved {
            let params = grid::params(pass.settings, pass.camera, &preview.geometry(), preview.max_radiance());
            self.grid.set_params(params.map_err(|error| Error::of_cache("grid", error))?);
        }
        let total = pass.settings.spp;
        for sample in 0..total {
            self.sample(backend, pass, traced.wrapping_add(sample), work)?;
            progress(Progress { stage: "trace", done: sample + 1, total });
        }
        Ok(())
    }

    fn sample<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        sample: u32,
        work: &mut Work,
    ) -> Result<(), Error> {
        let Resident { triangles, scene, texels, counters, .. } = pass.resident;
        for batch in &self.batches {
            let params = pass.trace_params(batch.first, sample, 1);
            let bindings = [triangles, scene, texels, batch.records, counters];
            work.stage(backend, "trace", |backend| {
                backend.dispatch(&TRACE_RECORDS, bytemuck::bytes_of(&params), &bindings, Items::Count(batch.count))
            })?;
            work.stage(backend, "update", |backend| self.grid.record(backend, batch.records, batch.count))?;
        }
        work.stage(backend, "update", |backend| self.grid.update(backend))?;
        let direct_from_record = u32::from(pass.settings.direct == DirectLight::Traced);
        let compose = ComposeParams { direct_from_record, reserved: [0; 3] };
        for batch in &self.batches {
            let estimates = part(self.estimates, size_of::<EstimateRecord>(), 0, batch.count);
            work.stage(backend, "query", |backend| self.grid.query(backend, batch.records, estimates, batch.count))?;
            let film = part(pass.film, size_of::<FilmPixel>(), batch.first, batch.count);
            let bindings = [batch.records, estimates, film];
            work.stage(backend, "compose", |backend| {
                backend.dispatch(&COMPOSE_CACHED, bytemuck::bytes_of(&compose), &bindings, Items::Count(batch.count))
            })?;
        }
        Ok(())
    }

    pub fn wipe<B: CastsRays>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.grid.clear(backend)?;
        Ok(backend.submit()?)
    }

    pub fn stats<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<CacheStats, Error> {
        grid::stats(backend, &self.grid, settings)
    }
}
