//! Cutting a dispatch into launches and running them.

use std::mem;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use backend_api::{Access, Binding, BufferTable, Items, Kernel, Launch, Slot, Status, TraceRays};
use rayon::prelude::*;

use crate::storage::{Block, Storage, atomics};

/// Fewest items of a launch: what a launch costs (well under a microsecond) stays small beside them.
const MIN_ITEMS: u32 = 256;

/// Most items of a launch: the last launch to end keeps the others waiting for at most its share.
const MAX_ITEMS: u32 = 16_384;

/// Launches a thread, so that threads with light items can take over from those with heavy ones.
const LAUNCHES_PER_THREAD: u32 = 8;

/// A checked dispatch that waits for its turn.
pub(crate) struct Dispatch {
    pub(crate) kernel: &'static Kernel,
    /// The parameter block's place among those recorded.
    pub(crate) params: Range<usize>,
    /// As many as the kernel declares.
    pub(crate) bindings: [Option<Binding>; Kernel::MAX_BINDINGS],
    pub(crate) items: Items,
}

/// How launches run.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    /// Threads that share the work; 1: in order on this one.
    pub(crate) threads: u32,
    /// Items a launch, or 0 to choose.
    pub(crate) items: u32,
}

impl Cut {
    /// Items of one launch out of `items`.
    fn launch_items(self, items: u32) -> u32 {
        if self.items > 0 {
            return self.items;
        }
        (items / self.threads.saturating_mul(LAUNCHES_PER_THREAD)).clamp(MIN_ITEMS, MAX_ITEMS)
    }
}

/// One launch before it runs.
struct Job<'a> {
    first: u32,
    count: u32,
    slots: Slots<'a>,
}

type Slots<'a> = [Slot<'a>; Kernel::MAX_BINDINGS];

/// Runs one dispatch; `status` starts as [`Status::NOT_RUN`].
pub(crate) fn run(
    dispatch: &Dispatch,
    params: &[Block],
    table: &mut BufferTable<Storage>,
    rays: Option<&dyn TraceRays>,
    cut: Cut,
    status: &AtomicU32,
) {
    let kernel = dispatch.kernel;
    let items = count(dispatch.items, table);
    if items == 0 {
        status.fetch_and(!Status::NOT_RUN.bits(), Ordering::Relaxed);
        return;
    }
    let params = &bytemuck::cast_slice(&params[dispatch.params.clone()])[..kernel.params_size as usize];
    let rays = rays.filter(|_| kernel.casts_rays);
    let launch = |Job { first, count, mut slots }: Job<'_>| {
        let slots = &mut slots[..kernel.bindings.len()];
        (kernel.body)(&mut Launch { first, count, params, slots, status, rays });
        status.fetch_and(!Status::NOT_RUN.bits(), Ordering::Relaxed);
    };
    let jobs = jobs(kernel, slots(dispatch, table, items), items, cut.launch_items(items));
    if cut.threads == 1 {
        jobs.for_each(launch);
    } else {
        jobs.collect::<Vec<_>>().into_par_iter().with_max_len(1).for_each(launch);
    }
}

/// The number of items, now.
fn count(items: Items, table: &BufferTable<Storage>) -> u32 {
    match items {
        Items::Count(count) => count,
        Items::FromBuffer { buffer, index, max } => {
            let words = table.get(buffer).map(Storage::words);
            words.and_then(|words| words.get(index as usize)).map_or(0, |&word| word.min(max))
        }
    }
}

/// What the bindings look like to all items together.
fn slots<'a>(dispatch: &Dispatch, table: &'a mut BufferTable<Storage>, items: u32) -> Slots<'a> {
    let bound = || dispatch.bindings.iter().flatten().zip(dispatch.kernel.bindings).enumerate();
    let mut slots = [const { Slot::In(&[]) }; Kernel::MAX_BINDINGS];
    for (id, storage) in table.iter_mut() {
        let written = bound().find(|(_, (binding, decl))| binding.buffer == id && decl.access.writes());
        // A buffer that is written is bound once, and one that is read is bound as often as anyone likes.
        if let Some((k, (binding, decl))) = written {
            let bytes = &mut storage.bytes_mut()[range(binding)];
            slots[k] = match decl.access {
                Access::In => Slot::In(bytes),
                Access::OutPerItem => Slot::Out(&mut bytes[..items as usize * decl.stride as usize]),
                Access::AtomicU32 => Slot::AtomicU32(atomics(bytes)),
                Access::AtomicU64 => Slot::AtomicU64(atomics(bytes)),
            };
        } else {
            let bytes = storage.bytes();
            for (k, (binding, _)) in bound().filter(|(_, (binding, _))| binding.buffer == id) {
                slots[k] = Slot::In(&bytes[range(binding)]);
            }
        }
    }
    slots
}

fn range(binding: &Binding) -> Range<usize> {
    binding.offset as usize..(binding.offset + binding.size) as usize
}

/// Cuts all items into launches of `step`, in order.
fn jobs<'a>(kernel: &Kernel, mut rest: Slots<'a>, items: u32, step: u32) -> impl Iterator<Item = Job<'a>> {
    (0..items.div_ceil(step)).map(move |launch| {
        let first = launch * step;
        let count = step.min(items - first);
        let mut slots = [const { Slot::In(&[]) }; Kernel::MAX_BINDINGS];
        for ((slot, rest), decl) in slots.iter_mut().zip(&mut rest).zip(kernel.bindings) {
            *slot = match rest {
                Slot::In(bytes) => Slot::In(bytes),
                Slot::Out(bytes) => {
                    let (own, others) = mem::take(bytes).split_at_mut(count as usize * decl.stride as usize);
                    *bytes = others;
                    Slot::Out(own)
                }
                Slot::AtomicU32(words) => Slot::AtomicU32(words),
                Slot::AtomicU64(words) => Slot::AtomicU64(words),
            };
        }
        Job { first, count, slots }
    })
}
