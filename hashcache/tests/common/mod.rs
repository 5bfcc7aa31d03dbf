//! A launcher whose calls a test watches.

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error, Items, Kernel, Primitive, Status, Ticket};
use backend_cpu::CpuBackend;
use hashcache_core::geometry::Geometry;
use hashcache_core::stages::CastsRays;

/// What a test wants to know of calls.
pub trait Watch {
    /// Before anything is made, written or computed; an error is the call's.
    fn call(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// A buffer was made.
    fn created(&mut self, buffer: BufferId, desc: &BufferDesc);

    /// A buffer is given back.
    fn destroyed(&mut self, buffer: BufferId);

    /// So many bytes are written.
    fn written(&mut self, _bytes: usize) {}

    /// A kernel runs on these buffers.
    fn dispatched(&mut self, _kernel: &'static Kernel, _bindings: &[Binding]) {}
}

/// The serial launcher, watched.
pub struct Watched<W> {
    backend: CpuBackend,
    pub watch: W,
}

impl<W: Watch> Watched<W> {
    pub fn new(watch: W) -> Self {
        Self { backend: CpuBackend::serial(), watch }
    }
}

impl<W: Watch> Backend for Watched<W> {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn max_binding_size(&self) -> u64 {
        self.backend.max_binding_size()
    }

    fn create(&mut self, desc: &BufferDesc) -> Result<BufferId, Error> {
        self.watch.call()?;
        let buffer = self.backend.create(desc)?;
        self.watch.created(buffer, desc);
        Ok(buffer)
    }

    fn destroy(&mut self, buffer: BufferId) -> Result<(), Error> {
        self.watch.destroyed(buffer);
        self.backend.destroy(buffer)
    }

    fn write(&mut self, buffer: BufferId, offset: u64, bytes: &[u8]) -> Result<(), Error> {
        self.watch.call()?;
        self.watch.written(bytes.len());
        self.backend.write(buffer, offset, bytes)
    }

    fn dispatch(&mut self, kernel: &'static Kernel, params: &[u8], to: &[Binding], items: Items) -> Result<(), Error> {
        self.watch.call()?;
        self.watch.dispatched(kernel, to);
        self.backend.dispatch(kernel, params, to, items)
    }

    fn primitive(&mut self, primitive: Primitive) -> Result<(), Error> {
        self.watch.call()?;
        self.backend.primitive(primitive)
    }

    fn submit(&mut self) -> Result<(), Error> {
        self.watch.call()?;
        self.backend.submit()
    }

    fn statuses(&mut self) -> Result<Vec<(&'static str, Status)>, Error> {
        self.backend.statuses()
    }

    fn read(&mut self, buffer: BufferId, offset: u64, size: u64) -> Result<Ticket, Error> {
        self.backend.read(buffer, offset, size)
    }

    fn redeem(&mut self, ticket: Ticket, wait: bool) -> Result<Option<Vec<u8>>, Error> {
        self.backend.redeem(ticket, wait)
    }
}

impl<W: Watch> CastsRays for Watched<W> {
    fn set_geometry(&mut self, geometry: &Geometry<'_>) -> Result<(), Error> {
        self.backend.set_geometry(geometry)
    }
}
