//! What a kernel's host body sees of one launch.

use core::mem;
use core::ops::Range;
#[cfg(target_has_atomic = "64")]
use core::sync::atomic::AtomicU64;
use core::sync::atomic::{AtomicU32, Ordering};

use bytemuck::Pod;

use crate::{Status, TraceRays};

/// The part of one bound buffer that a launch may touch.
pub enum Slot<'a> {
    /// The whole bound range, shared.
    In(&'a [u8]),
    /// The elements of this launch's items, exclusively; empty once taken.
    Out(&'a mut [u8]),
    /// The whole bound range as 32-bit atomics.
    AtomicU32(&'a [AtomicU32]),
    /// The whole bound range as 64-bit atomics, where the target has them.
    #[cfg(target_has_atomic = "64")]
    AtomicU64(&'a [AtomicU64]),
}

/// A range of items of one dispatch, with the buffers, parameters and rays they may use.
///
/// A backend cuts a dispatch into launches as it likes; a body must give the same result for every cut.
pub struct Launch<'a> {
    /// Index of the first item within the dispatch.
    pub first: u32,
    /// Number of items.
    pub count: u32,
    /// The dispatch's parameter block.
    pub params: &'a [u8],
    /// Bound buffers in the order of the kernel's list.
    pub slots: &'a mut [Slot<'a>],
    /// Flags the body raises.
    pub status: &'a AtomicU32,
    /// The geometry to cast rays against, when the kernel asked for it.
    pub rays: Option<&'a dyn TraceRays>,
}

impl<'a> Launch<'a> {
    /// The items, by their index within the dispatch.
    pub fn items(&self) -> Range<u32> {
        self.first..self.first + self.count
    }

    /// The parameter block as `T`.
    ///
    /// # Panics
    /// When the block's size or alignment is not `T`'s; [`crate::Backend::dispatch`] checks the size before it launches.
    pub fn params<T: Pod>(&self) -> &'a T {
        bytemuck::from_bytes(self.params)
    }

    /// An `In` binding as a slice of `T`.
    ///
    /// # Panics
    /// When the binding is not `In` or its bytes are no whole number of `T`.
    pub fn input<T: Pod>(&self, slot: usize) -> &'a [T] {
        match &self.slots[slot] {
            Slot::In(bytes) => bytemuck::cast_slice(bytes),
            _ => panic!("binding {slot} is not an input"),
        }
    }

    /// Takes an `OutPerItem` binding: element `k` belongs to item `first + k`.
    ///
    /// # Panics
    /// When the binding is not `OutPerItem`.
    pub fn output<T: Pod>(&mut self, slot: usize) -> &'a mut [T] {
        match &mut self.slots[slot] {
            Slot::Out(bytes) => bytemuck::cast_slice_mut(mem::take(bytes)),
            _ => panic!("binding {slot} is not an output"),
        }
    }

    /// An `AtomicU32` binding.
    ///
    /// # Panics
    /// When the binding is not `AtomicU32`.
    pub fn atomic_u32(&self, slot: usize) -> &'a [AtomicU32] {
        match &self.slots[slot] {
            Slot::AtomicU32(words) => words,
            _ => panic!("binding {slot} is not made of 32-bit atomics"),
        }
    }

    /// An `AtomicU64` binding, where the target has such atomics.
    ///
    /// # Panics
    /// When the binding is not `AtomicU64`.
    #[cfg(target_has_atomic = "64")]
    pub fn atomic_u64(&self, slot: usize) -> &'a [AtomicU64] {
        match &self.slots[slot] {
            Slot::AtomicU64(words) => words,
            _ => panic!("binding {slot} is not made of 64-bit atomics"),
        }
    }

    /// The geometry to cast rays against.
    ///
    /// # Panics
    /// When the kernel did not declare `casts_rays`.
    pub fn rays(&self) -> &'a dyn TraceRays {
        self.rays.expect("the kernel declares casts_rays")
    }

    /// Raises flags in the dispatch's status word; [`Status::NOT_RUN`] is the backend's and is left out.
    pub fn raise(&self, flags: Status) {
        self.status.fetch_or(flags.bits() & !Status::NOT_RUN.bits(), Ordering::Relaxed);
    }
}
