//! The octree's steps as kernels: host bodies over borrowed slices.
//!
//! | kernel | items | reads | writes | adds to |
//! |---|---|---|---|---|
//! | [`RECORD`] | vertices | structure, vertices | samples, keys | counters |
//! | [`REKEY`] | samples | structure, order, samples | keys | |
//! | [`ARRANGE`] | samples | order, samples | order, sorted | |
//! | [`Kernels::merge`] | samples | structure, sorted | cells | counters |
//! | [`Kernels::lookup`] | vertices | structure, cells, vertices | estimates | counters |
//!
//! `structure` holds the words of an [`Octree`]; `samples` are [`Sample`]s, `keys` a part of their keys, `order` the
//! numbers from 0 on, which the primitive `sort_pairs` turns into the samples' order: behind [`RECORD`] by the first part,
//! behind [`REKEY`] by the second where there is one. The parameter block of all is [`OctreeParams`]. On buffers that do not
//! fit each other the bodies raise [`Status::TABLE_FULL`] and do nothing.

use core::sync::atomic::Ordering::Relaxed;

use backend_api::{Access, BindingDecl, Kernel, Launch, Status};
use bytemuck::{Pod, Zeroable};

use super::cell::{CellRecord, ExactCell, Layout, PaperCell};
use super::cells::SharedCells;
use super::lookup::estimate_vertices;
use super::merge::merge_samples;
use super::params::OctreeParams;
use super::sample::{Sample, sample_key, sample_vertices};
use super::tally::{COUNTER_WORDS, add_counters};
use super::view::Octree;
use crate::counters::Counters;
use crate::record::VertexRecord;
use crate::stages::EstimateRecord;

/// Words of a [`Sample`].
const SAMPLE_WORDS: usize = size_of::<Sample>() / 4;

/// The kernels of one layout of cells.
#[derive(Clone, Copy)]
pub struct Kernels {
    /// Merges sorted samples into the cells of one level, see [`merge_samples`].
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
const COUNTERS: BindingDecl = decl("hc_counters", Access::AtomicU32, 4 * COUNTER_WORDS);
const SAMPLES: BindingDecl = decl("hc_samples", Access::AtomicU32, size_of::<Sample>());
const KEYS: BindingDecl = decl("hc_keys", Access::AtomicU32, 4);
const KEYS_OUT: BindingDecl = decl("hc_keys", Access::OutPerItem, 4);
const NUMBERS: BindingDecl = decl("hc_order", Access::In, 4);
const ORDER: BindingDecl = decl("hc_order", Access::OutPerItem, 4);
const SORTED_FROM: BindingDecl = decl("hc_samples", Access::In, size_of::<Sample>());
const SORTED_TO: BindingDecl = decl("hc_sorted", Access::OutPerItem, size_of::<Sample>());
const SORTED: BindingDecl = decl("hc_sorted", Access::In, size_of::<Sample>());
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

/// Makes samples of vertices. Raises [`Status::NON_FINITE`], and [`Status::TABLE_FULL`] where there was no room.
pub static RECORD: Kernel = kernel!("octree.record", [STRUCTURE, VERTICES, SAMPLES, KEYS, COUNTERS], record);

/// The second part of the samples' keys, in the order that the first gave them.
pub static REKEY: Kernel = kernel!("octree.rekey", [STRUCTURE, NUMBERS, SORTED_FROM, KEYS_OUT], rekey);

/// Puts samples into the order of their keys, and makes the order a row of numbers again.
pub static ARRANGE: Kernel = kernel!("octree.arrange", [ORDER, SORTED_FROM, SORTED_TO], arrange);

const _: () = assert!(RECORD.is_well_formed() && REKEY.is_well_formed() && ARRANGE.is_well_formed());

macro_rules! layout {
    ($kernels:ident, $cell:ty, $merge:literal, $lookup:literal) => {
        static $kernels: Kernels = {
            static MERGE: Kernel =
                kernel!($merge, [STRUCTURE, cells::<$cell>(Access::AtomicU32), SORTED, COUNTERS], merge::<$cell>);
            static LOOKUP: Kernel = kernel!(
                $lookup,
                [STRUCTURE, cells::<$cell>(Access::In), VERTICES, COUNTERS, ESTIMATES],
                lookup::<$cell>
            );
            const _: () = assert!(MERGE.is_well_formed() && LOOKUP.is_well_formed());
            Kernels { merge: &MERGE, lookup: &LOOKUP }
        };
    };
}

layout!(EXACT, ExactCell, "octree.merge", "octree.lookup");
layout!(PAPER, PaperCell, "octree.merge_paper", "octree.lookup_paper");

/// The launch's octree and parameters, if the octree is sound and has as many cells as are bound.
fn octree<'a>(launch: &Launch<'a>, cells: usize) -> Option<(Octree<'a>, &'a OctreeParams)> {
    let octree = Octree::new(launch.input(0)).ok().filter(|octree| octree.cells() as usize <= cells);
    if octree.is_none() {
        launch.raise(Status::TABLE_FULL);
    }
    Some((octree?, launch.params()))
}

/// The launch's part of an input.
fn items<'a, T: Pod>(launch: &Launch<'a>, slot: usize) -> &'a [T] {
    let first = launch.first as usize;
    &launch.input(slot)[first..first + launch.count as usize]
}

fn record(launch: &mut Launch<'_>) {
    let Some((octree, params)) = octree(launch, usize::MAX) else { return };
    let first = (params.first() as usize).saturating_add(launch.first as usize);
    let count = launch.count as usize;
    let keys = launch.atomic_u32(3).get(first..first + count);
    let samples = launch.atomic_u32(2).get(first * SAMPLE_WORDS..(first + count) * SAMPLE_WORDS);
    let (Some(keys), Some(samples)) = (keys, samples) else { return launch.raise(Status::TABLE_FULL) };
    let mut counters = Counters::default();
    sample_vertices(octree.grid(), params, items(launch, 1), &mut counters, |i, sample| {
        keys[i].store(sample_key(octree.grid(), &sample, 0), Relaxed);
        let words: [u32; SAMPLE_WORDS] = bytemuck::cast(sample);
        for (to, word) in samples[i * SAMPLE_WORDS..].iter().zip(words) {
            to.store(word, Relaxed);
        }
    });
    if counters.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
    add_counters(launch.atomic_u32(4), &counters);
}

fn rekey(launch: &mut Launch<'_>) {
    let Some((octree, _)) = octree(launch, usize::MAX) else { return };
    let samples = launch.input::<Sample>(2);
    for (from, key) in items::<u32>(launch, 1).iter().zip(launch.output::<u32>(3)) {
        let sample = samples.get(*from as usize).copied().unwrap_or_else(Sample::zeroed);
        *key = sample_key(octree.grid(), &sample, 1);
    }
}

fn arrange(launch: &mut Launch<'_>) {
    let samples = launch.input::<Sample>(1);
    let (order, sorted) = (launch.output::<u32>(0), launch.output::<Sample>(2));
    for ((number, from), to) in launch.items().zip(order).zip(sorted) {
        *to = samples.get(*from as usize).copied().unwrap_or_else(Sample::zeroed);
        *from = number;
    }
}

fn merge<C: CellRecord>(launch: &mut Launch<'_>) {
    let words = launch.atomic_u32(1);
    let Some((octree, params)) = octree(launch, words.len() / C::WORDS) else { return };
    let mut counters = Counters::default();
    let (cells, samples) = (SharedCells::<C>::new(words), launch.input::<Sample>(2));
    merge_samples(&octree, &cells, params, params.level(), samples, launch.items(), &mut counters);
    add_counters(launch.atomic_u32(3), &counters);
}

fn lookup<C: CellRecord>(launch: &mut Launch<'_>) {
    let cells = launch.input::<C>(1);
    let Some((octree, params)) = octree(launch, cells.len()) else { return };
    let mut counters = Counters::default();
    let estimates = launch.output::<EstimateRecord>(4);
    estimate_vertices(&octree, cells, params, items(launch, 2), &mut counters, |i, estimate| {
        estimates[i] = EstimateRecord {
            direct: estimate.direct.extend(estimate.samples as f32).to_array(),
            further: estimate.further.extend(estimate.variance).to_array(),
        };
    });
    if counters.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
    add_counters(launch.atomic_u32(3), &counters);
}
