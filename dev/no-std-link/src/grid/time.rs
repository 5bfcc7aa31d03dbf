//! Cells that last: names, stamps, changes, rules over time, levels that change, eviction.

use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashgrid::evict::{CountAndAge, LeastRecent, Priority, evict};
use hashgrid::layout::{Complete, Lasting, Layout};
use hashgrid::levels::{inherit, touch_vertices};
use hashgrid::merge::Merge;
use hashgrid::names::{Naming, name_vertices};
use hashgrid::temporal::{Adaptive, Change, FixedCount, Integrate, MovingAverage, Rule, change_vertices};
use hashgrid::vertex::{claim_vertices, deposit_vertices};
use hashgrid::{Params, Table, Word};

use crate::checks::Checks;

/// Calls everything and compares.
pub fn run(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4]) {
    rules(checks);
    let [old, new] = [const { [const { Word::new(0) }; 64 * Lasting::WORDS] }; 2];
    let frame = [const { Word::new(0) }; 64 * Complete::WORDS];
    let tables = (Table::<Lasting>::with_layout(&old, params), Table::<Lasting>::with_layout(&new, params));
    let (Ok(lasting), Ok(moved)) = tables else { return checks.that("Table::with_layout: Lasting", false) };
    let Ok(frame) = Table::<Complete>::with_layout(&frame, params) else {
        return checks.that("Table::with_layout: Complete", false);
    };
    merged(checks, params, vertices, &lasting, &frame);
    levels(checks, params, vertices, &moved);
}

fn rules(checks: &mut Checks) {
    let change = Change::of(0, 256);
    checks.that("Change::share", change.share() == 1 << 16 && Change::of(256, 256).share() == 0);
    checks.that("Integrate", Integrate.weight(100, 10, change) == 100);
    checks.that("FixedCount", FixedCount { most: 50 }.weight(100, 10, change) == 50);
    checks.that("Adaptive", Adaptive { gain: 1, most: 1000 }.weight(100, 10, change) == 0);
    checks.that("MovingAverage::new: bad", MovingAverage::new(1.5).is_err());
    let average = MovingAverage::new(0.75).map(|rule| rule.weight(1000, 10, change));
    checks.that("MovingAverage", average == Ok(30));
    let by = CountAndAge { half_life: 10 };
    checks.that("Priority", by.priority(1024, 0) == 20 && LeastRecent.priority(1, 3) == 60);
}

/// Claims, names, stamps and deposits a frame's vertices.
fn record<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord; 4], frame: u32) -> bool {
    let mut counters = Counters::default();
    let refused = claim_vertices(table, params, vertices);
    name_vertices(table, params, vertices, Naming::First);
    name_vertices(table, params, vertices, Naming::Second);
    touch_vertices(table, params, vertices, frame);
    deposit_vertices(table, params, vertices, &mut counters);
    !refused && counters.balance() == 0
}

fn merged(
    checks: &mut Checks,
    params: &Params,
    vertices: &[VertexRecord; 4],
    lasting: &Table<'_, Lasting>,
    frame: &Table<'_, Complete>,
) {
    lasting.clear();
    for index in 0..3 {
        frame.clear();
        checks.that("record: Complete", record(frame, params, vertices, index));
        let mut counters = Counters::default();
        change_vertices(frame, params, vertices, vertices, &mut counters);
        let change = frame.cells().next().map(|cell| frame.change(cell.slot));
        let unchanged = change.is_some_and(|change| change.difference == 0 && change.magnitude > 0);
        checks.that("change_vertices", unchanged && counters.refusals == 0);
        let Ok(merge) = Merge::new(lasting, frame) else { return checks.that("Merge::new", false) };
        let merged = merge.all(&FixedCount { most: 4 }, index);
        checks.that("Merge::all", merged.cells == 1 && merged.refused == 0);
    }
    let Some(cell) = lasting.cells().next() else { return checks.that("Table::cells: lasting", false) };
    checks.that("FixedCount: blend", cell.count == 8 && lasting.stamp(cell.slot) == 2);
    let sums = lasting.sums(cell.slot);
    let mean = sums.mean_direct(params.quantum());
    checks.that("Sums::mean_direct", mean.map(f32::to_bits) == [1.0_f32, 0.5, 0.25].map(f32::to_bits));
    let key = lasting.key(cell.slot);
    checks.that("Table::key", key.is_some_and(|key| lasting.find_named(&key) == Some(cell.slot)));
    lasting.touch(cell.slot, 7);
    checks.that("Table::touch", lasting.stamp(cell.slot) == 7);
    let energy = sums.energy();
    let evicted = evict(lasting, 0, 8, &LeastRecent);
    checks.that("evict", evicted.removed >= 1 && evicted.folded >= 1);
    let left = lasting.validate().map(|summary| summary.energy.wrapping_add(evicted.energy_lost));
    checks.that("evict: energy", left.is_ok_and(|left| left == energy));
}

fn levels(checks: &mut Checks, params: &Params, vertices: &[VertexRecord; 4], table: &Table<'_, Lasting>) {
    table.clear();
    checks.that("record: Lasting", record(table, params, vertices, 0));
    // The camera goes away: cells twice as large.
    let mut far = *vertices;
    for vertex in &mut far {
        vertex.position_footprint[3] *= 2.0;
    }
    claim_vertices(table, params, &far);
    name_vertices(table, params, &far, Naming::First);
    name_vertices(table, params, &far, Naming::Second);
    touch_vertices(table, params, &far, 1);
    let inherited = inherit(table, 1, 64);
    checks.that("inherit", inherited.summed == 1 && table.cells().any(|cell| cell.count == 4));
    let Some(cell) = table.cells().find(|cell| cell.count == 4) else { return };
    table.remove(cell.slot);
    checks.that("Table::remove", table.cells().all(|cell| cell.count == 0));
}
