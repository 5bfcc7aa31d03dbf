//! Normals told apart by probing: cells of one place stand in one probe sequence, whatever their normals, so that a
//! lookup with few deposits of its own normal meets those of similar normals on the way.
//!
//! The home follows from cell and level alone, the fingerprint from the whole key. That makes probe sequences longer by
//! the bins of a place, and the search for similar normals free of further cache misses. With the normal in both hashes
//! ([`crate::vertex`]) each bin is a cell of its own. Which is better depends on the vertices a cell: with many, nothing is
//! searched for, and short sequences win.
//!
//! ```
//! use hashcache_core::{counters::Counters, glam::Vec3, pack::octahedral_encode, record::VertexRecord};
//! use hashgrid::similar::{claim_similar, deposit_similar, estimate_similar};
//! use hashgrid::{CELL_WORDS, Params, Settings, Table, Word};
//!
//! let params = Params::new(&Settings { jitter: 0.0, normal_bins: 5, ..Settings::default() })?;
//! let storage = [const { Word::new(0) }; 64 * CELL_WORDS];
//! let table = Table::new(&storage, &params)?;
//! table.clear();
//! let facing = |x, light| VertexRecord {
//!     direct: [light; 4],
//!     normal: octahedral_encode(Vec3::new(x, 0.0, 1.0).normalize()),
//!     flags: VertexRecord::VALID,
//!     ..bytemuck::Zeroable::zeroed()
//! };
//! let vertices = [facing(0.0, 1.0), facing(0.4, 3.0), facing(-1.0, 99.0)];
//! let mut counters = Counters::default();
//! claim_similar(&table, &params, &vertices);
//! deposit_similar(&table, &params, &vertices, &mut counters);
//! estimate_similar(&table, &params, &vertices[..1], 2, &mut counters, |_, estimate| {
//!     assert_eq!((estimate.direct.x, estimate.samples), (2.0, 2)); // without the one that faces elsewhere
//! });
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Source
//! Binder et al. 2021, section 3.2.2.
//!
//! # Limits today
//! On the host, and for layouts without keys: names are found by the whole key's home.

use hashcache_core::counters::Counters;
use hashcache_core::exact::MAX_DEPOSITS;
use hashcache_core::pack::octahedral_decode_int;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use crate::jitter::normal_bin;
use crate::key::{Key, fingerprint, home, key};
use crate::layout::{Keep, Layout};
use crate::params::Params;
use crate::sums::Sums;
use crate::table::{Claim, Table};
use crate::tag::{EMPTY, NEW, tag};
use crate::vertex::{answer_vertices, deposit_found, key_of_deposit, note_all, quantize_for};

/// The bits of [`Key::attributes`] that tell the place: all but the normal's bin.
const PLACE: u32 = !(0x7ff << 8);

/// The hash whose low bits are the slot at which all keys of a place begin.
#[inline]
pub const fn place_home(key: &Key) -> u32 {
    home(&Key { cell: key.cell, attributes: key.attributes & PLACE })
}

fn home_slot<L: Layout>(table: &Table<'_, L>, key: &Key) -> u32 {
    const { assert!(L::Kept::WORDS == 0, "names are found by another home") }
    place_home(key) & table.mask()
}

/// Claims a cell for every vertex that has a key. True when some key was refused. Any number of threads may claim parts
/// of the same vertices.
pub fn claim_similar<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) -> bool {
    let keys = vertices.iter().filter_map(|vertex| key_of_deposit(params, vertex));
    keys.fold(false, |refused, key| {
        let slot = home_slot(table, &key);
        refused | (table.claim_from(slot, fingerprint(&key), table.head(slot)) == Claim::Refused)
    })
}

/// Deposits every vertex into the cell that was claimed for it. What finds no cell, and what is cut off, is counted. Any
/// number of threads may deposit parts of the same vertices.
pub fn deposit_similar<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
) {
    for vertex in vertices.iter().filter(|vertex| vertex.is_recordable()) {
        counters.deposits += 1;
        let values = quantize_for::<L>(params, vertex);
        let found = key_of_deposit(params, vertex);
        let found = found.map(|key| table.find_at(home_slot(table, &key), fingerprint(&key)));
        let stored = deposit_found(table, found, &values, counters);
        note_all(&values, stored, counters);
    }
}

/// Illumination at every vertex, in order: `answer(i, estimate)`: the mean of the vertex's own cell; where that has fewer
/// than `least` deposits, together with the cells of the up to eight bins around the normal's. Else as
/// [`crate::vertex::estimate_vertices`].
pub fn estimate_similar<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    least: u32,
    counters: &mut Counters,
    answer: impl FnMut(usize, Estimate),
) {
    let sums_for = |vertex: &VertexRecord, salt, counters: &mut Counters| {
        let key = key(params, vertex, salt)?;
        Some(gather(table, params, vertex, &key, least, counters))
    };
    answer_vertices(params, vertices, counters, sums_for, answer);
}

/// The fingerprints of a place with the bins at and around a normal; the key's own stands for itself and for duplicates.
fn similar(params: &Params, vertex: &VertexRecord, key: &Key) -> [u32; 9] {
    let (own, bins) = (fingerprint(key), params.normal_bins());
    let mut all = [own; 9];
    if bins < 3 {
        // A face is one bin: the next ones face elsewhere.
        return all;
    }
    let (normal, bin) = (octahedral_decode_int(vertex.normal), (65_536 / bins) as i32);
    let mut known = [key.normal_bin(); 9];
    for step in 0..9 {
        let other = normal_bin(normal, (step % 3 - 1) * bin, (step / 3 - 1) * bin, bins);
        if !known.contains(&other) {
            known[step as usize] = other;
            all[step as usize] = fingerprint(&Key { attributes: (key.attributes & PLACE) | (other << 8), ..*key });
        }
    }
    all
}

fn gather<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertex: &VertexRecord,
    key: &Key,
    least: u32,
    counters: &mut Counters,
) -> Sums {
    let home = home_slot(table, key);
    let found = table.find_at(home, fingerprint(key));
    counters.probes += u64::from(found.probes);
    let mut sums = found.slot.map_or(Sums::default(), |slot| table.sums(slot));
    if sums.count >= least {
        return sums;
    }
    let (own, others) = (fingerprint(key), similar(params, vertex, key));
    for distance in 0..table.max_probes() {
        let slot = (home + distance) & table.mask();
        let settled = (table.head(slot) >> 32) as u32;
        if settled == EMPTY {
            break;
        }
        counters.probes += 1;
        let is_similar = |other: &u32| *other != own && settled & !NEW == tag(*other, distance);
        if others.iter().any(is_similar) {
            let more = table.sums(slot);
            if sums.count.saturating_add(more.count) <= MAX_DEPOSITS {
                sums = sums.plus(&more);
            }
        }
    }
    sums
}
