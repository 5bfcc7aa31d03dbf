//! An octree with its data, owned, for host programs with loops of their own.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::marker::PhantomData;
use core::slice;
use core::sync::atomic::AtomicU32;

use glam::Vec3;

use super::cell::{CellRecord, ExactCell};
use super::cells::{ReadCells, SharedCells};
use super::deposit::deposit_samples;
use super::grid::Grid;
use super::lookup::estimate_vertices;
use super::merge::merge_entries;
use super::owned::OwnedOctree;
use super::params::OctreeParams;
use super::pending::{MAX_RECORDS, Pending, add_counters, counters_in};
use super::sample::{NO_SAMPLE, Sample, sample_vertices};
use crate::counters::Counters;
use crate::record::VertexRecord;
use crate::traits::{Estimate, RadianceCache};

/// An octree, its cells in layout `C`, and its counters, as a [`RadianceCache`].
///
/// `record` only remembers a sample (28 bytes); `end_frame` merges all samples at once, so their order has no influence.
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
    marks: Vec<AtomicU32>,
    lists: Vec<AtomicU32>,
    /// Keys and samples of the open frame.
    recorded: Vec<(u32, Sample)>,
    /// Number of frames so far, plus 1: what the next wipe is known by.
    frame: u32,
    layout: PhantomData<C>,
}

fn zeroed(words: u64) -> Vec<AtomicU32> {
    (0..words).map(|_| AtomicU32::new(0)).collect()
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
        let [marks, _] = Pending::words(octree.normals.len() as u32, 0);
        Self {
            params,
            cells,
            marks: zeroed(marks),
            lists: Vec::new(),
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
        counters_in(&self.marks)
    }

    fn cells(&self) -> SharedCells<'_, C> {
        SharedCells::new(&self.cells)
    }

    /// Merges up to [`MAX_RECORDS`] samples.
    fn merge(&mut self, samples: &[Sample]) {
        let octree = self.octree.view();
        let [_, lists] = Pending::words(0, samples.len() as u32);
        if (self.lists.len() as u64) < lists {
            self.lists = zeroed(lists);
        }
        let Ok(pending) = Pending::new(&self.marks, &self.lists, octree.cells()) else { return };
        let cells = SharedCells::<C>::new(&self.cells);
        let mut counters = Counters::default();
        deposit_samples(&octree, &cells, &pending, samples, &mut counters);
        for level in 0..=octree.grid().levels {
            merge_entries(&octree, &cells, &pending, &self.params, level, 0..pending.capacity());
        }
        pending.add_counters(&counters);
    }
}

impl<C: CellRecord> RadianceCache for OctreeCache<C> {
    fn record(&mut self, vertex: &VertexRecord) {
        let mut counters = Counters::default();
        let (grid, vertex) = (self.grid, slice::from_ref(vertex));
        let recorded = &mut self.recorded;
        sample_vertices(&grid, &self.params, vertex, &mut counters, |_, key, sample| {
            if key != NO_SAMPLE {
                recorded.push((key, sample));
            }
        });
        add_counters(&self.marks, &counters);
    }

    fn estimate(&self, vertex: &VertexRecord) -> Estimate {
        let mut counters = Counters::default();
        let mut estimate = Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0 };
        let (octree, vertex) = (self.octree.view(), slice::from_ref(vertex));
        estimate_vertices(&octree, &self.cells(), &self.params, vertex, &mut counters, |_, found| estimate = found);
        add_counters(&self.marks, &counters);
        estimate
    }

    fn end_frame(&mut self) {
        self.recorded.sort_unstable_by_key(|(key, _)| *key);
        let samples: Vec<_> = self.recorded.drain(..).map(|(_, sample)| sample).collect();
        for part in samples.chunks(MAX_RECORDS as usize) {
            self.merge(part);
        }
        self.frame = self.frame.wrapping_add(1);
    }
}
