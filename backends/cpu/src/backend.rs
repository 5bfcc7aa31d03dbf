//! The launchers' face: buffers, recording, submitting, reading.

use std::collections::HashMap;
use std::mem;
use std::sync::atomic::AtomicU32;

use backend_api::check::{self, Limits};
use backend_api::{
    Backend, Binding, BufferDesc, BufferId, BufferTable, Error, Items, Kernel, Primitive, Status, Ticket, TraceRays,
};
use bytemuck::Zeroable;
use hashcache_core::geometry::Geometry;
use hashcache_core::stages::CastsRays;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::launch::{self, Cut, Dispatch};
use crate::primitives;
use crate::rays::CpuScene;
use crate::storage::{BLOCK, Block, Storage};

/// Runs kernels' Rust bodies: in order on the calling thread ([`CpuBackend::serial`]) or on a pool of its own
/// ([`CpuBackend::rayon`]). Both give equal bits.
pub struct CpuBackend {
    pool: Option<ThreadPool>,
    cut: Cut,
    table: BufferTable<Storage>,
    /// Destroyed while recorded commands still name them; released by the next submit.
    doomed: Vec<BufferId>,
    commands: Vec<Command>,
    /// Parameter blocks of the recorded commands.
    params: Vec<Block>,
    statuses: Vec<(&'static str, AtomicU32)>,
    scene: Option<CpuScene>,
    reads: HashMap<u64, Vec<u8>>,
    tickets: u64,
}

enum Command {
    Dispatch(Dispatch),
    Primitive(Primitive),
}

impl CpuBackend {
    /// Most threads of a pool.
    pub const MAX_THREADS: usize = 1024;

    /// A launcher that runs everything in order on the thread that submits.
    pub fn serial() -> Self {
        Self::new(None, 1)
    }

    /// A launcher with a pool of `threads` threads of its own; 0: one for each core.
    ///
    /// # Errors
    /// [`Error::Threads`] for more than [`Self::MAX_THREADS`] or when the system refuses them.
    pub fn rayon(threads: usize) -> Result<Self, Error> {
        let refused = Error::Threads { wanted: u32::try_from(threads).unwrap_or(u32::MAX) };
        if threads > Self::MAX_THREADS {
            return Err(refused);
        }
        let name = |k| format!("hashcache-{k}");
        let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(name).build().map_err(|_| refused)?;
        let threads = pool.current_num_threads() as u32;
        Ok(Self::new(Some(pool), threads))
    }

    /// Fixes the number of items of a launch; 0, the default, chooses by the number of items and threads. Results do
    /// not depend on it: for tests and for measuring.
    #[must_use]
    pub fn with_launch_items(mut self, items: u32) -> Self {
        self.cut.items = items;
        self
    }

    /// Threads that run launches.
    pub fn threads(&self) -> usize {
        self.cut.threads as usize
    }

    fn new(pool: Option<ThreadPool>, threads: u32) -> Self {
        Self {
            pool,
            cut: Cut { threads, items: 0 },
            table: BufferTable::new(),
            doomed: Vec::new(),
            commands: Vec::new(),
            params: Vec::new(),
            statuses: Vec::new(),
            scene: None,
            reads: HashMap::new(),
            tickets: 0,
        }
    }

    fn limits(&self) -> Limits {
        Limits { max_binding_size: self.max_binding_size(), has_geometry: self.scene.is_some() }
    }

    /// The size of a buffer, unless its handle is dead.
    fn size_of(&self, buffer: BufferId) -> Option<u64> {
        if self.doomed.contains(&buffer) { None } else { self.table.get(buffer).map(Storage::size) }
    }
}

impl Backend for CpuBackend {
    fn name(&self) -> &'static str {
        if self.pool.is_some() { "rayon" } else { "serial" }
    }

    /// What the address space holds.
    fn max_binding_size(&self) -> u64 {
        (isize::MAX as usize / BLOCK * BLOCK) as u64
    }

    fn create(&mut self, desc: &BufferDesc) -> Result<BufferId, Error> {
        check::create(desc, self.max_binding_size())?;
        Ok(self.table.insert(Storage::zeroed(desc.size)?))
    }

    fn destroy(&mut self, buffer: BufferId) -> Result<(), Error> {
        self.size_of(buffer).ok_or(Error::UnknownBuffer { at: "destroy" })?;
        if self.commands.is_empty() {
            self.table.remove(buffer);
        } else {
            self.doomed.push(buffer);
        }
        Ok(())
    }

    fn write(&mut self, buffer: BufferId, offset: u64, bytes: &[u8]) -> Result<(), Error> {
        check::transfer("write", offset, bytes.len() as u64, self.size_of(buffer))?;
        if let Some(storage) = self.table.get_mut(buffer) {
            storage.bytes_mut()[offset as usize..][..bytes.len()].copy_from_slice(bytes);
        }
        Ok(())
    }

    fn dispatch(
        &mut self,
        kernel: &'static Kernel,
        params: &[u8],
        bindings: &[Binding],
        items: Items,
    ) -> Result<(), Error> {
        check::dispatch(kernel, params, bindings, items, &self.limits(), |buffer| self.size_of(buffer))?;
        let first = self.params.len();
        self.params.resize(first + params.len().div_ceil(BLOCK), Block::zeroed());
        bytemuck::cast_slice_mut(&mut self.params[first..])[..params.len()].copy_from_slice(params);
        let mut slots = [None; Kernel::MAX_BINDINGS];
        for (slot, &binding) in slots.iter_mut().zip(bindings) {
            *slot = Some(binding);
        }
        let params = first..self.params.len();
        self.commands.push(Command::Dispatch(Dispatch { kernel, params, bindings: slots, items }));
        Ok(())
    }

    fn primitive(&mut self, primitive: Primitive) -> Result<(), Error> {
        check::primitive(&primitive, &self.limits(), |buffer| self.size_of(buffer))?;
        self.commands.push(Command::Primitive(primitive));
        Ok(())
    }

    fn submit(&mut self) -> Result<(), Error> {
        let commands = mem::take(&mut self.commands);
        let params = mem::take(&mut self.params);
        let mut current = self.statuses.len();
        self.statuses.extend(commands.iter().filter_map(|command| match command {
            Command::Dispatch(dispatch) => Some((dispatch.kernel.name, AtomicU32::new(Status::NOT_RUN.bits()))),
            Command::Primitive(_) => None,
        }));
        let Self { pool, cut, table, statuses, scene, .. } = self;
        let rays = scene.as_ref().map(|scene| scene as &dyn TraceRays);
        let mut run = || {
            for command in &commands {
                match command {
                    Command::Dispatch(dispatch) => {
                        launch::run(dispatch, &params, table, rays, *cut, &statuses[current].1);
                        current += 1;
                    }
                    Command::Primitive(primitive) => primitives::run(primitive, table, *cut)?,
                }
            }
            Ok(())
        };
        let outcome = match pool {
            Some(pool) => pool.install(run),
            None => run(),
        };
        for buffer in self.doomed.drain(..) {
            self.table.remove(buffer);
        }
        outcome
    }

    fn statuses(&mut self) -> Result<Vec<(&'static str, Status)>, Error> {
        let statuses = mem::take(&mut self.statuses);
        let statuses = statuses.into_iter().map(|(kernel, status)| (kernel, Status::from_bits(status.into_inner())));
        statuses
            .map(
                |(kernel, status)| {
                    if status.contains(Status::NOT_RUN) { Err(Error::NotRun { kernel }) } else { Ok((kernel, status)) }
                },
            )
            .collect()
    }

    fn read(&mut self, buffer: BufferId, offset: u64, size: u64) -> Result<Ticket, Error> {
        check::transfer("read", offset, size, self.size_of(buffer))?;
        let mut bytes = Vec::new();
        if let Some(storage) = self.table.get(buffer) {
            let range = &storage.bytes()[offset as usize..][..size as usize];
            bytes.try_reserve_exact(range.len()).map_err(|_| Error::OutOfMemory { size })?;
            bytes.extend_from_slice(range);
        }
        let ticket = self.tickets;
        self.tickets += 1;
        self.reads.insert(ticket, bytes);
        Ok(Ticket(ticket))
    }

    fn redeem(&mut self, ticket: Ticket, _wait: bool) -> Result<Option<Vec<u8>>, Error> {
        self.reads.remove(&ticket.0).map(Some).ok_or(Error::UnknownTicket)
    }
}

impl CastsRays for CpuBackend {
    fn set_geometry(&mut self, geometry: &Geometry<'_>) -> Result<(), Error> {
        let Self { pool, scene, .. } = self;
        let build = || CpuScene::build(geometry);
        *scene = Some(match pool {
            Some(pool) => pool.install(build),
            None => build(),
        }?);
        Ok(())
    }
}
