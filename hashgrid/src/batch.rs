//! Probe sequences of several vertices at once, so that their cache misses overlap.

use hashcache_core::record::VertexRecord;

use crate::key::{Key, fingerprint, key};
use crate::lanes::keys;
use crate::layout::{Keep, Layout};
use crate::params::Params;
use crate::table::{Found, Table};
use crate::tag::{EMPTY, NEW, tag};

/// Vertices whose slots are asked for at once. A core keeps 10 to 16 misses in flight; that there are several times as
/// many vertices shares the wait for the longest probe sequence, a miss a round. The lists take 10 to 12 KB of stack.
pub(crate) const BATCH: usize = 64;

/// Where a vertex's probe sequence begins: home slot and fingerprint, and what the layout keeps of the key.
#[derive(Clone, Copy)]
pub(crate) struct Start<K> {
    pub slot: u32,
    pub fingerprint: u32,
    kept: K,
}

impl<K: Keep> Start<K> {
    #[inline]
    pub fn of<L: Layout<Kept = K>>(table: &Table<'_, L>, key: &Key) -> Self {
        Self { slot: table.home_slot(key), fingerprint: fingerprint(key), kept: K::of(key) }
    }

    /// The cell.
    #[inline]
    pub fn find<L: Layout<Kept = K>>(&self, table: &Table<'_, L>) -> Found {
        self.named(table, table.find_at(self.slot, self.fingerprint))
    }

    /// What was found by the tag, without a slot where the layout keeps another key there.
    #[inline]
    pub fn named<L: Layout<Kept = K>>(&self, table: &Table<'_, L>, mut found: Found) -> Found {
        found.slot = found.slot.filter(|slot| self.kept.stands_in(table.key_words(*slot)));
        found
    }
}

/// Where the probe sequence of a vertex's key begins; none for vertices that are not valid or have no key.
#[inline]
pub(crate) fn start<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertex: &VertexRecord,
    salt: u32,
) -> Option<Start<L::Kept>> {
    if vertex.flags & VertexRecord::VALID == 0 {
        return None;
    }
    Some(Start::of(table, &key(params, vertex, salt)?))
}

/// What [`Table::find`] finds for up to [`BATCH`] vertices: by tags alone.
///
/// In each round one word of every sequence that goes on is read, in a loop of its own: only so close together do the
/// misses overlap (keys take more instructions than a core looks ahead). Nothing branches on what a word holds, since a
/// branch that is guessed wrong throws away the reads behind it: in a half full table every fourth.
#[inline]
pub(crate) fn find_batch<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    salt: u32,
) -> [Option<(Start<L::Kept>, Found)>; BATCH] {
    let mut all = [None; BATCH];
    let (mut slots, mut fingerprints) = ([0; BATCH], [0; BATCH]);
    let (mut heads, mut probes) = ([0; BATCH], [0; BATCH]);
    // The sequences that go on.
    let (mut open, mut count) = ([0; BATCH], 0);
    let keys = keys(params, vertices, salt);
    for (i, (to, key)) in all.iter_mut().zip(&keys).enumerate().take(vertices.len()) {
        let Some(start) = key.as_ref().map(|key| Start::of(table, key)) else { continue };
        (slots[i], fingerprints[i]) = (start.slot, start.fingerprint);
        open[count] = i;
        count += 1;
        *to = Some((start, Found { slot: None, probes: 0, head: 0 }));
    }
    for distance in 0..table.max_probes() {
        for i in &open[..count] {
            heads[*i] = table.head(slots[*i]);
        }
        let mut left = 0;
        for k in 0..count {
            let i = open[k];
            let found = (heads[i] >> 32) as u32;
            let goes_on = (found != EMPTY) & (found & !NEW != tag(fingerprints[i], distance));
            probes[i] = distance + 1;
            slots[i] = (slots[i] + u32::from(goes_on)) & table.mask();
            open[left] = i;
            left += usize::from(goes_on);
        }
        count = left;
        if count == 0 {
            break;
        }
    }
    for (i, (start, found)) in all.iter_mut().enumerate().filter_map(|(i, one)| Some((i, one.as_mut()?))) {
        let head = heads[i];
        // False for an empty slot, whose fingerprint belongs to no key.
        let is_own = (head >> 32) as u32 & !NEW == tag(start.fingerprint, probes[i] - 1);
        *found = Found { slot: is_own.then_some(slots[i]), probes: probes[i], head };
    }
    all
}
