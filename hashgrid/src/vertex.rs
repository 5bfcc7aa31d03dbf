//! Claim, deposit and lookup of path vertices: what kernels and host programs run over their records.

use hashcache_core::counters::Counters;
use hashcache_core::exact::{Outcome, Quantized, quantize};
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::batch::{BATCH, Start, find_batch, start};
use crate::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use crate::key::{Key, key};
use crate::layout::Layout;
use crate::params::Params;
use crate::sums::Sums;
use crate::table::{Claim, Found, Quanta, Table};
use crate::word::{self, Word};

/// Claims a cell for every [recordable](VertexRecord::is_recordable) vertex that has a key. True when some key was refused.
///
/// Any number of threads may claim parts of the same vertices.
pub fn claim_vertices<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) -> bool {
    let mut refused = false;
    for batch in vertices.chunks(BATCH) {
        for (start, vertex) in find_batch(table, params, batch, SALT_DEPOSIT).into_iter().zip(batch) {
            // Who has a cell keeps it: it is found now, or by whoever displaces it.
            let Some((start, _)) = start.filter(|(_, found)| found.slot.is_none() && vertex.is_recordable()) else {
                continue;
            };
            let head = table.head(start.slot);
            refused |= table.claim_from(start.slot, start.fingerprint, head) == Claim::Refused;
        }
    }
    refused
}

/// Deposits every [recordable](VertexRecord::is_recordable) vertex into the cell that was claimed for it. What finds no cell, and what is cut off, is counted.
///
/// Any number of threads may deposit parts of the same vertices, each with its own counters.
pub fn deposit_vertices<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
) {
    for batch in vertices.chunks(BATCH) {
        for (start, vertex) in find_batch(table, params, batch, SALT_DEPOSIT).into_iter().zip(batch) {
            if !vertex.is_recordable() {
                continue;
            }
            counters.deposits += 1;
            let values = quantize_for::<L>(params, vertex);
            let found = start.map(|(start, found)| start.named(table, found));
            let stored = deposit_found(table, found, &values, counters);
            note_all(&values, stored, counters);
        }
    }
}

/// [`Counters::note`] for all channels of a vertex.
#[inline]
pub(crate) fn note_all(values: &[Quantized; 6], stored: bool, counters: &mut Counters) {
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
pub(crate) fn deposit_found<L: Layout>(
    table: &Table<'_, L>,
    found: Option<Found>,
    values: &[Quantized; 6],
    counters: &mut Counters,
) -> bool {
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

/// What [`Table::find`] finds, without a slot where the layout keeps another key there.
#[inline]
pub(crate) fn find_named<L: Layout>(table: &Table<'_, L>, key: &Key) -> Found {
    Start::of(table, key).find(table)
}

/// The key under which a vertex deposits; none for a vertex that is not [recordable](VertexRecord::is_recordable).
#[inline]
pub(crate) fn key_of_deposit(params: &Params, vertex: &VertexRecord) -> Option<Key> {
    if vertex.is_recordable() { key(params, vertex, SALT_DEPOSIT) } else { None }
}

/// Deposits a vertex under a key, or counts it as refused.
pub(crate) fn deposit_under<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    key: Option<&Key>,
    vertex: &VertexRecord,
    counters: &mut Counters,
) {
    counters.deposits += 1;
    let values = quantize_for::<L>(params, vertex);
    let found = key.map(|key| find_named(table, key));
    let stored = deposit_found(table, found, &values, counters);
    note_all(&values, stored, counters);
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

/// The channels as a cell of the layout takes them: [`quantize_vertex`], or direct and further light added (as floats)
/// and in the place of the latter.
#[inline]
#[must_use]
pub fn quantize_for<L: Layout>(params: &Params, vertex: &VertexRecord) -> [Quantized; 6] {
    if L::SPLIT {
        return quantize_vertex(params, vertex);
    }
    let none = Quantized { value: 0, lost: 0, outcome: Outcome::Exact };
    let joined = |k: usize| quantize(params.quantum(), vertex.direct[k] + vertex.further[k]);
    [none, none, none, joined(0), joined(1), joined(2)]
}

/// Illumination at every vertex, in order: `answer(i, estimate)`.
///
/// Each is the mean of the cell that the vertex falls into with the lookup's own jitter; where that cell has no
/// deposits, of the cell of the vertex's deposit; failing that, the vertex's own value (with 0 samples), NaN and
/// infinite channels replaced by 0. A vertex without [`VertexRecord::VALID`] gets its own value, uncounted.
pub fn estimate_vertices<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut answer: impl FnMut(usize, Estimate),
) {
    estimate_slots(table, params, vertices, counters, |i, estimate, _| answer(i, estimate));
}

/// [`estimate_vertices`] that also tells the slot behind the answer, `None` where the vertex answers for itself:
/// `answer(i, estimate, slot)`. [`Table::sums`] tells the mean's standard error, [`Table::touch`] notes the use.
///
/// ```
/// use hashcache_core::{counters::Counters, record::VertexRecord};
/// use hashgrid::layout::{Layout, Measured};
/// use hashgrid::{Params, Settings, Table, Word, vertex};
///
/// let params = Params::new(&Settings::default())?;
/// let storage = [const { Word::new(0) }; 64 * Measured::WORDS];
/// let table = Table::<Measured>::with_layout(&storage, &params)?;
/// table.clear();
/// let dim = VertexRecord { direct: [0.5; 4], flags: VertexRecord::VALID, ..bytemuck::Zeroable::zeroed() };
/// let vertices = [dim, VertexRecord { direct: [1.5; 4], ..dim }];
/// let mut counters = Counters::default();
/// vertex::claim_vertices(&table, &params, &vertices);
/// vertex::deposit_vertices(&table, &params, &vertices, &mut counters);
/// vertex::estimate_slots(&table, &params, &vertices, &mut counters, |_, estimate, slot| {
///     let error = table.sums(slot.unwrap()).standard_error(params.quantum());
///     assert_eq!((estimate.direct.x, error), (1.0, Some(0.5))); // 1 ± 0.5
/// });
/// # Ok::<(), hashcache_core::error::ParamError>(())
/// ```
pub fn estimate_slots<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut answer: impl FnMut(usize, Estimate, Option<u32>),
) {
    for (b, batch) in vertices.chunks(BATCH).enumerate() {
        let starts = find_batch(table, params, batch, SALT_LOOKUP);
        for (i, (start, vertex)) in starts.into_iter().zip(batch).enumerate() {
            let found = start.map(|(start, found)| start.named(table, found));
            let (estimate, slot) = estimate_found(table, params, vertex, found, counters);
            answer(b * BATCH + i, estimate, slot);
        }
    }
}

#[inline]
fn estimate_found<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertex: &VertexRecord,
    found: Option<Found>,
    counters: &mut Counters,
) -> (Estimate, Option<u32>) {
    if vertex.flags & VertexRecord::VALID == 0 {
        return (own_value(vertex, counters), None);
    }
    counters.lookups += 1;
    if let Some(estimate) = estimate_cell(table, params, found, counters) {
        return (estimate, found.and_then(|found| found.slot));
    }
    let start = start(table, params, vertex, SALT_DEPOSIT);
    let found = start.map(|start| start.find(table));
    if let Some(estimate) = estimate_cell(table, params, found, counters) {
        return (estimate, found.and_then(|found| found.slot));
    }
    counters.fallbacks += 1;
    (own_value(vertex, counters), None)
}

#[inline]
fn estimate_cell<L: Layout>(
    table: &Table<'_, L>,
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
        variance: 0.0,
    })
}

/// The frame of every lookup that brings its own search. `sums_for(vertex, salt, counters)` is asked with the lookup's
/// salt, and with the deposit's where that gives no light; failing both, the vertex answers for itself, with 0 samples.
pub(crate) fn answer_vertices(
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    sums_for: impl Fn(&VertexRecord, u32, &mut Counters) -> Option<Sums>,
    mut answer: impl FnMut(usize, Estimate),
) {
    for (i, vertex) in vertices.iter().enumerate() {
        if !vertex.is_valid() {
            answer(i, own_value(vertex, counters));
            continue;
        }
        counters.lookups += 1;
        let found = [SALT_LOOKUP, SALT_DEPOSIT]
            .into_iter()
            .find_map(|salt| sums_for(vertex, salt, counters).filter(|sums| sums.count > 0));
        let Some(sums) = found else {
            counters.fallbacks += 1;
            answer(i, own_value(vertex, counters));
            continue;
        };
        counters.hits += 1;
        let direct = Vec3::from_array(sums.mean_direct(params.quantum()));
        let further = Vec3::from_array(sums.mean_further(params.quantum()));
        answer(i, Estimate { direct, further, samples: sums.count, variance: 0.0 });
    }
}

pub(crate) fn own_value(vertex: &VertexRecord, counters: &mut Counters) -> Estimate {
    let mut finite = |v: [f32; 4]| {
        Vec3::from_array([v[0], v[1], v[2]].map(|c| {
            counters.non_finite += u64::from(!c.is_finite());
            if c.is_finite() { c } else { 0.0 }
        }))
    };
    Estimate { direct: finite(vertex.direct), further: finite(vertex.further), samples: 0, variance: 0.0 }
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
