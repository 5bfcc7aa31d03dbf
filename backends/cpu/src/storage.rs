//! Memory of a buffer: aligned for every record and for atomics.

use backend_api::Error;
use bytemuck::{Pod, Zeroable};
use zerocopy::{FromBytes, IntoBytes, KnownLayout};

/// The grain of storage: a cache line, so that a 64-byte cell never straddles two.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Block([u64; 8]);

/// Bytes of a [`Block`].
pub(crate) const BLOCK: usize = size_of::<Block>();

/// A buffer's memory, zero at first.
pub(crate) struct Storage {
    blocks: Box<[Block]>,
    /// Bytes in use; the last block may hold more.
    size: usize,
}

impl Storage {
    /// Memory of `size` bytes.
    pub(crate) fn zeroed(size: u64) -> Result<Self, Error> {
        let out_of_memory = Error::OutOfMemory { size };
        let bytes = usize::try_from(size).map_err(|_| out_of_memory)?;
        let blocks = bytemuck::allocation::try_zeroed_slice_box(bytes.div_ceil(BLOCK)).map_err(|()| out_of_memory)?;
        Ok(Self { blocks, size: bytes })
    }

    /// Size in bytes.
    pub(crate) fn size(&self) -> u64 {
        self.size as u64
    }

    /// All bytes; the first lies on a 64-byte border.
    pub(crate) fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.blocks)[..self.size]
    }

    /// All bytes, to be changed.
    pub(crate) fn bytes_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.blocks)[..self.size]
    }

    /// All words.
    pub(crate) fn words(&self) -> &[u32] {
        bytemuck::cast_slice(self.bytes())
    }

    /// All pairs of words; the size is a multiple of 8.
    pub(crate) fn pairs(&self) -> &[u64] {
        bytemuck::cast_slice(self.bytes())
    }

    /// All pairs of words, to be changed; the size is a multiple of 8.
    pub(crate) fn pairs_mut(&mut self) -> &mut [u64] {
        bytemuck::cast_slice_mut(self.bytes_mut())
    }

    /// All words, to be changed.
    pub(crate) fn words_mut(&mut self) -> &mut [u32] {
        bytemuck::cast_slice_mut(self.bytes_mut())
    }
}

/// Bytes of a [`Storage`] as atomics. The bytes start at a multiple of `T`'s size and are a whole number of `T`.
pub(crate) fn atomics<T>(bytes: &mut [u8]) -> &[T]
where
    [T]: FromBytes + IntoBytes + KnownLayout<PointerMetadata = usize>,
{
    <[T]>::mut_from_bytes(bytes).unwrap_or_else(|_| unreachable!("storage is aligned, and ranges of it were checked"))
}
