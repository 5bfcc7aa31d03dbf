//! Other ways to cells: by several levels, by similar normals, by keys of a lobe, and by points.

use hashcache_core::counters::Counters;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;
use hashgrid::few::{ByError, Levels, Neighbours, Search, claim_levels, deposit_levels, estimate_by, name_levels};
use hashgrid::jitter::SALT_DEPOSIT;
use hashgrid::keyed::{claim_keyed, deposit_keyed, estimate_keyed, name_keyed};
use hashgrid::layout::{Layout, Measured, Minimal, Standard};
use hashgrid::lobe::{Lobe, LobeSettings};
use hashgrid::names::Naming;
use hashgrid::similar::{claim_similar, deposit_similar, estimate_similar, place_home};
use hashgrid::{Params, Table, Word, points};

use crate::checks::Checks;

/// Calls everything and compares.
pub fn run(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    levels(checks, params, vertices);
    similar(checks, params, vertices);
    lobe(checks, params, vertices);
    by_points(checks, params, vertices);
}

/// How many of the answers are the vertices' light.
#[derive(Default)]
struct Right(u32);

impl Right {
    fn count(&mut self, estimate: &Estimate) {
        let near = |found: Vec3, wanted: Vec3| (found - wanted).abs().max_element() < 1e-6;
        let light = Vec3::new(1.0, 0.5, 0.25);
        self.0 +=
            u32::from(estimate.samples > 0 && near(estimate.direct, light) && near(estimate.further, Vec3::X * 0.125));
    }
}

fn levels(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    let words = [const { Word::new(0) }; 64 * Measured::WORDS];
    let Ok(table) = Table::<Measured>::with_layout(&words, params) else {
        return checks.that("Table::with_layout: Measured", false);
    };
    table.clear();
    let mut counters = Counters::default();
    checks.that("claim_levels", !claim_levels(&table, params, vertices, 3));
    name_levels(&table, params, vertices, 3, Naming::First);
    deposit_levels(&table, params, vertices, 3, &mut counters);
    checks.that("deposit_levels", counters.deposits == 12 && counters.balance() == 0 && table.cells().count() == 3);
    let mut all = true;
    all &= searched(&table, params, vertices, &Neighbours { least: 9 });
    all &= searched(&table, params, vertices, &Levels { least: 9, levels: 3 });
    all &= searched(&table, params, vertices, &ByError { least: 2, levels: 3, tolerance: 3.0 });
    checks.that("estimate_by", all);
}

fn searched(table: &Table<'_, Measured>, params: &Params, vertices: &[VertexRecord; 4], search: &impl Search) -> bool {
    let mut right = Right::default();
    estimate_by(table, params, vertices, search, &mut Counters::default(), |_, estimate| right.count(&estimate));
    right.0 == 4
}

fn similar(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    let words = [const { Word::new(0) }; 64 * Standard::WORDS];
    let Ok(table) = Table::<Standard>::with_layout(&words, params) else {
        return checks.that("Table::with_layout: Standard", false);
    };
    table.clear();
    let (mut counters, mut right) = (Counters::default(), Right::default());
    checks.that("claim_similar", !claim_similar(&table, params, vertices));
    deposit_similar(&table, params, vertices, &mut counters);
    estimate_similar(&table, params, vertices, 9, &mut counters, |_, estimate| right.count(&estimate));
    checks.that("estimate_similar", right.0 == 4 && counters.balance() == 0);
    let key = hashgrid::key::key(params, &vertices[0], SALT_DEPOSIT);
    let home = key.map(|key| place_home(&key) & (table.capacity() as u32 - 1));
    checks.that("place_home", home.is_some() && home == table.cells().next().map(|cell| cell.slot));
}

fn lobe(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    let settings = LobeSettings { layer: 1, direction_bins: 5, jitter: 0.0 };
    checks.that("Lobe::new: bad", Lobe::new(&LobeSettings { direction_bins: 4, ..settings }).is_err());
    let Ok(glossy) = Lobe::new(&settings) else { return checks.that("Lobe::new", false) };
    checks.that("Lobe::attributes", glossy.attributes(params, &vertices[0], SALT_DEPOSIT) >> 30 == 1);
    let words = [const { Word::new(0) }; 64 * Standard::WORDS];
    let Ok(table) = Table::<Standard>::with_layout(&words, params) else {
        return checks.that("Table::with_layout: Standard", false);
    };
    table.clear();
    let (mut counters, mut right) = (Counters::default(), Right::default());
    let deposit = |vertex: &VertexRecord| glossy.key(params, vertex, SALT_DEPOSIT);
    checks.that("claim_keyed", !claim_keyed(&table, vertices, deposit));
    name_keyed(&table, vertices, deposit, Naming::First);
    deposit_keyed(&table, params, vertices, deposit, &mut counters);
    let lookup = |vertex: &VertexRecord, salt| glossy.key(params, vertex, salt);
    estimate_keyed(&table, params, vertices, lookup, &mut counters, |_, estimate| right.count(&estimate));
    checks.that("estimate_keyed", right.0 == 4 && counters.balance() == 0);
}

fn by_points(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    let words = [const { Word::new(0) }; 64 * Minimal::WORDS];
    let Ok(table) = Table::<Minimal>::with_layout(&words, params) else {
        return checks.that("Table::with_layout: Minimal", false);
    };
    table.clear();
    let (mut counters, mut right) = (Counters::default(), 0);
    checks.that("points::claim_vertices", !points::claim_vertices(&table, params, vertices));
    points::name_vertices(&table, params, vertices, Naming::First);
    points::deposit_vertices(&table, params, vertices, &mut counters);
    points::estimate_vertices(&table, params, vertices, 1.0, 0, &mut counters, |_, estimate| {
        // One sum of all light.
        let all = (estimate.further - Vec3::new(1.125, 0.5, 0.25)).abs().max_element() < 1e-5;
        right += u32::from(estimate.samples > 0 && all);
    });
    checks.that("points::estimate_vertices", right == 4 && counters.balance() == 0);
    checks.that("points::chosen", points::chosen(params, &vertices[0].position_footprint).is_some());
}
