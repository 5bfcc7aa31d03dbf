//! An octree with its data, owned, for host programs with loops of their own.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::marker::PhantomData;
use core::slice;
use core::sync::atomic::AtomicU32;

use glam::Vec3;

use super::cell::{CellRecord, ExactCell};
use super::cells::{ReadCells, SharedCells};
use super::grid::Grid;
use super::lookup::estimate_vertices;
use super::merge::{MAX_SAMPLES, merge_samples};
use super::owned::OwnedOctree;
use super::params::OctreeParams;
use super::sample::{Sample, sample_key, sample_vertices};
use super::tally::{COUNTER_WORDS, add_counters, read_counters};
use crate::counters::Counters;
use crate::record::VertexRecord;
use crate::traits::{Estimate, RadianceCache};

/// An octree, its cells in layout `C`, and its counters, as a [`RadianceCache`].
///
/// `record` only remembers a sample (24 bytes); `end_frame` merges all samples at once, so their order has no influence.
///
/// ```
/// use hashcache_core::geometry::{Geometry, Instance, Mesh};
/// use hashcache_core::octree::{BuildSettings, ExactCell, OctreeCache, OctreeParams, OctreeSettings, Serial, build};
/// use hashcache_core::record::VertexRecord;
/// use hashcache_core::traits::RadianceCache;
///
/// let floor = Geometry {
///     positions: &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
///     indices: &[[0, 2, 1]],
///     meshes: &[Mesh { first_triangle: 0, triangle_count: 1 }],
///     instances: &[Instance::identity(0)],
///     ..Geometry::default()
/// };
/// let octree = build(&floor, &BuildSettings { resolution: 16, ..BuildSettings::default() }, &Serial)?;
/// let params = OctreeParams::new(&OctreeSettings { min_samples: 1, ..OctreeSettings::default() })?;
/// let mut cache = OctreeCache::<ExactCell>::new(octree, params);
///
/// let vertex = VertexRecord {
///     position_footprint: [0.25, 0.0, 0.25, 0.01],
///     further: [0.5; 4],
///     flags: VertexRecord::VALID,
///     ..bytemuck::Zeroable::zeroed()
/// };
/// cache.record(&vertex);
/// cache.record(&VertexRecord { further: [1.5; 4], ..vertex });
/// cache.end_frame();
/// let estimate = cache.estimate(&vertex);
/// assert_eq!((estimate.further.x, estimate.samples), (1.0, 2));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OctreeCache<C = ExactCell> {
    octree: Arc<OwnedOctree>,
    grid: Grid,
    params: OctreeParams,
    cells: Vec<AtomicU32>,
    counters: [AtomicU32; COUNTER_WORDS],
    /// The open frame.
    recorded: Vec<Sample>,
    /// Number of frames so far, plus 1: what the next wipe is known by.
    frame: u32,
    layout: PhantomData<C>,
}

impl<C: CellRecord> OctreeCache<C> {
    /// An octree without data.
    pub fn new(octree: impl Into<Arc<OwnedOctree>>, params: OctreeParams) -> Self {
        let octree = octree.into();
        let words = |normal: &u32| {
            let cell = C::empty(*normal, params.wiped());
            let words: &[u32] = bytemuck::cast_slice(slice::from_ref(&cell));
            words.iter().copied().map(AtomicU32::new).collect::<Vec<_>>()
        };
        let cells = octree.normals.iter().flat_map(words).collect();
        Self {
            params,
            cells,
            counters: [const { AtomicU32::new(0) }; COUNTER_WORDS],
            recorded: Vec::new(),
            frame: 1,
            grid: *octree.view().grid(),
            octree,
            layout: PhantomData,
        }
    }

    /// The octree.
    pub const fn octree(&self) -> &Arc<OwnedOctree> {
        &self.octree
    }

    /// The parameters.
    pub const fn params(&self) -> &OctreeParams {
        &self.params
    }

    /// Replaces the parameters. Another quantum needs a [wipe](Self::wipe) in layouts whose means are in its units.
    pub const fn set_params(&mut self, params: OctreeParams) {
        self.params = params.with_wiped(self.params.wiped());
    }

    /// Forgets all light, recorded or merged.
    pub fn wipe(&mut self) {
        self.recorded.clear();
        self.params = self.params.with_wiped(self.frame);
    }

    /// The cell with this index, as it is stored.
    pub fn cell(&self, index: u32) -> C {
        self.cells().get(index)
    }

    /// Replaces a cell, as when a saved state is brought back.
    pub fn set_cell(&mut self, index: u32, cell: &C) {
        self.cells().set(index, cell);
    }

    /// Counters since the cache was made.
    pub fn counters(&self) -> Counters {
        read_counters(&self.counters)
    }

    fn cells(&self) -> SharedCells<'_, C> {
        SharedCells::new(&self.cells)
    }
}

impl<C: CellRecord> RadianceCache for OctreeCache<C> {
    fn record(&mut self, vertex: &VertexRecord) {
        let mut counters = Counters::default();
        let (grid, vertex) = (self.grid, slice::from_ref(vertex));
        let recorded = &mut self.recorded;
        sample_vertices(&grid, &self.params, vertex, &mut counters, |_, sample| {
            if sample.is_kept() {
                recorded.push(sample);
            }
        });
        add_counters(&self.counters, &counters);
    }

    fn estimate(&self, vertex: &VertexRecord) -> Estimate {
        let mut counters = Counters::default();
        let mut estimate = Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0, variance: 0.0 };
        let (octree, vertex) = (self.octree.view(), slice::from_ref(vertex));
        estimate_vertices(&octree, &self.cells(), &self.params, vertex, &mut counters, |_, found| estimate = found);
        add_counters(&self.counters, &counters);
        estimate
    }

    fn end_frame(&mut self) {
        let grid = self.grid;
        self.recorded.sort_by_cached_key(|sample| {
            let [low, high] = [0, 1].map(|part| sample_key(&grid, sample, part));
            (high, low)
        });
        let (octree, cells) = (self.octree.view(), SharedCells::<C>::new(&self.cells));
        let mut counters = Counters::default();
        for part in self.recorded.chunks(MAX_SAMPLES as usize) {
            for level in 0..grid.levels {
                merge_samples(&octree, &cells, &self.params, level, part, 0..MAX_SAMPLES, &mut counters);
            }
        }
        add_counters(&self.counters, &counters);
        self.recorded.clear();
        self.frame = self.frame.wrapping_add(1);
    }
}
