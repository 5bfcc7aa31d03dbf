//! The octree's steps as kernels: host bodies over borrowed slices.
//!
//! | kernel | items | structure | cells | vertices | marks | lists | estimates |
//! |---|---|---|---|---|---|---|---|
//! | [`Kernels::deposit`] | vertices | read | read | read | added to | added to | |
//! | [`Kernels::merge`] | entries | read | written | | added to | added to | |
//! | [`Kernels::lookup`] | vertices | read | read | read | added to | | written |
//!
//! `structure` holds the words of an [`Octree`]; `marks` and `lists` are those of [`Pending`]; the parameter block of all
//! is [`OctreeParams`]. On buffers that do not fit each other the bodies raise [`Status::TABLE_FULL`] and do nothing.

use backend_api::{Access, BindingDecl, Kernel, Launch, Status};

use super::cell::{CellRecord, ExactCell, Layout, PaperCell};
use super::cells::SharedCells;
use super::deposit::deposit_vertices;
use super::lookup::estimate_vertices;
use super::merge::merge_entries;
use super::params::OctreeParams;
use super::pending::{ENTRY_WORDS, Pending, add_counters};
use super::view::Octree;
use crate::counters::Counters;
use crate::record::VertexRecord;
use crate::stages::EstimateRecord;

/// The kernels of one layout of cells.
#[derive(Clone, Copy)]
pub struct Kernels {
    /// Adds vertices to a frame's sums. Raises [`Status::TABLE_FULL`] when there was no room, [`Status::NON_FINITE`].
    pub deposit: &'static Kernel,
    /// Merges one level's sums into its cells, see [`merge_entries`].
    pub merge: &'static Kernel,
    /// Illumination at vertices. Raises [`Status::NON_FINITE`] where a vertex's own light was needed and was none.
    pub lookup: &'static Kernel,
}

impl Layout {
    /// The kernels of the layout.
    pub const fn kernels(self) -> &'static Kernels {
        match self {
            Self::Exact => &EXACT,
            Self::Paper => &PAPER,
        }
    }
}

const fn decl(name: &'static str, access: Access, stride: usize) -> BindingDecl {
    BindingDecl { name, access, stride: stride as u32 }
}

const STRUCTURE: BindingDecl = decl("hc_structure", Access::In, 4);
const VERTICES: BindingDecl = decl("hc_vertices", Access::In, size_of::<VertexRecord>());
const MARKS: BindingDecl = decl("hc_marks", Access::AtomicU32, 4);
const LISTS: BindingDecl = decl("hc_lists", Access::AtomicU32, 8 * ENTRY_WORDS);
const ESTIMATES: BindingDecl = decl("hc_estimates", Access::OutPerItem, size_of::<EstimateRecord>());

const fn cells<C: CellRecord>(access: Access) -> BindingDecl {
    decl("hc_cells", access, size_of::<C>())
}

macro_rules! kernel {
    ($name:literal, [$($binding:expr),*], $body:expr) => {
        Kernel {
            name: $name,
            bindings: &[$($binding),*],
            params_size: size_of::<OctreeParams>() as u32,
            body: $body,
            wgsl: None,
            casts_rays: false,
        }
    };
}

macro_rules! layout {
    ($kernels:ident, $cell:ty, $deposit:literal, $merge:literal, $lookup:literal) => {
        static $kernels: Kernels = {
            static DEPOSIT: Kernel =
                kernel!($deposit, [STRUCTURE, cells::<$cell>(Access::In), VERTICES, MARKS, LISTS], deposit::<$cell>);
            static MERGE: Kernel =
                kernel!($merge, [STRUCTURE, cells::<$cell>(Access::AtomicU32), MARKS, LISTS], merge::<$cell>);
            static LOOKUP: Kernel =
                kernel!($lookup, [STRUCTURE, cells::<$cell>(Access::In), VERTICES, MARKS, ESTIMATES], lookup::<$cell>);
            const _: () = assert!(DEPOSIT.is_well_formed() && MERGE.is_well_formed() && LOOKUP.is_well_formed());
            Kernels { deposit: &DEPOSIT, merge: &MERGE, lookup: &LOOKUP }
        };
    };
}

layout!(EXACT, ExactCell, "octree.deposit", "octree.merge", "octree.lookup");
layout!(PAPER, PaperCell, "octree.deposit_paper", "octree.merge_paper", "octree.lookup_paper");

/// The launch's octree and parameters, if the octree is sound and has as many cells as are bound.
fn octree<'a>(launch: &Launch<'a>, cells: usize) -> Option<(Octree<'a>, &'a OctreeParams)> {
    let octree = Octree::new(launch.input(0)).ok().filter(|octree| octree.cells() as usize <= cells);
    if octree.is_none() {
        launch.raise(Status::TABLE_FULL);
    }
    Some((octree?, launch.params()))
}

fn pending<'a>(launch: &Launch<'a>, octree: &Octree<'_>, marks: usize) -> Option<Pending<'a>> {
    let pending = Pending::new(launch.atomic_u32(marks), launch.atomic_u32(marks + 1), octree.cells()).ok();
    if pending.is_none() {
        launch.raise(Status::TABLE_FULL);
    }
    pending
}

fn vertices<'a>(launch: &Launch<'a>) -> &'a [VertexRecord] {
    let first = launch.first as usize;
    &launch.input(2)[first..first + launch.count as usize]
}

fn deposit<C: CellRecord>(launch: &mut Launch<'_>) {
    let cells = launch.input::<C>(1);
    let Some((octree, params)) = octree(launch, cells.len()) else { return };
    let Some(pending) = pending(launch, &octree, 3) else { return };
    let mut counters = Counters::default();
    if deposit_vertices(&octree, cells, &pending, params, vertices(launch), &mut counters) {
        launch.raise(Status::TABLE_FULL);
    }
    if counters.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
    pending.add_counters(&counters);
}

fn merge<C: CellRecord>(launch: &mut Launch<'_>) {
    let words = launch.atomic_u32(1);
    let Some((octree, params)) = octree(launch, words.len() / C::WORDS) else { return };
    let Some(pending) = pending(launch, &octree, 2) else { return };
    merge_entries(&octree, &SharedCells::<C>::new(words), &pending, params, params.level(), launch.items());
}

fn lookup<C: CellRecord>(launch: &mut Launch<'_>) {
    let cells = launch.input::<C>(1);
    let Some((octree, params)) = octree(launch, cells.len()) else { return };
    let mut counters = Counters::default();
    let estimates = launch.output::<EstimateRecord>(4);
    estimate_vertices(&octree, cells, params, vertices(launch), &mut counters, |i, estimate| {
        estimates[i] = EstimateRecord {
            direct: estimate.direct.extend(estimate.samples as f32).to_array(),
            further: estimate.further.extend(0.0).to_array(),
        };
    });
    if counters.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
    add_counters(launch.atomic_u32(3), &counters);
}
