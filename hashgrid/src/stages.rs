//! The grid as the pipeline sees it.

use alloc::vec;
use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error, Items, Kernel, Ticket};
use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{CacheStages, EstimateRecord};

use crate::kernels::{CLAIM, CLEAR, DEPOSIT, FADE, FadeParams, LOOKUP};
use crate::layout::Standard;
use crate::params::Params;
use crate::table::{CELL_WORDS, Table};

/// Bytes of a cell.
const CELL_BYTES: u64 = (CELL_WORDS * 8) as u64;

const COUNTER_BYTES: u64 = size_of::<Counters>() as u64;

/// A grid in the buffers of a backend.
///
/// `record` claims and deposits its batch at once: a batch's buffer is free as soon as its dispatches have run. Keys of
/// earlier batches keep their cells, so with a table that is nearly full, which keys are refused depends on how the
/// frame is cut into batches (never on threads or backends); where nothing is refused, sums do not.
/// [`claim`](Self::claim) and [`deposit`](Self::deposit) are there for programs that hold a whole frame.
///
/// `update` has nothing left to do. Sums stay until [`clear`](Self::clear), so a static view converges.
#[derive(Debug)]
pub struct GridStages {
    params: Params,
    cells: u32,
    buffers: Option<[BufferId; 2]>,
}

impl GridStages {
    /// A grid of `cells` cells (a power of two from [`crate::table::MIN_CELLS`] on, 64 bytes each).
    ///
    /// # Errors
    /// Those of [`Table::new`].
    pub fn new(params: Params, cells: u32) -> Result<Self, ParamError> {
        Table::<Standard>::check_words((cells as usize).saturating_mul(CELL_WORDS))?;
        Ok(Self { params, cells, buffers: None })
    }

    /// The largest number of cells, a power of two up to `wanted`, whose table fits into one binding of `backend`.
    pub fn cells_within<B: Backend + ?Sized>(backend: &B, wanted: u32) -> u32 {
        let most = (backend.max_binding_size() / CELL_BYTES).min(u64::from(wanted)).min(1 << 31);
        if most == 0 { 0 } else { 1 << most.ilog2() }
    }

    /// The parameters.
    pub const fn params(&self) -> &Params {
        &self.params
    }

    /// Replaces the parameters, for a camera that moved or was zoomed; keys of other parameters stay in the table until
    /// [`clear`](Self::clear).
    pub const fn set_params(&mut self, params: Params) {
        self.params = params;
    }

    /// Number of cells.
    pub const fn cells(&self) -> u32 {
        self.cells
    }

    /// Bytes of the table.
    pub const fn table_bytes(&self) -> u64 {
        self.cells as u64 * CELL_BYTES
    }

    /// The table's buffer, once prepared.
    pub fn table(&self) -> Option<BufferId> {
        self.buffers.map(|[table, _]| table)
    }

    /// Records the emptying of the table.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn clear<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        let table = self.table_binding(&CLEAR)?;
        backend.dispatch(&CLEAR, bytemuck::bytes_of(&self.params), &[table], Items::Count(self.cells))
    }

    /// Records that cells forget what is more than `most` deposits: at the start of a frame, so that a change of the light
    /// fades ([`crate::temporal::FixedCount`]).
    ///
    /// # Errors
    /// Those of the backend, which has to run host code; [`Error::UnknownBuffer`] before `prepare`.
    pub fn fade<B: Backend>(&mut self, backend: &mut B, most: u32) -> Result<(), Error> {
        let table = self.table_binding(&FADE)?;
        let params = FadeParams { params: self.params, most, reserved: [0; 3] };
        backend.dispatch(&FADE, bytemuck::bytes_of(&params), &[table], Items::Count(self.cells))
    }

    /// Records the claims of `count` vertices.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn claim<B: Backend>(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), Error> {
        let table = self.table_binding(&CLAIM)?;
        backend.dispatch(&CLAIM, bytemuck::bytes_of(&self.params), &[table, records], Items::Count(count))
    }

    /// Records the deposits of `count` vertices, whose claims were recorded before.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn deposit<B: Backend>(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), Error> {
        let bindings = [self.table_binding(&DEPOSIT)?, records, self.counter_binding(&DEPOSIT)?];
        backend.dispatch(&DEPOSIT, bytemuck::bytes_of(&self.params), &bindings, Items::Count(count))
    }

    /// Asks for the counters of everything submitted so far; [`GridStages::counters`] reads the bytes.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn read_counters<B: Backend>(&self, backend: &mut B) -> Result<Ticket, Error> {
        let binding = self.counter_binding(&DEPOSIT)?;
        backend.read(binding.buffer, 0, COUNTER_BYTES)
    }

    /// Sets the counters to zero, after all submitted work.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn reset_counters<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        let binding = self.counter_binding(&DEPOSIT)?;
        backend.write(binding.buffer, 0, bytemuck::bytes_of(&Counters::default()))
    }

    /// The counters in the bytes that a ticket of [`read_counters`](Self::read_counters) was redeemed for.
    pub fn counters(bytes: &[u8]) -> Counters {
        bytemuck::try_pod_read_unaligned(bytes).unwrap_or_default()
    }

    /// Gives the buffers back.
    ///
    /// # Errors
    /// Those of the backend.
    pub fn release<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        for buffer in self.buffers.take().into_iter().flatten() {
            backend.destroy(buffer)?;
        }
        Ok(())
    }

    fn table_binding(&self, kernel: &Kernel) -> Result<Binding, Error> {
        let [buffer, _] = self.buffers.ok_or(Error::UnknownBuffer { at: kernel.name })?;
        Ok(Binding { buffer, offset: 0, size: self.table_bytes() })
    }

    fn counter_binding(&self, kernel: &Kernel) -> Result<Binding, Error> {
        let [_, buffer] = self.buffers.ok_or(Error::UnknownBuffer { at: kernel.name })?;
        Ok(Binding { buffer, offset: 0, size: COUNTER_BYTES })
    }
}

impl<B: Backend> CacheStages<B> for GridStages {
    /// Creates table and counters, or empties those of an earlier call.
    fn prepare(&mut self, backend: &mut B) -> Result<(), Error> {
        if self.buffers.is_none() {
            let (size, limit) = (self.table_bytes(), backend.max_binding_size());
            if size > limit {
                return Err(Error::BadSize { at: "hashgrid.table", size, limit });
            }
            let table = backend.create(&BufferDesc { name: "hashgrid.table", size })?;
            let counters = match backend.create(&BufferDesc { name: "hashgrid.counters", size: COUNTER_BYTES }) {
                Ok(counters) => counters,
                Err(error) => {
                    backend.destroy(table)?;
                    return Err(error);
                }
            };
            self.buffers = Some([table, counters]);
        } else {
            self.reset_counters(backend)?;
        }
        self.clear(backend)
    }

    fn record(&mut self, backend: &mut B, records: Binding, count: u32) -> Result<(), Error> {
        self.claim(backend, records, count)?;
        self.deposit(backend, records, count)
    }

    fn update(&mut self, _backend: &mut B) -> Result<(), Error> {
        Ok(())
    }

    fn query(&mut self, backend: &mut B, records: Binding, estimates: Binding, count: u32) -> Result<(), Error> {
        let bindings = [self.table_binding(&LOOKUP)?, records, self.counter_binding(&LOOKUP)?, estimates];
        backend.dispatch(&LOOKUP, bytemuck::bytes_of(&self.params), &bindings, Items::Count(count))
    }

    fn kernels(&self) -> Vec<&'static str> {
        vec![CLAIM.name, DEPOSIT.name, LOOKUP.name]
    }
}

// The strides that the kernels declare are those of the records.
const _: () = assert!(size_of::<VertexRecord>() == 96 && size_of::<EstimateRecord>() == 32);
