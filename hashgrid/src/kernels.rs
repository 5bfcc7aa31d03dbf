//! The grid's steps as kernels: a host body over borrowed slices, and WGSL.
//!
//! | kernel | items | table | vertices | counters | estimates |
//! |---|---|---|---|---|---|
//! | [`CLEAR`] | cells | written | | | |
//! | [`FADE`] | cells | sums | | | |
//! | [`CLAIM`] | vertices | tags | read | | |
//! | [`DEPOSIT`] | vertices | sums | read | added to | |
//! | [`LOOKUP`] | vertices | read | read | added to | written |
//!
//! The table's binding is a power of two of cells, from [`crate::table::MIN_CELLS`] on; on another size the host bodies
//! raise [`Status::TABLE_FULL`] and do nothing. The parameter block of all is [`Params`], of [`FADE`] [`FadeParams`].

use backend_api::{Access, BindingDecl, Kernel, Launch, Status, Wgsl};
use bytemuck::{Pod, Zeroable};
use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use hashcache_core::wgsl as hc;

use crate::params::Params;
use crate::table::{CELL_WORDS, Table};
use crate::temporal::fade_cells;
use crate::vertex::{add_counters, claim_vertices, deposit_vertices, estimate_vertices};

/// Twins of [`crate::key`] and [`crate::jitter`]; needs the core's hash, jitter, level, pack and record.
pub const WGSL_KEY: &str = include_str!("../wgsl/key.wgsl");

/// Twins of where the points of [`crate::points`] are; needs [`WGSL_KEY`] and what that needs.
pub const WGSL_POINTS: &str = include_str!("../wgsl/points.wgsl");

/// Twins of [`crate::lobe`] and of the home of [`crate::similar`]; needs [`WGSL_KEY`] and what that needs.
pub const WGSL_LOBE: &str = include_str!("../wgsl/lobe.wgsl");

/// Twins of [`crate::tag`].
pub const WGSL_TAG: &str = include_str!("../wgsl/tag.wgsl");

/// Twins of [`crate::table`]; needs [`WGSL_TAG`], the core's exact sums, and the globals `hg_table` and `hg_params`.
pub const WGSL_TABLE: &str = include_str!("../wgsl/table.wgsl");

/// Counting inside a workgroup; needs the core's counters and exact sums, and the global `hg_counters`.
pub const WGSL_TALLY: &str = include_str!("../wgsl/tally.wgsl");

/// The globals of these kernels; replace it to embed the functions elsewhere.
pub const WGSL_BINDINGS: &str = include_str!("../wgsl/hashgrid_bindings.wgsl");

const PARAMS_SIZE: u32 = size_of::<Params>() as u32;
const WORKGROUP: u32 = 64;

const TABLE: BindingDecl = BindingDecl { name: "hg_table", access: Access::AtomicU64, stride: (CELL_WORDS * 8) as u32 };
const VERTICES: BindingDecl =
    BindingDecl { name: "hg_vertices", access: Access::In, stride: size_of::<VertexRecord>() as u32 };
const COUNTERS: BindingDecl =
    BindingDecl { name: "hg_counters", access: Access::AtomicU64, stride: size_of::<Counters>() as u32 };
const ESTIMATES: BindingDecl =
    BindingDecl { name: "hg_estimates", access: Access::OutPerItem, stride: size_of::<EstimateRecord>() as u32 };

macro_rules! modules {
    ($entry:literal) => {
        &[
            hc::HASH,
            hc::JITTER,
            hc::PACK,
            hc::LEVEL,
            hc::EXACT,
            hc::COUNTERS,
            hc::RECORD,
            WGSL_KEY,
            WGSL_TAG,
            WGSL_BINDINGS,
            WGSL_TABLE,
            WGSL_TALLY,
            include_str!($entry),
        ]
    };
}

/// Empties the table; an item is a cell.
pub static CLEAR: Kernel = Kernel {
    name: "hashgrid.clear",
    bindings: &[TABLE],
    params_size: PARAMS_SIZE,
    body: clear,
    wgsl: Some(Wgsl {
        modules: modules!("../wgsl/clear_entry.wgsl"),
        entry: "hg_clear_main",
        workgroup_size: WORKGROUP,
    }),
    casts_rays: false,
};

/// Parameters of [`FADE`] (64 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FadeParams {
    /// The grid's.
    pub params: Params,
    /// Most deposits that a cell keeps.
    pub most: u32,
    /// Zero.
    pub reserved: [u32; 3],
}

/// Scales each cell to at most so many deposits ([`fade_cells`]); an item is a cell. Host code only: shares of 64-bit sums
/// need divisions of 96 bits, which WGSL lacks.
pub static FADE: Kernel = Kernel {
    name: "hashgrid.fade",
    bindings: &[TABLE],
    params_size: size_of::<FadeParams>() as u32,
    body: fade,
    wgsl: None,
    casts_rays: false,
};

/// Claims a cell for every vertex. Raises [`Status::TABLE_FULL`] when a key was refused.
pub static CLAIM: Kernel = Kernel {
    name: "hashgrid.claim",
    bindings: &[TABLE, VERTICES],
    params_size: PARAMS_SIZE,
    body: claim,
    wgsl: Some(Wgsl {
        modules: modules!("../wgsl/claim_entry.wgsl"),
        entry: "hg_claim_main",
        workgroup_size: WORKGROUP,
    }),
    casts_rays: false,
};

/// Deposits every vertex into the cell that was claimed for it. Raises [`Status::NON_FINITE`] and [`Status::OVERFLOW`].
pub static DEPOSIT: Kernel = Kernel {
    name: "hashgrid.deposit",
    bindings: &[TABLE, VERTICES, COUNTERS],
    params_size: PARAMS_SIZE,
    body: deposit,
    wgsl: Some(Wgsl {
        modules: modules!("../wgsl/deposit_entry.wgsl"),
        entry: "hg_deposit_main",
        workgroup_size: WORKGROUP,
    }),
    casts_rays: false,
};

/// Illumination at every vertex. Raises [`Status::NON_FINITE`] where a vertex's own value was needed and was none.
pub static LOOKUP: Kernel = Kernel {
    name: "hashgrid.lookup",
    bindings: &[TABLE, VERTICES, COUNTERS, ESTIMATES],
    params_size: PARAMS_SIZE,
    body: lookup,
    wgsl: Some(Wgsl {
        modules: modules!("../wgsl/lookup_entry.wgsl"),
        entry: "hg_lookup_main",
        workgroup_size: WORKGROUP,
    }),
    casts_rays: false,
};

const _: () =
    assert!(CLEAR.is_well_formed() && CLAIM.is_well_formed() && DEPOSIT.is_well_formed() && LOOKUP.is_well_formed());

/// The launch's table and parameters; raises a flag when they do not fit each other.
fn table<'a>(launch: &Launch<'a>) -> Option<(Table<'a>, &'a Params)> {
    let params = launch.params::<Params>();
    Some((table_of(launch, params)?, params))
}

fn table_of<'a>(launch: &Launch<'a>, params: &Params) -> Option<Table<'a>> {
    let table = Table::new(launch.atomic_u64(0), params).ok();
    if table.is_none() {
        launch.raise(Status::TABLE_FULL);
    }
    table
}

fn vertices<'a>(launch: &Launch<'a>) -> &'a [VertexRecord] {
    let first = launch.first as usize;
    &launch.input(1)[first..first + launch.count as usize]
}

fn clear(launch: &mut Launch<'_>) {
    let Some((table, _)) = table(launch) else { return };
    for slot in launch.first..launch.first + launch.count {
        table.clear_cell(slot);
    }
}

fn fade(launch: &mut Launch<'_>) {
    let fade = launch.params::<FadeParams>();
    let Some(table) = table_of(launch, &fade.params) else { return };
    fade_cells(&table, launch.first..launch.first + launch.count, fade.most);
}

fn claim(launch: &mut Launch<'_>) {
    let Some((table, params)) = table(launch) else { return };
    if claim_vertices(&table, params, vertices(launch)) {
        launch.raise(Status::TABLE_FULL);
    }
}

fn deposit(launch: &mut Launch<'_>) {
    let Some((table, params)) = table(launch) else { return };
    let mut counters = Counters::default();
    deposit_vertices(&table, params, vertices(launch), &mut counters);
    if counters.overflowed > 0 {
        launch.raise(Status::OVERFLOW);
    }
    finish(launch, &counters);
}

fn lookup(launch: &mut Launch<'_>) {
    let Some((table, params)) = table(launch) else { return };
    let mut counters = Counters::default();
    let estimates = launch.output::<EstimateRecord>(3);
    estimate_vertices(&table, params, vertices(launch), &mut counters, |i, estimate| {
        estimates[i] = EstimateRecord {
            direct: estimate.direct.extend(estimate.samples as f32).to_array(),
            further: estimate.further.extend(0.0).to_array(),
        };
    });
    finish(launch, &counters);
}

fn finish(launch: &Launch<'_>, counters: &Counters) {
    if counters.non_finite > 0 {
        launch.raise(Status::NON_FINITE);
    }
    add_counters(launch.atomic_u64(2), counters);
}
