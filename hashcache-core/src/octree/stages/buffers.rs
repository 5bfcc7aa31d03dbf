//! The buffers behind the stages.

use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error};

use crate::octree::sample::Sample;
use crate::octree::tally::COUNTER_WORDS;

/// What lives as long as the stages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Buffers {
    pub structure: BufferId,
    pub cells: BufferId,
    pub counters: BufferId,
    /// [`frame_buffers`].
    pub frame: [BufferId; 4],
}

pub(super) const COUNTER_BYTES: u64 = 4 * COUNTER_WORDS as u64;

/// What kernels bind.
pub(super) struct Bound {
    pub structure: Binding,
    pub cells: Binding,
    pub counters: Binding,
    pub keys: Binding,
    pub order: Binding,
    pub samples: Binding,
    pub sorted: Binding,
}

/// Buffers of an open frame with room for `records`: keys, order, samples, sorted samples.
pub(super) const fn frame_buffers(records: u32) -> [BufferDesc; 4] {
    let (words, samples) = (4 * records as u64, size_of::<Sample>() as u64 * records as u64);
    [
        BufferDesc { name: "octree.keys", size: words },
        BufferDesc { name: "octree.order", size: words },
        BufferDesc { name: "octree.samples", size: samples },
        BufferDesc { name: "octree.sorted", size: samples },
    ]
}

/// Creates all buffers, or none.
pub(super) fn create<B: Backend, const N: usize>(
    backend: &mut B,
    all: &[BufferDesc; N],
) -> Result<[BufferId; N], Error> {
    let limit = backend.max_binding_size();
    if let Some(&BufferDesc { name, size }) = all.iter().find(|desc| desc.size > limit) {
        return Err(Error::BadSize { at: name, size, limit });
    }
    let mut made = [BufferId { index: 0, generation: 0 }; N];
    for (k, desc) in all.iter().enumerate() {
        match backend.create(desc) {
            Ok(buffer) => made[k] = buffer,
            Err(error) => {
                for buffer in &made[..k] {
                    backend.destroy(*buffer)?;
                }
                return Err(error);
            }
        }
    }
    Ok(made)
}

/// Numbers the order from 0 on.
pub(super) fn number<B: Backend>(backend: &mut B, frame: [BufferId; 4], records: u32) -> Result<(), Error> {
    let order: Vec<u32> = (0..records).collect();
    backend.write(frame[1], 0, bytemuck::cast_slice(&order))
}
