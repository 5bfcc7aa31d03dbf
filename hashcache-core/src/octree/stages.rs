//! The octree as the pipeline sees it.

mod buffers;

use alloc::sync::Arc;
use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error, Items, Kernel, Primitive, Ticket};

use self::buffers::{Bound, Buffers, COUNTER_BYTES, create, frame_buffers, number};
use super::cell::{CellRecord, ExactCell, Layout, PaperCell};
use super::kernels::{ARRANGE, Kernels, RECORD, REKEY};
use super::merge::MAX_SAMPLES;
use super::owned::OwnedOctree;
use super::params::OctreeParams;
use super::sample::{Sample, sample_keys};
use crate::counters::Counters;
use crate::stages::CacheStages;

/// Records of a frame for which there is room at first.
const FIRST_RECORDS: u32 = 1 << 16;

/// Cells that are written to a buffer at once: a few megabytes.
const WRITTEN: usize = 1 << 16;

/// An octree and its data in the buffers of a backend.
///
/// `record` keeps a sample of each vertex of a batch (24 bytes); the batch's buffer is free as soon as the dispatch has
/// run. `update` sorts the samples by place, sums those of each cell and merges the sums into the cells of all levels,
/// once a frame. Lookups see what was merged.
///
/// A frame of more records than there is room for is merged in two parts, once; from then on there is room.
/// [`reserve`](Self::reserve) makes room beforehand.
#[derive(Debug)]
pub struct OctreeStages {
    octree: Arc<OwnedOctree>,
    params: OctreeParams,
    layout: Layout,
    levels: u32,
    /// Parts of the samples' keys.
    keys: u32,
    buffers: Option<Buffers>,
    /// Records for which the lists have room.
    capacity: u32,
    /// Records of the open frame.
    open: u32,
    /// Number of merges so far, plus 1: what the next wipe is known by.
    frame: u32,
    wipe: bool,
}

impl OctreeStages {
    /// Stages over an octree, with cells of layout [`Layout::Exact`].
    pub fn new(octree: impl Into<Arc<OwnedOctree>>, params: OctreeParams) -> Self {
        let octree = octree.into();
        let grid = *octree.view().grid();
        Self {
            octree,
            params,
            layout: Layout::Exact,
            levels: grid.levels,
            keys: sample_keys(&grid),
            buffers: None,
            capacity: FIRST_RECORDS,
            open: 0,
            frame: 1,
            wipe: false,
        }
    }

    /// The same with another layout of cells. Called before `prepare`.
    #[must_use]
    pub fn with_layout(mut self, layout: Layout) -> Self {
        debug_assert!(self.buffers.is_none(), "the cells have a layout already");
        self.layout = layout;
        self
    }

    /// The octree.
    pub const fn octree(&self) -> &Arc<OwnedOctree> {
        &self.octree
    }

    /// The parameters.
    pub const fn params(&self) -> &OctreeParams {
        &self.params
    }

    /// Replaces the parameters; cells keep what they hold. Another quantum than the one before needs a [wipe](Self::wipe)
    /// in layout [`Layout::Paper`], whose means are in its units, and no open frame.
    pub const fn set_params(&mut self, params: OctreeParams) {
        self.params = params.with_wiped(self.params.wiped());
    }

    /// Empties all cells, lazily: what was recorded before is never seen again, and each cell is cleared when light next
    /// comes to it.
    pub const fn wipe(&mut self) {
        self.wipe = true;
    }

    /// Number of cells on all levels.
    pub fn cells(&self) -> u32 {
        self.octree.normals.len() as u32
    }

    /// The layout of the cells.
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// Bytes of the cells' data.
    pub fn data_bytes(&self) -> u64 {
        u64::from(self.cells()) * u64::from(self.layout.cell_bytes())
    }

    /// Bytes of the tables that find cells.
    pub fn table_bytes(&self) -> u64 {
        4 * self.octree.words.len() as u64
    }

    /// Bytes that an open frame needs beside: 56 for each record there is room for.
    pub fn frame_bytes(&self) -> u64 {
        frame_buffers(self.capacity).iter().map(|desc| desc.size).sum()
    }

    /// The cells' buffer, once prepared.
    pub fn cell_buffer(&self) -> Option<BufferId> {
        self.buffers.map(|buffers| buffers.cells)
    }

    /// The most records of a frame that the lists can have room for.
    pub fn most_records<B: Backend + ?Sized>(backend: &B) -> u32 {
        let [.., sorted] = frame_buffers(1);
        (backend.max_binding_size() / sorted.size).min(u64::from(MAX_SAMPLES)) as u32
    }

    /// Makes room for frames of `records` records; what is open is merged first.
    ///
    /// # Errors
    /// Those of the backend; [`Error::BadSize`] above [`Self::most_records`].
    pub fn reserve<B: Backend>(&mut self, backend: &mut B, records: u32) -> Result<(), Error> {
        if records <= self.capacity {
            return Ok(());
        }
        let most = Self::most_records(backend);
        if records > most {
            let [.., sorted] = frame_buffers(records);
            return Err(Error::BadSize { at: sorted.name, size: sorted.size, limit: frame_buffers(most)[3].size });
        }
        if let Some(buffers) = self.buffers {
            self.merge(backend)?;
            let frame = create(backend, &frame_buffers(records))?;
            let old = buffers.frame;
            self.buffers = Some(Buffers { frame, ..buffers });
            self.capacity = records;
            number(backend, frame, records)?;
            for buffer in old {
                backend.destroy(buffer)?;
            }
        }
        self.capacity = records;
        Ok(())
    }

    /// Asks for the counters of everything submitted so far; [`OctreeStages::counters`] reads the bytes.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn read_counters<B: Backend>(&self, backend: &mut B) -> Result<Ticket, Error> {
        backend.read(self.buffers("read_counters")?.counters, 0, COUNTER_BYTES)
    }

    /// Sets the counters to zero, after all submitted work.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn reset_counters<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        backend.write(self.buffers("reset_counters")?.counters, 0, bytemuck::bytes_of(&Counters::default()))
    }

    /// The counters in the bytes that a ticket of [`read_counters`](Self::read_counters) was redeemed for.
    pub fn counters(bytes: &[u8]) -> Counters {
        bytemuck::try_pod_read_unaligned(bytes).unwrap_or_default()
    }

    /// Gives the buffers back. What they held is lost, an open frame too.
    ///
    /// # Errors
    /// Those of the backend.
    pub fn release<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.open = 0;
        if let Some(Buffers { structure, cells, counters, frame }) = self.buffers.take() {
            for buffer in [structure, cells, counters].into_iter().chain(frame) {
                backend.destroy(buffer)?;
            }
        }
        Ok(())
    }

    const fn kernels(&self) -> &'static Kernels {
        self.layout.kernels()
    }

    fn buffers(&self, at: &'static str) -> Result<Buffers, Error> {
        self.buffers.ok_or(Error::UnknownBuffer { at })
    }

    /// Everything bound whole.
    fn bindings(&self, kernel: &Kernel) -> Result<Bound, Error> {
        let Buffers { structure, cells, counters, frame } = self.buffers(kernel.name)?;
        let bind = |buffer, size| Binding { buffer, offset: 0, size };
        let sizes = frame_buffers(self.capacity).map(|desc| desc.size);
        let [keys, order, samples, sorted] = core::array::from_fn(|k| bind(frame[k], sizes[k]));
        Ok(Bound {
            structure: bind(structure, self.table_bytes()),
            cells: bind(cells, self.data_bytes()),
            counters: bind(counters, COUNTER_BYTES),
            keys,
            order,
            samples,
            sorted,
        })
    }

    /// Merges what is open, level by level.
    fn merge<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        if self.open == 0 {
            return Ok(());
        }
        let merge = self.kernels().merge;
        let Bound { structure, cells, counters, keys, order, samples, sorted } = self.bindings(merge)?;
        let count = self.open;
        let items = Items::Count(count);
        let params = bytemuck::bytes_of(&self.params);
        let sort = Primitive::SortPairs { keys: keys.buffer, values: order.buffer, count };
        backend.primitive(sort)?;
        if self.keys > 1 {
            backend.dispatch(&REKEY, params, &[structure, order, samples, keys], items)?;
            backend.primitive(sort)?;
        }
        backend.dispatch(&ARRANGE, params, &[order, samples, sorted], items)?;
        // The binding ends with the frame: what stands behind is older.
        let sorted = Binding { size: size_of::<Sample>() as u64 * u64::from(count), ..sorted };
        for level in 0..self.levels {
            let params = self.params.with_level(level);
            backend.dispatch(merge, bytemuck::bytes_of(&params), &[structure, cells, sorted, counters], items)?;
        }
        self.open = 0;
        self.frame = self.frame.wrapping_add(1);
        Ok(())
    }

    /// Makes room for `wanted` records of a frame, or at least for the next `count` of it.
    fn merge_and_grow<B: Backend>(&mut self, backend: &mut B, wanted: u32, count: u32) -> Result<(), Error> {
        // Half as much again, so that frames that grow slowly do not pay each time.
        let room = (wanted / 2).saturating_add(wanted).min(Self::most_records(backend));
        if room > self.capacity {
            return self.reserve(backend, room.max(count));
        }
        self.merge(backend)?;
        self.reserve(backend, count)
    }

    /// A wipe that was asked for. Light recorded before it is merged first, so that it is old, too.
    fn apply_wipe<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        if self.wipe {
            self.merge(backend)?;
            self.params = self.params.with_wiped(self.frame);
            self.wipe = false;
        }
        Ok(())
    }

    fn create<B: Backend>(&self, backend: &mut B) -> Result<Buffers, Error> {
        let [keys, order, samples, sorted] = frame_buffers(self.capacity);
        let desc = |name, size| BufferDesc { name, size };
        let [structure, cells, counters, frame @ ..]: [BufferId; 7] = create(
            backend,
            &[
                desc("octree.structure", self.table_bytes()),
                desc("octree.cells", self.data_bytes()),
                desc("octree.counters", COUNTER_BYTES),
                keys,
                order,
                samples,
                sorted,
            ],
        )?;
        Ok(Buffers { structure, cells, counters, frame })
    }

    /// Writes the tables, and empty cells with their normals.
    fn fill<B: Backend>(&self, backend: &mut B, buffers: &Buffers) -> Result<(), Error> {
        number(backend, buffers.frame, self.capacity)?;
        backend.write(buffers.structure, 0, bytemuck::cast_slice(&self.octree.words))?;
        match self.layout {
            Layout::Exact => self.fill_cells::<ExactCell, B>(backend, buffers.cells),
            Layout::Paper => self.fill_cells::<PaperCell, B>(backend, buffers.cells),
        }
    }

    fn fill_cells<C: CellRecord, B: Backend>(&self, backend: &mut B, cells: BufferId) -> Result<(), Error> {
        let mut offset = 0;
        for normals in self.octree.normals.chunks(WRITTEN) {
            let part: Vec<C> = normals.iter().map(|normal| C::empty(*normal, self.params.wiped())).collect();
            backend.write(cells, offset, bytemuck::cast_slice(&part))?;
            offset += size_of_val(part.as_slice()) as u64;
        }
        Ok(())
    }
}

impl<B: Backend> CacheStages<B> for OctreeStages {
    /// Creates and fills the buffers, or empties cells and counters of an earlier call.
    fn prepare(&mut self, backend: &mut B) -> Result<(), Error> {
        if self.buffers.is_some() {
            self.wipe();
            return self.reset_counters(backend);
        }
        let buffers = self.create(backend)?;
        self.buffers = Some(buffers);
        if let Err(error) = self.fill(backend, &buffers) {
            self.release(backend)?;
            return Err(error);
        }
        Ok(())
    }

    fn record(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), Error> {
        self.apply_wipe(backend)?;
        let wanted = self.open.saturating_add(count);
        if wanted > self.capacity {
            self.merge_and_grow(backend, wanted, count)?;
        }
        let Bound { structure, counters, keys, samples, .. } = self.bindings(&RECORD)?;
        let params = self.params.with_first(self.open);
        let bindings = [structure, records, samples, keys, counters];
        backend.dispatch(&RECORD, bytemuck::bytes_of(&params), &bindings, Items::Count(count))?;
        self.open += count;
        Ok(())
    }

    fn update(&mut self, backend: &mut B) -> Result<(), Error> {
        self.apply_wipe(backend)?;
        self.merge(backend)
    }

    fn query(&mut self, backend: &mut B, records: Binding, estimates: Binding, count: u32) -> Result<(), Error> {
        self.apply_wipe(backend)?;
        let kernel = self.kernels().lookup;
        let Bound { structure, cells, counters, .. } = self.bindings(kernel)?;
        let bindings = [structure, cells, records, counters, estimates];
        backend.dispatch(kernel, bytemuck::bytes_of(&self.params), &bindings, Items::Count(count))
    }

    fn kernels(&self) -> Vec<&'static str> {
        let Kernels { merge, lookup } = Self::kernels(self);
        let rekey = if self.keys > 1 { Some(REKEY.name) } else { None };
        [RECORD.name].into_iter().chain(rekey).chain([ARRANGE.name, merge.name, lookup.name]).collect()
    }
}
