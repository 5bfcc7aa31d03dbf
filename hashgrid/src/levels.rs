//! Light handed on when a place changes its level between frames, because the camera came nearer or went away.
//!
//! [`inherit`] runs when a frame's keys have been claimed, named and stamped, and before their light is deposited or
//! merged. Each cell that is new then takes over
//! - from the up to eight cells of the next finer level inside it: all their sums, if this frame uses them no more;
//! - else from the cell of the next coarser level around it: a share, in which all new cells inside that cell take part
//!   alike, and the coarser cell itself if this frame still uses it. At most a number of deposits each, since coarse
//!   light in fine cells shows; the rest stays where it was.
//!
//! Sums are moved, never copied: the table's energy stays the same to the last quantum. A share is made of whole deposits
//! with the coarser cell's mean, to a quantum.
//!
//! ```
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::layout::{Lasting, Layout};
//! use hashgrid::levels::inherit;
//! use hashgrid::names::{Naming, name_vertices};
//! use hashgrid::{Params, Settings, Table, Word, levels, vertex};
//!
//! let params = Params::new(&Settings { jitter: 0.0, ..Settings::default() })?;
//! let storage = [const { Word::new(0) }; 64 * Lasting::WORDS];
//! let table = Table::<Lasting>::with_layout(&storage, &params)?;
//! table.clear();
//! for (frame, footprint) in [0.01, 0.02].into_iter().enumerate() { // the camera goes away
//!     let vertices = [VertexRecord {
//!         position_footprint: [0.3, 0.3, 0.3, footprint],
//!         direct: [1.0; 4],
//!         flags: VertexRecord::VALID,
//!         ..bytemuck::Zeroable::zeroed()
//!     }];
//!     vertex::claim_vertices(&table, &params, &vertices);
//!     name_vertices(&table, &params, &vertices, Naming::First);
//!     name_vertices(&table, &params, &vertices, Naming::Second);
//!     levels::touch_vertices(&table, &params, &vertices, frame as u32);
//!     inherit(&table, frame as u32, 64);
//!     vertex::deposit_vertices(&table, &params, &vertices, &mut Counters::default());
//! }
//! assert_eq!(table.cells().map(|cell| cell.count).max(), Some(2)); // the first frame's deposit came along
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Source
//! Binder et al. 2021, section 3.4.2.
//!
//! # Limits today
//! One level a frame, which is a factor of two in distance. On the host, on one thread.

use hashcache_core::exact::MAX_DEPOSITS;
use hashcache_core::record::VertexRecord;

use crate::key::{Key, coarser, finer};
use crate::layout::{Keep, Layout};
use crate::params::Params;
use crate::sums::Sums;
use crate::table::Table;
use crate::tag::tag_is_new;
use crate::vertex::key_of_deposit;

/// What [`inherit`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inherited {
    /// Cells whose sums went into a coarser one.
    pub summed: u64,
    /// New cells that were given a share of a coarser one.
    pub shared: u64,
}

/// Stamps the cells that a frame's vertices deposit into. Any number of threads may stamp parts of the same vertices.
pub fn touch_vertices<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], frame: u32) {
    for key in vertices.iter().filter_map(|vertex| key_of_deposit(params, vertex)) {
        if let Some(slot) = table.find_named(&key) {
            table.touch(slot, frame);
        }
    }
}

/// Gives every new cell light of the level below or above, see [`crate::levels`]; at most `most` deposits from above.
/// Cells that `frame` stamped count as in use. While nobody else works on the table.
pub fn inherit<L: Layout>(table: &Table<'_, L>, frame: u32, most: u32) -> Inherited {
    const { assert!(L::STAMP && L::Kept::WORDS > 0, "inheritance needs stamps and keys") }
    let mut inherited = Inherited::default();
    for slot in 0..table.capacity() as u32 {
        if !is_new(table, slot) {
            continue;
        }
        let Some(key) = table.key(slot) else { continue };
        let summed = sum_finer(table, &key, slot, frame);
        inherited.summed += summed;
        if summed == 0 {
            inherited.shared += share_coarser(table, &key, frame, most);
        }
    }
    inherited
}

fn is_new<L: Layout>(table: &Table<'_, L>, slot: u32) -> bool {
    tag_is_new((table.head(slot) >> 32) as u32)
}

/// The cells of the next finer level that the table has.
fn children<'t, L: Layout>(table: &'t Table<'_, L>, key: &'t Key) -> impl Iterator<Item = u32> + 't {
    (0..8).filter_map(|octant| table.find_named(&finer(key, octant)?))
}

/// Moves the sums of finer cells that are no longer in use; how many there were.
fn sum_finer<L: Layout>(table: &Table<'_, L>, key: &Key, slot: u32, frame: u32) -> u64 {
    let (mut all, mut summed) = (Sums::default(), 0);
    for child in children(table, key) {
        let sums = table.sums(child);
        let fits = sums.count > 0 && all.count + sums.count <= MAX_DEPOSITS;
        if fits && table.stamp(child) != frame {
            all = all.plus(&sums);
            table.set_sums(child, &Sums::default());
            summed += 1;
        }
    }
    if summed > 0 {
        table.set_sums(slot, &all);
    }
    summed
}

/// Distributes part of the coarser cell's sums over all new cells inside it; how many there were.
fn share_coarser<L: Layout>(table: &Table<'_, L>, key: &Key, frame: u32, most: u32) -> u64 {
    let Some((above, parent)) = coarser(key).and_then(|above| Some((above, table.find_named(&above)?))) else {
        return 0;
    };
    let whole = table.sums(parent);
    if whole.count == 0 {
        return 0;
    }
    let mut heirs = [0; 8];
    let mut count = 0;
    for heir in children(table, &above).filter(|slot| is_new(table, *slot)) {
        heirs[count] = heir;
        count += 1;
    }
    let heirs = &heirs[..count];
    let sharers = count as u32 + u32::from(table.stamp(parent) == frame);
    let each = (whole.count / sharers).min(most);
    // Fewer deposits than heirs: the first ones get one each.
    let extra = if each < most { (whole.count % sharers).min(count as u32) } else { 0 };
    let (mut given, mut shared) = (Sums::default(), 0);
    for (i, heir) in heirs.iter().enumerate() {
        let share = each + u32::from((i as u32) < extra);
        if share > 0 {
            // Differences of growing parts add up to the last of them exactly.
            let upto = whole.part(given.count + share);
            table.set_sums(*heir, &upto.minus(&given));
            given = upto;
            shared += 1;
        }
    }
    table.set_sums(parent, &whole.minus(&given));
    shared
}
