//! Deposits of path vertices into the sums of an open frame.

use super::cell::{BACK, CellRecord, FRONT};
use super::cells::ReadCells;
use super::params::{Light, OctreeParams};
use super::pending::{Owner, Pending};
use super::view::Octree;
use crate::counters::Counters;
use crate::exact::{Outcome, Quantized, quantize};
use crate::pack::octahedral_decode_int;
use crate::record::VertexRecord;

/// Vertices and entries that are worked on together, so that their cache misses overlap.
pub(crate) const BATCH: usize = 16;

/// Which side of a surface with normal `normal` (octahedral) a direction `n` points to.
#[inline]
pub(crate) fn side_of(normal: u32, n: u32) -> usize {
    let ([a, b, c], [x, y, z]) = (octahedral_decode_int(normal), octahedral_decode_int(n));
    // At most 32767² in magnitude, whatever the order of additions.
    if a * x + b * y + c * z >= 0 { FRONT } else { BACK }
}

/// Where a vertex's light goes.
#[derive(Clone, Copy)]
struct Home {
    owner: Owner,
    place: [u32; 3],
}

/// The finest cell that holds the vertex; where the finest level has none, no cell yet. `None` where no level has one.
#[inline]
fn home(octree: &Octree<'_>, vertex: &VertexRecord) -> Option<Home> {
    let [x, y, z, _] = vertex.position_footprint;
    let place = octree.coordinates(glam::Vec3::new(x, y, z))?;
    if let Some(cell) = octree.cell(0, place) {
        return Some(Home { owner: Owner::Cell(cell), place });
    }
    // Rounding may move a vertex off its surface. Coarser cells are larger: one of them will do.
    let stored = (1..octree.grid().levels).any(|level| octree.cell(level, place.map(|c| c >> level)).is_some());
    stored.then_some(Home { owner: Owner::Record(vertex.normal), place })
}

/// Adds the light of every vertex that a cache may record to the sums of the finest cell that holds it.
///
/// A vertex whose finest cell is missing adds to the next coarser one that exists (counted in [`Counters::coarser`]); one
/// outside the octree, or without room, is refused and counted. Any number of threads may deposit parts of the same
/// vertices, each with its own counters. True when there was no room for some vertex.
pub fn deposit_vertices<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &(impl ReadCells<C> + ?Sized),
    pending: &Pending<'_>,
    params: &OctreeParams,
    vertices: &[VertexRecord],
    counters: &mut Counters,
) -> bool {
    let mut full = false;
    for batch in vertices.chunks(BATCH) {
        // Each step is a loop of its own: only so close together do its misses overlap.
        let mut homes = [None; BATCH];
        for (to, vertex) in homes.iter_mut().zip(batch) {
            *to = if vertex.is_recordable() { home(octree, vertex) } else { None };
        }
        let mut wanted = 0;
        let mut normals = [0; BATCH];
        for (normal, home) in normals.iter_mut().zip(&homes) {
            match home {
                Some(Home { owner: Owner::Cell(cell), .. }) => {
                    *normal = cells.normal(*cell);
                    wanted += u32::from(pending.mark(*cell) == 0);
                }
                Some(Home { owner: Owner::Record(own), .. }) => {
                    *normal = *own;
                    wanted += 1;
                }
                None => {}
            }
        }
        let mut reserved = pending.reserve(0, wanted);
        for ((vertex, home), normal) in batch.iter().zip(homes).zip(normals) {
            if !vertex.is_recordable() {
                continue;
            }
            counters.deposits += 1;
            let values = quantize_vertex(params, vertex);
            let entry = home.and_then(|Home { owner, place }| pending.claim(0, owner, place, &mut reserved));
            full |= home.is_some() && entry.is_none();
            if let Some(entry) = entry {
                let sums = [0, 1, 2].map(|c| values[c].value + values[3 + c].value);
                pending.add(0, entry, side_of(normal, vertex.normal), sums, 1);
                counters.coarser += u64::from(matches!(home, Some(Home { owner: Owner::Record(_), .. })));
            } else {
                counters.refusals += 1;
            }
            note_all(&values, entry.is_some(), counters);
        }
    }
    full
}

/// The light of a vertex that a cache holds, in quanta: direct red, green, blue (0 where only further light is
/// recorded), further red, green, blue.
#[inline]
fn quantize_vertex(params: &OctreeParams, vertex: &VertexRecord) -> [Quantized; 6] {
    let q = params.quantum();
    let ([a, b, c, _], [d, e, f, _]) = (vertex.direct, vertex.further);
    let [a, b, c] = match params.light() {
        Light::All => [quantize(q, a), quantize(q, b), quantize(q, c)],
        Light::Further => [Quantized { value: 0, lost: 0, outcome: Outcome::Exact }; 3],
    };
    [a, b, c, quantize(q, d), quantize(q, e), quantize(q, f)]
}

/// [`Counters::note`] for all channels of a vertex.
#[inline]
fn note_all(values: &[Quantized; 6], stored: bool, counters: &mut Counters) {
    if values.iter().all(|value| value.outcome == Outcome::Exact) {
        // Nearly always, and then there is one number to add: six of 2³³ at most.
        let energy = values.iter().map(|value| value.value).sum();
        counters.note(&Quantized { value: energy, lost: 0, outcome: Outcome::Exact }, stored);
        return;
    }
    for value in values {
        counters.note(value, stored);
    }
}
