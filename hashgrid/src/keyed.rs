//! Claim, deposit and lookup by keys of the caller's making: for glossy layers ([`crate::lobe`]), and for whatever else
//! should tell vertices apart.
//!
//! A key's cell and attributes may hold anything that the hashes should see; [`crate::key::NO_KEY`] alone is taken. These
//! functions do what those of [`crate::vertex`] do, one vertex at a time.

use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::key::Key;
use crate::layout::{Keep, Layout};
use crate::names::Naming;
use crate::params::Params;
use crate::table::{Claim, Table};
use crate::vertex::{answer_vertices, deposit_under, find_named};

/// Claims a cell for the key of every recordable vertex. True when some key was refused. Any number of threads may claim
/// parts of the same vertices.
pub fn claim_keyed<L: Layout>(
    table: &Table<'_, L>,
    vertices: &[VertexRecord],
    key_of: impl Fn(&VertexRecord) -> Option<Key>,
) -> bool {
    let keys = vertices.iter().filter(|vertex| vertex.is_recordable()).filter_map(key_of);
    keys.fold(false, |refused, key| refused | (table.claim(&key) == Claim::Refused))
}

/// Names what was claimed; does nothing in layouts without keys. See [`crate::names`].
pub fn name_keyed<L: Layout>(
    table: &Table<'_, L>,
    vertices: &[VertexRecord],
    key_of: impl Fn(&VertexRecord) -> Option<Key>,
    step: Naming,
) {
    if L::Kept::WORDS == 0 {
        return;
    }
    for key in vertices.iter().filter(|vertex| vertex.is_recordable()).filter_map(key_of) {
        table.name(&key, step);
    }
}

/// Deposits every recordable vertex under its key. What finds no cell, and what is cut off, is counted. Any number of threads
/// may deposit parts of the same vertices.
pub fn deposit_keyed<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    key_of: impl Fn(&VertexRecord) -> Option<Key>,
    counters: &mut Counters,
) {
    for vertex in vertices.iter().filter(|vertex| vertex.is_recordable()) {
        deposit_under(table, params, key_of(vertex).as_ref(), vertex, counters);
    }
}

/// Illumination at every vertex, in order: `answer(i, estimate)`. `key_of(vertex, salt)` is asked with the lookup's salt,
/// and with the deposit's where that key has no light; failing both, the vertex answers for itself, with 0 samples.
pub fn estimate_keyed<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    key_of: impl Fn(&VertexRecord, u32) -> Option<Key>,
    counters: &mut Counters,
    answer: impl FnMut(usize, Estimate),
) {
    let sums_for = |vertex: &VertexRecord, salt, counters: &mut Counters| {
        let found = find_named(table, &key_of(vertex, salt)?);
        counters.probes += u64::from(found.probes);
        Some(table.sums(found.slot?))
    };
    answer_vertices(params, vertices, counters, sums_for, answer);
}
