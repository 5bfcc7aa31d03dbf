//! The caches, behind one face.

use backend_api::{Binding, Error as BackendError, Items};
use hashcache_core::octree::OctreeStages;
use hashcache_core::stages::{CacheStages as _, CastsRays};
use hashgrid::GridStages;
use pt_integrator::kernels::ANSWER_TRACED;
use pt_integrator::scene::Camera;

use super::{Error, Resident, look};
use crate::choice::CacheKind;
use crate::grid;
use crate::octree;
use crate::preview::Preview;
use crate::settings::Settings;
use crate::stats::CacheStats;

/// The cache that the settings name.
#[derive(Debug)]
pub(super) enum Cache {
    /// None: a vertex answers for itself.
    None,
    /// The hash grid.
    Grid(GridStages),
    /// The linkless octree.
    Octree(Box<OctreeStages>),
}

impl Cache {
    /// Makes and clears it, for passes of so many records.
    pub fn new<B: CastsRays>(
        backend: &mut B,
        preview: &Preview,
        resident: &Resident,
        records: u32,
    ) -> Result<Self, Error> {
        let (settings, camera) = (preview.settings(), preview.camera());
        let mut cache = match settings.cache {
            CacheKind::Grid => {
                let cache = grid::stages(settings, camera, 2.0 * preview.radius(), preview.max_radiance());
                Self::Grid(cache.map_err(|error| Error::refused("cache grid", &error))?)
            }
            CacheKind::Octree => {
                let refused = |reason: &dyn ToString| Error::refused("cache octree", reason);
                let footprint = match settings.octree_resolution {
                    None => look::median_footprint(backend, camera, resident)?,
                    Some(_) => 0.0,
                };
                let structure = octree::structure(preview, footprint).map_err(|error| refused(&error))?;
                let params = octree::params(settings, preview.max_radiance()).map_err(|error| refused(&error))?;
                Self::Octree(Box::new(OctreeStages::new(structure, params).with_layout(octree::layout(settings))))
            }
            CacheKind::None => Self::None,
        };
        match &mut cache {
            Self::None => {}
            Self::Grid(grid) => grid.prepare(backend)?,
            Self::Octree(octree) => {
                // One pass's records, so that no frame is merged in parts.
                octree.reserve(backend, records.min(OctreeStages::most_records(backend)))?;
                octree.prepare(backend)?;
            }
        }
        backend.submit()?;
        Ok(cache)
    }

    /// The camera moved.
    pub fn look_from(&mut self, preview: &Preview, camera: &Camera) -> Result<(), Error> {
        match self {
            // The octree's levels follow each vertex's own footprint.
            Self::None | Self::Octree(_) => {}
            Self::Grid(cache) => {
                let params = grid::params(preview.settings(), camera, 2.0 * preview.radius(), preview.max_radiance());
                cache.set_params(params.map_err(|error| Error::refused("cache grid", &error))?);
            }
        }
        Ok(())
    }

    /// A frame after the first begins: of earlier light there remains what the settings say.
    pub fn fade<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<(), BackendError> {
        match self {
            Self::Grid(cache) if settings.fades() => cache.fade(backend, settings.grid_history),
            Self::None | Self::Grid(_) | Self::Octree(_) => Ok(()),
        }
    }

    /// The lights changed: forgets all light, or lets it fade from frame to frame.
    pub fn relight<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<(), Error> {
        if settings.fades() { Ok(()) } else { self.wipe(backend) }
    }

    pub fn record<B: CastsRays>(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), BackendError> {
        match self {
            Self::None => Ok(()),
            Self::Grid(cache) => cache.record(backend, records, count),
            Self::Octree(cache) => cache.record(backend, records, count),
        }
    }

    pub fn update<B: CastsRays>(&mut self, backend: &mut B) -> Result<(), BackendError> {
        match self {
            Self::None => Ok(()),
            Self::Grid(cache) => cache.update(backend),
            Self::Octree(cache) => cache.update(backend),
        }
    }

    pub fn query<B: CastsRays>(
        &mut self,
        backend: &mut B,
        records: Binding,
        estimates: Binding,
        count: u32,
    ) -> Result<(), BackendError> {
        match self {
            Self::None => backend.dispatch(&ANSWER_TRACED, &[], &[records, estimates], Items::Count(count)),
            Self::Grid(cache) => cache.query(backend, records, estimates, count),
            Self::Octree(cache) => cache.query(backend, records, estimates, count),
        }
    }

    /// Forgets all light.
    pub fn wipe<B: CastsRays>(&mut self, backend: &mut B) -> Result<(), Error> {
        match self {
            Self::None => {}
            Self::Grid(cache) => cache.clear(backend)?,
            Self::Octree(cache) => cache.wipe(),
        }
        Ok(backend.submit()?)
    }

    pub fn stats<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<Option<CacheStats>, Error> {
        match self {
            Self::None => Ok(None),
            Self::Grid(cache) => grid::stats(backend, cache, settings).map(Some),
            Self::Octree(cache) => octree::stats(backend, cache).map(Some),
        }
    }
}
