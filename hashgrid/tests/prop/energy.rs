use hashcache_core::counters::Counters;
use hashcache_core::exact::{MAX_DEPOSITS, Quantum};
use hashgrid::jitter::SALT_DEPOSIT;
use hashgrid::key::key;
use hashgrid::tag::EMPTY;
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is deposited, with whatever unit: recorded = stored + refused + clamped to the last quantum, the table's
    /// sums are the stored energy, and every estimate is finite.
    #[test]
    fn no_energy_gets_lost_unseen(
        settings in any_settings(),
        vertices in prop::collection::vec(any_vertex(), 1..300),
        e in -100_i32..=80,
    ) {
        let params = params(Settings { quantum: Quantum::new(e).unwrap(), ..settings });
        let words = storage(64, &params);
        let table = Table::new(&words, &params).unwrap();
        let mut counters = Counters::default();
        for _ in 0..2 {
            claim_vertices(&table, &params, &vertices);
            deposit_vertices(&table, &params, &vertices, &mut counters);
        }
        let valid = vertices.iter().filter(|v| v.flags & VertexRecord::VALID != 0);
        prop_assert_eq!(counters.deposits, 2 * valid.clone().count() as u64);
        prop_assert_eq!(counters.balance(), 0);
        let summary = table.validate().unwrap();
        prop_assert_eq!(summary.energy, counters.energy_stored);
        prop_assert_eq!(summary.deposits, counters.deposits - counters.refusals);
        let channels = valid.flat_map(|v| v.direct[..3].iter().chain(&v.further[..3]));
        let non_finite = channels.filter(|c| !c.is_finite()).count() as u64;
        prop_assert_eq!(counters.non_finite, 2 * non_finite);

        let mut answers = 0;
        let mut asked = Counters::default();
        let mut all_finite = true;
        estimate_vertices(&table, &params, &vertices, &mut asked, |i, estimate| {
            all_finite &= i == answers && estimate.direct.is_finite() && estimate.further.is_finite();
            answers += 1;
        });
        prop_assert!(all_finite);
        prop_assert_eq!(answers, vertices.len());
        prop_assert_eq!(asked.lookups, asked.hits + asked.fallbacks);
        prop_assert_eq!(2 * asked.lookups, counters.deposits);
    }
}

/// Radiance from 10⁻¹² to 10¹² comes back as it was, with the unit near it.
#[test]
fn every_magnitude_comes_back() {
    for exponent in -12..=12 {
        let radiance = 10.0_f32.powi(exponent);
        let params = params(Settings { quantum: Quantum::for_scale(radiance), ..still() });
        let words = storage(64, &params);
        let table = Table::new(&words, &params).unwrap();
        let mut vertex = vertex([0.0; 3], Vec3::Z);
        (vertex.direct, vertex.further) = ([radiance; 4], [0.25 * radiance; 4]);
        let vertices = [vertex; 3];
        let mut counters = Counters::default();
        claim_vertices(&table, &params, &vertices);
        deposit_vertices(&table, &params, &vertices, &mut counters);
        estimate_vertices(&table, &params, &vertices[..1], &mut counters, |_, estimate| {
            assert_eq!(estimate.samples, 3);
            // Half a quantum, L0·2⁻²¹, and the rounding of the mean.
            assert!((estimate.direct.x / radiance - 1.0).abs() < 1e-6, "{radiance}: {estimate:?}");
            assert!((estimate.further.z / radiance - 0.25).abs() < 1e-6, "{radiance}: {estimate:?}");
        });
    }
}

/// A cell with 10⁹ deposits goes on to its bound, refuses and counts what comes after, and its mean stays right.
#[test]
fn full_cells_refuse() {
    let params = params(still());
    let words = storage(64, &params);
    let table = Table::new(&words, &params).unwrap();
    let mut vertex = vertex([0.0; 3], Vec3::Z);
    vertex.direct = [8192.0; 4];
    let slot = {
        claim_vertices(&table, &params, &[vertex]);
        table.find(&key(&params, &vertex, SALT_DEPOSIT).unwrap()).slot.unwrap()
    };
    let before = MAX_DEPOSITS - 2;
    let largest = 1_u64 << 33;
    let set = |word: usize, value: u64| {
        words[slot as usize * CELL_WORDS + word].store(value, std::sync::atomic::Ordering::Relaxed);
    };
    set(0, (u64::from(table.cell(slot).tag & !(1 << 31)) << 32) | u64::from(before));
    for channel in 1..=3 {
        set(channel, largest * u64::from(before));
    }
    let energy_before = table.validate().unwrap().energy;
    let mut counters = Counters::default();
    for _ in 0..5 {
        deposit_vertices(&table, &params, &[vertex], &mut counters);
    }
    assert_eq!((counters.deposits, counters.refusals, counters.overflowed), (5, 3, 3));
    assert_eq!(counters.energy_refused, 3 * 3 * largest);
    assert_eq!(counters.balance(), 0);
    let cell = table.cell(slot);
    assert_eq!(cell.count, MAX_DEPOSITS);
    assert_eq!(cell.mean_direct(params.quantum()), [8192.0; 3]);
    assert_eq!(table.validate().unwrap().energy - energy_before, counters.energy_stored);
}

/// Without a cell of its own a vertex gets its own value, and that is counted; without a position too.
#[test]
fn fallbacks_return_the_vertex_itself() {
    let params = params(Settings::default());
    let words = storage(64, &params);
    let table = Table::new(&words, &params).unwrap();
    let mut lone = vertex([0.0; 3], Vec3::Z);
    (lone.direct, lone.further) = ([1.0, f32::NAN, 3.0, 9.0], [f32::INFINITY, 5.0, 6.0, 9.0]);
    let mut lost = lone;
    lost.position_footprint[1] = f32::NAN;
    let mut counters = Counters::default();
    estimate_vertices(&table, &params, &[lone, lost], &mut counters, |_, estimate| {
        assert_eq!((estimate.direct, estimate.further), (Vec3::new(1.0, 0.0, 3.0), Vec3::new(0.0, 5.0, 6.0)));
        assert_eq!(estimate.samples, 0);
    });
    assert_eq!((counters.lookups, counters.fallbacks, counters.hits, counters.non_finite), (2, 2, 0, 4));
    deposit_vertices(&table, &params, &[lost], &mut counters);
    assert_eq!((counters.deposits, counters.refusals, counters.probes > 0), (1, 1, true));
    assert_eq!(table.cells().count(), 0);
    assert_eq!((table.head(0) >> 32) as u32, EMPTY);
}

/// What only asks is answered and never feeds the table.
#[test]
fn vertices_that_only_ask_leave_no_trace() {
    let params = params(still());
    let words = storage(64, &params);
    let table = Table::new(&words, &params).unwrap();
    let mut fed = vertex([0.0; 3], Vec3::Z);
    fed.further = [0.5; 4];
    let asks = VertexRecord { flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY, further: [0.0; 4], ..fed };
    let mut counters = Counters::default();
    claim_vertices(&table, &params, &[asks]);
    assert_eq!(table.cells().count(), 0);
    claim_vertices(&table, &params, &[fed, asks]);
    deposit_vertices(&table, &params, &[fed, asks, asks], &mut counters);
    assert_eq!(counters.deposits, 1);
    estimate_vertices(&table, &params, &[asks], &mut counters, |_, estimate| {
        assert_eq!((estimate.further.x, estimate.samples), (0.5, 1));
    });
    assert_eq!((counters.lookups, counters.hits), (1, 1));
}
