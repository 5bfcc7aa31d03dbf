//! Claim, deposit and lookup of path vertices: what kernels and host programs run over their records.

use hashcache_core::counters::Counters;
use hashcache_core::exact::{Outcome, Quantized, quantize};
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use crate::key::{fingerprint, key};
use crate::params::Params;
use crate::table::{Claim, Found, Quanta, Table};
use crate::word::{self, Word};

/// Vertices whose slots are asked for at once: their cache misses overlap. More than the misses that a core keeps in
/// flight (10 to 16) gains nothing.
pub(crate) const BATCH: usize = 16;

/// Where a vertex's probe sequence begins: home slot and fingerprint.
#[derive(Clone, Copy)]
struct Start {
    slot: u32,
    fingerprint: u32,
}

#[inline]
fn start(table: &Table<'_>, params: &Params, vertex: &VertexRecord, salt: u32) -> Option<Start> {
    if vertex.flags & VertexRecord::VALID == 0 {
        return None;
    }
    let key = key(params, vertex, salt)?;
    Some(Start { slot: table.home_slot(&key), fingerprint: fingerprint(&key) })
}

/// The starts of up to [`BATCH`] vertices, each with the first word of its home.
///
/// The words are read in a loop of their own: only so close together do their misses overlap (keys take more
/// instructions than a core looks ahead).
#[inline]
fn starts(table: &Table<'_>, params: &Params, vertices: &[VertexRecord], salt: u32) -> [Option<(Start, u64)>; BATCH] {
    let mut starts = [None; BATCH];
    for (to, vertex) in starts.iter_mut().zip(vertices) {
        *to = start(table, params, vertex, salt).map(|start| (start, 0));
    }
    for (start, head) in starts.iter_mut().flatten() {
        *head = table.head(start.slot);
    }
    starts
}

/// Claims a cell for every vertex that has a key. True when some key was refused.
///
/// Any number of threads may claim parts of the same vertices.
pub fn claim_vertices(table: &Table<'_>, params: &Params, vertices: &[VertexRecord]) -> bool {
    let mut refused = false;
    for batch in vertices.chunks(BATCH) {
        for (start, head) in starts(table, params, batch, SALT_DEPOSIT).into_iter().flatten() {
            refused |= table.claim_from(start.slot, start.fingerprint, head) == Claim::Refused;
        }
    }
    refused
}

/// Deposits every vertex into the cell that was claimed for it. What finds no cell, and what is cut off, is counted.
///
/// Any number of threads may deposit parts of the same vertices, each with its own counters.
pub fn deposit_vertices(table: &Table<'_>, params: &Params, vertices: &[VertexRecord], counters: &mut Counters) {
    for batch in vertices.chunks(BATCH) {
        let starts = starts(table, params, batch, SALT_DEPOSIT);
        for (start, vertex) in starts.into_iter().zip(batch) {
            if vertex.flags & VertexRecord::VALID == 0 {
                continue;
            }
            counters.deposits += 1;
            let values = quantize_vertex(params, vertex);
            let found = start.map(|(start, head)| table.find_from(start.slot, start.fingerprint, head));
            let stored = deposit_found(table, found, &values, counters);
            note_all(&values, stored, counters);
        }
    }
}

/// [`Counters::note`] for all channels of a vertex.
#[inline]
fn note_all(values: &[Quantized; 6], stored: bool, counters: &mut Counters) {
    if values.iter().all(|value| value.outcome == Outcome::Exact) {
        // Nearly always, and then there is one number to add: six of 2³³ at most.
        let energy = values.iter().map(|value| value.value).sum();
        let whole = Quantized { value: energy, lost: 0, outcome: Outcome::Exact };
        counters.note(&whole, stored);
        return;
    }
    for value in values {
        counters.note(value, stored);
    }
}

#[inline]
fn deposit_found(table: &Table<'_>, found: Option<Found>, values: &[Quantized; 6], counters: &mut Counters) -> bool {
    counters.probes += found.map_or(0, |found| u64::from(found.probes));
    let Some((found, slot)) = found.and_then(|found| Some((found, found.slot?))) else {
        counters.refusals += 1;
        return false;
    };
    if found.is_full() {
        counters.refusals += 1;
        counters.overflowed += 1;
        return false;
    }
    let quanta: Quanta = values.map(|v| v.value);
    table.add(slot, found.head, &quanta, 1);
    true
}

/// The six channels of a vertex's illumination in quanta: direct red, green, blue, further red, green, blue.
#[inline]
#[must_use]
pub fn quantize_vertex(params: &Params, vertex: &VertexRecord) -> [Quantized; 6] {
    let q = params.quantum();
    let ([a, b, c, _], [d, e, f, _]) = (vertex.direct, vertex.further);
    // Spelled out: `map` over six of these is not inlined.
    [quantize(q, a), quantize(q, b), quantize(q, c), quantize(q, d), quantize(q, e), quantize(q, f)]
}

/// Illumination at every vertex, in order: `answer(i, estimate)`.
///
/// Each is the mean of the cell that the vertex falls into with the lookup's own jitter; where that cell has no
/// deposits, of the cell of the vertex's deposit; failing that, the vertex's own value (with 0 samples), NaN and
/// infinite channels replaced by 0. A vertex without [`VertexRecord::VALID`] gets its own value, uncounted.
pub fn estimate_vertices(
    table: &Table<'_>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut answer: impl FnMut(usize, Estimate),
) {
    for (b, batch) in vertices.chunks(BATCH).enumerate() {
        let starts = starts(table, params, batch, SALT_LOOKUP);
        for (i, (start, vertex)) in starts.into_iter().zip(batch).enumerate() {
            let found = start.map(|(start, head)| table.find_from(start.slot, start.fingerprint, head));
            answer(b * BATCH + i, estimate_found(table, params, vertex, found, counters));
        }
    }
}

#[inline]
fn estimate_found(
    table: &Table<'_>,
    params: &Params,
    vertex: &VertexRecord,
    found: Option<Found>,
    counters: &mut Counters,
) -> Estimate {
    if vertex.flags & VertexRecord::VALID == 0 {
        return own_value(vertex, counters);
    }
    counters.lookups += 1;
    if let Some(estimate) = estimate_cell(table, params, found, counters) {
        return estimate;
    }
    let start = start(table, params, vertex, SALT_DEPOSIT);
    let found = start.map(|start| table.find_at(start.slot, start.fingerprint));
    if let Some(estimate) = estimate_cell(table, params, found, counters) {
        return estimate;
    }
    counters.fallbacks += 1;
    own_value(vertex, counters)
}

#[inline]
fn estimate_cell(
    table: &Table<'_>,
    params: &Params,
    found: Option<Found>,
    counters: &mut Counters,
) -> Option<Estimate> {
    let found = found?;
    counters.probes += u64::from(found.probes);
    let cell = table.cell(found.slot?);
    if cell.count == 0 {
        return None;
    }
    counters.hits += 1;
    Some(Estimate {
        direct: Vec3::from_array(cell.mean_direct(params.quantum())),
        further: Vec3::from_array(cell.mean_further(params.quantum())),
        samples: cell.count,
    })
}

fn own_value(vertex: &VertexRecord, counters: &mut Counters) -> Estimate {
    let mut finite = |v: [f32; 4]| {
        Vec3::from_array([v[0], v[1], v[2]].map(|c| {
            counters.non_finite += u64::from(!c.is_finite());
            if c.is_finite() { c } else { 0.0 }
        }))
    };
    Estimate { direct: finite(vertex.direct), further: finite(vertex.further), samples: 0 }
}

/// Adds counters to shared ones, a word each as in [`Counters::words`].
pub fn add_counters(shared: &[Word], counters: &Counters) {
    for (to, from) in shared.iter().zip(counters.words()) {
        if *from != 0 {
            word::add(to, *from);
        }
    }
}

/// Shared counters as they stand.
pub fn read_counters(shared: &[Word]) -> Counters {
    let mut words = [0; Counters::WORDS];
    for (to, from) in words.iter_mut().zip(shared) {
        *to = word::get(from);
    }
    Counters::from_words(&words)
}
