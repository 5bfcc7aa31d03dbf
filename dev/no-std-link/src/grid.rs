//! `hashgrid`, on storage of the caller's.

mod time;
mod ways;

use core::hint::black_box;

use hashcache_core::counters::Counters;
use hashcache_core::exact::Quantum;
use hashcache_core::glam::Vec3;
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{CELL_WORDS, Claim, Params, Settings, Table, Word};

use crate::checks::Checks;

/// Vertices on the floor under one pixel, all with the same light.
pub fn vertices() -> [VertexRecord; 4] {
    core::array::from_fn(|i| VertexRecord {
        position_footprint: black_box([0.25, 0.0, 0.25, 0.01]),
        direct: [1.0, 0.5, 0.25, 0.0],
        further: [0.125, 0.0, 0.0, 0.0],
        throughput: [0.5, 0.5, 0.5, 0.0],
        emitted: [0.0; 4],
        normal: octahedral_encode(Vec3::Y),
        direction: octahedral_encode(Vec3::NEG_Y),
        seed: i as u32,
        flags: VertexRecord::VALID,
    })
}

/// Parameters without jitter, so that all vertices share a cell.
pub fn params() -> Option<Params> {
    Params::new(&Settings { jitter: 0.0, quantum: Quantum::for_scale(1.0), ..Settings::default() }).ok()
}

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    let bad = Settings { normal_bins: black_box(4), ..Settings::default() };
    checks.that("Params::new: bad", Params::new(&bad).is_err());
    let Some(params) = params() else { return checks.that("Params::new", false) };
    let storage: [Word; 64 * CELL_WORDS] = core::array::from_fn(|_| Word::new(0));
    checks.that("Table::new: short", Table::new(&storage[..8], &params).is_err());
    let Ok(table) = Table::new(&storage, &params) else { return checks.that("Table::new", false) };
    table.clear();

    let vertices = vertices();
    let mut counters = Counters::default();
    checks.that("claim_vertices", !claim_vertices(&table, &params, &vertices));
    deposit_vertices(&table, &params, &vertices, &mut counters);
    checks.that("deposit_vertices", counters.deposits == 4 && counters.balance() == 0);
    let mut right = 0;
    estimate_vertices(&table, &params, &vertices, &mut counters, |_, estimate| {
        let whole = estimate.direct == Vec3::new(1.0, 0.5, 0.25) && estimate.further == Vec3::X * 0.125;
        right += u32::from(whole && estimate.samples == 4);
    });
    checks.that("estimate_vertices", right == 4 && counters.hits == 4);
    checks.that("Table::validate", table.validate().is_ok());
    cells(checks, &table, &params, &vertices[0]);
    ways::run(checks, &params, &vertices);
    time::run(checks, &params, &vertices);
}

fn cells(checks: &mut Checks, table: &Table<'_>, params: &Params, vertex: &VertexRecord) {
    let key = hashgrid::key::key(params, vertex, SALT_LOOKUP);
    checks.that("key", key.is_some() && key == hashgrid::key::key(params, vertex, SALT_DEPOSIT));
    let Some(key) = key else { return };
    checks.that("Table::lookup", table.lookup(&key).is_some_and(|cell| cell.count == 4));
    checks.that("Table::claim", table.claim(&key) != Claim::Refused && table.load() > 0.0);
    checks.that("Table::deposit", table.deposit(&key, &[1; 6]));
    checks.that("Table::cells", table.cells().any(|cell| cell.count == 5));
    let corner = key.corner(params);
    checks.that("Key::corner", corner[1] <= 0.0 && params.cell_size(key.level()) > 0.0);
}
