//! The alternative that lost: samples are added to sums of the cells they touch by exact atomics, in the order in which
//! they come, and each level hands its sums on to the next. A mark a cell tells where its sums stand.

use std::ops::Range;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use backend_api::{Access, Backend, Binding, BindingDecl, BufferDesc, Items, Kernel, Launch};
use backend_cpu::CpuBackend;
use hashcache_core::exact::{Quantum, carry, hi, lo, mean, pair, quantize};
use hashcache_core::glam::Vec3;
use hashcache_core::octree::{CellRecord, ExactCell, NO_CELL, Octree, OwnedOctree, ReadCells, SharedCells, Sum};
use hashcache_core::pack::octahedral_decode_int;
use hashcache_core::record::VertexRecord;

/// Words before the cells' marks: entries of each level's list.
const HEAD_WORDS: usize = 64;

/// Words of an entry's sums: a cache line.
const SUM_WORDS: usize = 16;

/// Words of an entry's place: 21 bits for each coordinate of the finest level.
const PLACE_WORDS: usize = 2;

const ENTRY_WORDS: usize = SUM_WORDS + PLACE_WORDS;

/// In an entry: counts of front and back, and 1 + index of the cell.
const COUNT: usize = 12;
const OWNER: usize = 14;

const BATCH: usize = 16;

/// What an entry holds.
#[derive(Clone, Copy)]
struct Entry {
    cell: u32,
    place: [u32; 3],
    sums: [[u64; 3]; 2],
    counts: [u32; 2],
}

/// Marks (a word a cell: 0, or 1 + the number of its entry) and two lists of entries: of a level, and of the next.
#[derive(Clone, Copy)]
struct Pending<'a> {
    marks: &'a [AtomicU32],
    lists: &'a [AtomicU32],
    capacity: usize,
}

impl<'a> Pending<'a> {
    fn new(marks: &'a [AtomicU32], lists: &'a [AtomicU32]) -> Self {
        Self { marks, lists, capacity: lists.len() / (2 * ENTRY_WORDS) }
    }

    fn mark(&self, cell: u32) -> &'a AtomicU32 {
        &self.marks[HEAD_WORDS + cell as usize]
    }

    /// The cell's entry, or the next reserved one.
    fn claim(&self, level: u32, cell: u32, place: [u32; 3], next: &mut u32) -> u32 {
        let found = self.mark(cell).load(Relaxed);
        if found != 0 {
            return found - 1;
        }
        let own = *next;
        if let Err(found) = self.mark(cell).compare_exchange(0, own + 1, Relaxed, Relaxed) {
            return found - 1;
        }
        *next += 1;
        self.line(level, own)[OWNER].store(cell + 1, Relaxed);
        let [x, y, z] = place.map(u64::from);
        let packed = x | (y << 21) | (z << 42);
        let words = self.place(level, own);
        words[0].store(lo(packed), Relaxed);
        words[1].store(hi(packed), Relaxed);
        own
    }

    fn add(&self, level: u32, entry: u32, side: usize, sums: [u64; 3], count: u32) {
        let line = self.line(level, entry);
        for (to, sum) in line[6 * side..6 * side + 6].chunks_exact(2).zip(sums) {
            if sum != 0 {
                let high = carry(to[0].fetch_add(lo(sum), Relaxed), sum);
                if high != 0 {
                    to[1].fetch_add(high, Relaxed);
                }
            }
        }
        line[COUNT + side].fetch_add(count, Relaxed);
    }

    fn take(&self, level: u32, entry: u32) -> Option<Entry> {
        let line = self.line(level, entry);
        let cell = line[OWNER].load(Relaxed).checked_sub(1)?;
        let sum = |k: usize| pair(line[k].load(Relaxed), line[k + 1].load(Relaxed));
        let sums = [[sum(0), sum(2), sum(4)], [sum(6), sum(8), sum(10)]];
        let counts = [line[COUNT].load(Relaxed), line[COUNT + 1].load(Relaxed)];
        let words = self.place(level, entry);
        let packed = pair(words[0].load(Relaxed), words[1].load(Relaxed));
        let place = [packed, packed >> 21, packed >> 42].map(|v| v as u32 & 0x001f_ffff);
        for word in line {
            word.store(0, Relaxed);
        }
        Some(Entry { cell, place, sums, counts })
    }

    fn line(&self, level: u32, entry: u32) -> &'a [AtomicU32] {
        let first = ((level & 1) as usize * self.capacity + entry as usize) * SUM_WORDS;
        &self.lists[first..first + SUM_WORDS]
    }

    fn place(&self, level: u32, entry: u32) -> &'a [AtomicU32] {
        let lines = 2 * self.capacity * SUM_WORDS;
        let first = lines + ((level & 1) as usize * self.capacity + entry as usize) * PLACE_WORDS;
        &self.lists[first..first + PLACE_WORDS]
    }
}

const fn decl(name: &'static str, access: Access, stride: u32) -> BindingDecl {
    BindingDecl { name, access, stride }
}

const CELL: u32 = size_of::<ExactCell>() as u32;

static DEPOSIT: Kernel = Kernel {
    name: "atomic.deposit",
    bindings: &[
        decl("structure", Access::In, 4),
        decl("cells", Access::In, CELL),
        decl("records", Access::In, 96),
        decl("marks", Access::AtomicU32, 4),
        decl("lists", Access::AtomicU32, 4),
    ],
    params_size: 0,
    body: deposit,
    wgsl: None,
    casts_rays: false,
};

static MERGE: Kernel = Kernel {
    name: "atomic.merge",
    bindings: &[
        decl("structure", Access::In, 4),
        decl("cells", Access::AtomicU32, CELL),
        decl("marks", Access::AtomicU32, 4),
        decl("lists", Access::AtomicU32, 4),
    ],
    params_size: 16,
    body: merge,
    wgsl: None,
    casts_rays: false,
};

fn side(a: u32, b: u32) -> usize {
    let ([a, b, c], [x, y, z]) = (octahedral_decode_int(a), octahedral_decode_int(b));
    usize::from(a * x + b * y + c * z < 0)
}

fn quantum() -> Quantum {
    Quantum::for_scale(1.0)
}

fn deposit(launch: &mut Launch<'_>) {
    let octree = Octree::new(launch.input(0)).expect("an octree");
    let cells = launch.input::<ExactCell>(1);
    let pending = Pending::new(launch.atomic_u32(3), launch.atomic_u32(4));
    let first = launch.first as usize;
    for batch in launch.input::<VertexRecord>(2)[first..first + launch.count as usize].chunks(BATCH) {
        let mut places = [[u32::MAX; 3]; BATCH];
        for (place, record) in places.iter_mut().zip(batch).filter(|(_, record)| record.is_recordable()) {
            let position = Vec3::from_slice(&record.position_footprint[..3]);
            *place = octree.coordinates(position).unwrap_or([u32::MAX; 3]);
        }
        let mut indices = [NO_CELL; BATCH];
        octree.find_cells(0, &places, &mut indices);
        let mut sides = [0; BATCH];
        let mut wanted = 0;
        for ((side_at, cell), record) in
            sides.iter_mut().zip(indices).zip(batch).filter(|((_, cell), _)| *cell != NO_CELL)
        {
            *side_at = side(cells.normal(cell), record.normal);
            wanted += u32::from(pending.mark(cell).load(Relaxed) == 0);
        }
        let mut next = if wanted == 0 { 0 } else { pending.marks[0].fetch_add(wanted, Relaxed) };
        for (((record, cell), at), place) in batch.iter().zip(indices).zip(sides).zip(places) {
            if cell == NO_CELL {
                continue;
            }
            let sum =
                |c: usize| quantize(quantum(), record.direct[c]).value + quantize(quantum(), record.further[c]).value;
            let entry = pending.claim(0, cell, place, &mut next);
            pending.add(0, entry, at, [sum(0), sum(1), sum(2)], 1);
        }
    }
}

fn merge(launch: &mut Launch<'_>) {
    let octree = Octree::new(launch.input(0)).expect("an octree");
    let cells = SharedCells::<ExactCell>::new(launch.atomic_u32(1));
    let pending = Pending::new(launch.atomic_u32(2), launch.atomic_u32(3));
    let [level, ..] = *launch.params::<[u32; 4]>();
    if launch.first == 0 && level > 0 {
        pending.marks[level as usize - 1].store(0, Relaxed);
    }
    let end = (launch.first + launch.count).min(pending.marks[level as usize].load(Relaxed));
    let mut first = launch.first;
    while first < end {
        let last = end.min(first + BATCH as u32);
        merge_batch(&octree, &cells, &pending, level, first..last);
        first = last;
    }
}

fn merge_batch(
    octree: &Octree<'_>,
    cells: &SharedCells<'_, ExactCell>,
    pending: &Pending<'_>,
    level: u32,
    entries: Range<u32>,
) {
    let above = level + 1;
    let mut taken = [None; BATCH];
    let mut places = [[u32::MAX; 3]; BATCH];
    for ((to, place), entry) in taken.iter_mut().zip(&mut places).zip(entries) {
        *to = pending.take(level, entry);
        *place = to.map_or(*place, |entry: Entry| entry.place.map(|c| c >> above));
    }
    let mut parents = [NO_CELL; BATCH];
    if above < octree.grid().levels {
        octree.find_cells(above, &places, &mut parents);
    }
    let mut wanted = 0;
    let mut normals = [0; BATCH];
    for (normal, parent) in normals.iter_mut().zip(parents).filter(|(_, parent)| *parent != NO_CELL) {
        *normal = cells.normal(parent);
        wanted += u32::from(pending.mark(parent).load(Relaxed) == 0);
    }
    let mut next = if wanted == 0 { 0 } else { pending.marks[above as usize].fetch_add(wanted, Relaxed) };
    for ((entry, parent), normal) in taken.iter().zip(parents).zip(normals) {
        let Some(entry) = entry else { continue };
        pending.mark(entry.cell).store(0, Relaxed);
        let mut cell = cells.get(entry.cell);
        for at in [0, 1].into_iter().filter(|at| entry.counts[*at] > 0) {
            merge_side(&mut cell, at, entry.sums[at], entry.counts[at]);
        }
        cells.set(entry.cell, &cell);
        if parent == NO_CELL {
            continue;
        }
        let to = pending.claim(above, parent, entry.place, &mut next);
        let front = side(normal, cell.normal);
        for (at, to_side) in [(0, front), (1, 1 - front)].into_iter().filter(|(at, _)| entry.counts[*at] > 0) {
            pending.add(above, to, to_side, entry.sums[at], entry.counts[at]);
        }
    }
}

fn merge_side(cell: &mut ExactCell, at: usize, sums: [u64; 3], count: u32) {
    let old = cell.side(at, quantum());
    let all = old.count + count;
    let weight = count as f32 / all as f32;
    let moved = [0, 1, 2].map(|c| Sum::new(old.mean[c], (mean(quantum(), sums[c], count) - old.mean[c]) * weight));
    cell.put(at, quantum(), moved, all, [all, all << 8, all << 16]);
}

/// Buffers for frames of up to `capacity` records.
pub struct Atomic {
    levels: u32,
    structure: Binding,
    cells: Binding,
    marks: Binding,
    lists: Binding,
    count: u32,
}

impl Atomic {
    pub fn new(backend: &mut CpuBackend, octree: &OwnedOctree, capacity: u32) -> Self {
        let mut bind = |name, size| {
            let buffer = backend.create(&BufferDesc { name, size }).expect("create");
            Binding { buffer, offset: 0, size }
        };
        let cells = octree.normals.len() as u64;
        let all = Self {
            levels: octree.view().grid().levels,
            structure: bind("structure", 4 * octree.words.len() as u64),
            cells: bind("cells", u64::from(CELL) * cells),
            marks: bind("marks", 4 * (HEAD_WORDS as u64 + cells)),
            lists: bind("lists", 8 * ENTRY_WORDS as u64 * u64::from(capacity)),
            count: 0,
        };
        let empty: Vec<_> = octree.normals.iter().map(|normal| ExactCell::empty(*normal, 0)).collect();
        backend.write(all.structure.buffer, 0, bytemuck::cast_slice(&octree.words)).expect("write");
        backend.write(all.cells.buffer, 0, bytemuck::cast_slice(&empty)).expect("write");
        all
    }

    pub fn record(&mut self, backend: &mut CpuBackend, records: Binding, count: u32) {
        let bindings = [self.structure, self.cells, records, self.marks, self.lists];
        backend.dispatch(&DEPOSIT, &[], &bindings, Items::Count(count)).expect("dispatch");
        backend.submit().expect("submit");
        self.count = count;
    }

    pub fn update(&mut self, backend: &mut CpuBackend) {
        let bindings = [self.structure, self.cells, self.marks, self.lists];
        for level in 0..=self.levels {
            let params = bytemuck::cast::<_, [u8; 16]>([level, 0, 0, 0]);
            backend.dispatch(&MERGE, &params, &bindings, Items::Count(self.count)).expect("dispatch");
        }
        backend.submit().expect("submit");
        backend.statuses().expect("statuses");
    }
}
