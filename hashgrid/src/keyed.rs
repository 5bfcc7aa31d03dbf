//! Claim, deposit and lookup by keys of the caller's making: for glossy layers ([`crate::lobe`]), and for whatever else
//! should tell vertices apart.
//!
//! A key's cell and attributes may hold anything that the hashes should see; [`crate::key::NO_KEY`] alone is taken. These
//! functions do what those of [`crate::vertex`] do, one vertex at a time.

use hashcache_core::counters::Counters;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use crate::key::Key;
use crate::layout::Layout;
use crate::names::Naming;
use crate::params::Params;
use crate::table::{Claim, Table};
use crate::vertex::{deposit_key, find_named, own_value};

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

/// Names what was claimed, in layouts that keep keys; see [`crate::names`].
pub fn name_keyed<L: Layout>(
    table: &Table<'_, L>,
    vertices: &[VertexRecord],
    key_of: impl Fn(&VertexRecord) -> Option<Key>,
    step: Naming,
) {
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
        deposit_key(table, params, key_of(vertex).as_ref(), vertex, counters);
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
    mut answer: impl FnMut(usize, Estimate),
) {
    for (i, vertex) in vertices.iter().enumerate() {
        if !vertex.is_valid() {
            answer(i, own_value(vertex, counters));
            continue;
        }
        counters.lookups += 1;
        let found = [SALT_LOOKUP, SALT_DEPOSIT].into_iter().find_map(|salt| {
            let found = find_named(table, &key_of(vertex, salt)?);
            counters.probes += u64::from(found.probes);
            Some(table.sums(found.slot?)).filter(|sums| sums.count > 0)
        });
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
