//! The trait that every launcher implements.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

use crate::BufferId;
#[cfg(feature = "alloc")]
use crate::{Binding, BufferDesc, Error, Kernel, Primitive, Status};

/// How many items a dispatch has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Items {
    /// A number known to the caller.
    Count(u32),
    /// The word `index` of `buffer` when the dispatch's turn comes, at most `max`. The kernel does not write the buffer.
    FromBuffer {
        /// Holds the count.
        buffer: BufferId,
        /// Which word.
        index: u32,
        /// Upper bound; bindings must suffice for it.
        max: u32,
    },
}

impl Items {
    /// The most items that can come to run.
    pub const fn max(self) -> u32 {
        match self {
            Self::Count(count) => count,
            Self::FromBuffer { max, .. } => max,
        }
    }
}

/// A claim on a value that will be ready later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket(
    /// The backend's number for it.
    pub u64,
);

/// Owns buffers, launches kernels.
///
/// Dispatches and primitives are recorded and run, in order, by [`Backend::submit`]; each sees what those before it
/// wrote. Creating, writing and reading act at once, after everything submitted and before everything only recorded.
///
/// # Laws
/// - Creating zero-fills. A handle is never given out twice.
/// - A call with bad arguments returns the error that [`crate::check`] finds and changes nothing.
/// - What a read returns is the state at the time of the call.
/// - A destroyed buffer's handle is dead at once; commands recorded before still use the buffer.
/// - A kernel whose body obeys the access modes of its bindings gives equal integer results on every backend and for
///   every number of threads.
///
/// An example stands on the page of each backend.
#[cfg(feature = "alloc")]
pub trait Backend {
    /// The backend's name: `serial`, `rayon`, `wgpu`.
    fn name(&self) -> &'static str;

    /// Largest size of one binding in bytes.
    fn max_binding_size(&self) -> u64;

    /// Creates a zero-filled buffer.
    ///
    /// # Errors
    /// [`Error::BadSize`], [`Error::OutOfMemory`].
    fn create(&mut self, desc: &BufferDesc) -> Result<BufferId, Error>;

    /// Releases a buffer.
    ///
    /// # Errors
    /// [`Error::UnknownBuffer`].
    fn destroy(&mut self, buffer: BufferId) -> Result<(), Error>;

    /// Copies `bytes` (a multiple of 4, or none) to `offset` (a multiple of 4), after all submitted work.
    ///
    /// # Errors
    /// [`Error::UnknownBuffer`], [`Error::BadRange`].
    fn write(&mut self, buffer: BufferId, offset: u64, bytes: &[u8]) -> Result<(), Error>;

    /// Records a dispatch of `kernel` over `items`. A buffer that the kernel writes is bound once.
    ///
    /// # Errors
    /// Those of [`crate::check::dispatch`]; [`Error::Unsupported`] when the kernel has no body for this backend;
    /// [`Error::Shader`].
    fn dispatch(
        &mut self,
        kernel: &'static Kernel,
        params: &[u8],
        bindings: &[Binding],
        items: Items,
    ) -> Result<(), Error>;

    /// Records a primitive.
    ///
    /// # Errors
    /// Those of [`crate::check::primitive`].
    fn primitive(&mut self, primitive: Primitive) -> Result<(), Error>;

    /// Runs everything recorded, in order. The flags of each dispatch can be had by [`Backend::statuses`].
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::Shader`]; [`Error::OutOfMemory`] when a primitive finds no room to work in (what
    /// follows it does not run).
    fn submit(&mut self) -> Result<(), Error>;

    /// Waits for the submitted work and returns kernel name and flags of each dispatch since the last call, in order.
    ///
    /// # Errors
    /// [`Error::NotRun`] when a dispatch with items never ran, [`Error::DeviceLost`]. The list is given up then, too.
    fn statuses(&mut self) -> Result<Vec<(&'static str, Status)>, Error>;

    /// Asks for bytes of a buffer (a multiple of 4, or none, from a multiple of 4 on) as they stand after all submitted
    /// work.
    ///
    /// # Errors
    /// [`Error::UnknownBuffer`], [`Error::BadRange`], [`Error::OutOfMemory`].
    fn read(&mut self, buffer: BufferId, offset: u64, size: u64) -> Result<Ticket, Error>;

    /// The bytes asked for, once, or `None` while they are not ready; `wait` blocks until they are (where the platform
    /// can).
    ///
    /// # Errors
    /// [`Error::UnknownTicket`], [`Error::DeviceLost`].
    fn redeem(&mut self, ticket: Ticket, wait: bool) -> Result<Option<Vec<u8>>, Error>;
}
