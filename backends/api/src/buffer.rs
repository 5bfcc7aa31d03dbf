//! Buffers by handle.

/// A buffer of one backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BufferId {
    /// Place in the backend's table.
    pub index: u32,
    /// Distinguishes the uses of one place over time.
    pub generation: u32,
}

/// What a buffer is created with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferDesc {
    /// Name in messages and in statistics.
    pub name: &'static str,
    /// Size in bytes, a multiple of 4, above 0.
    pub size: u64,
}

/// A range of a buffer bound to a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The buffer.
    pub buffer: BufferId,
    /// First byte, a multiple of 256.
    pub offset: u64,
    /// Bytes from there on, a multiple of 4.
    pub size: u64,
}
