use std::thread;

use hashcache_core::counters::Counters;
use hashcache_core::exact::{MAX_DEPOSITS, Quantum, quantize};
use hashgrid::layout::{Complete, Lasting, Layout, Measured, Minimal, Standard};
use hashgrid::sums::{Sums, luminance};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_slots, estimate_vertices};

use super::*;

/// Storage of `cells` empty cells of a layout.
pub fn storage_of<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(0xdead_beef)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

/// What the documentation promises.
#[test]
fn every_option_has_its_bytes() {
    assert_eq!(
        [Minimal::BYTES, Standard::BYTES, Measured::BYTES, Lasting::BYTES, Complete::BYTES],
        [32, 64, 72, 80, 112]
    );
    assert_eq!(CELL_WORDS, 8);
}

/// A wall of vertices with bright spots, one cell wide in `x`.
fn wall(count: u32, shine: f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let r = pcg4d([i, 77, 0, 0]).map(to_unit_f32);
            let mut one = vertex([(i % 30) as f32 / 100.0, 0.0, 0.0], Vec3::Z);
            let spike = if i % 50 == 0 { 30.0 } else { 1.0 };
            (one.direct, one.further) = ([shine * r[0] * spike, shine * r[1], 0.0, 0.0], [shine * r[2]; 4]);
            one.seed = i;
            one
        })
        .collect()
}

/// Means of one sum are the means of two, added; tags are the same.
#[test]
fn a_joined_sum_holds_what_two_hold() {
    let params = params(Settings { base_size: 1.0 / 32.0, ..Settings::default() });
    let vertices = wall(5000, 0.7);
    let (split, joined) = (storage(256, &params), storage_of::<Minimal>(256, &params));
    let (split, joined) =
        (Table::new(&split, &params).unwrap(), Table::<Minimal>::with_layout(&joined, &params).unwrap());
    let mut counters = [Counters::default(); 2];
    claim_vertices(&split, &params, &vertices);
    claim_vertices(&joined, &params, &vertices);
    deposit_vertices(&split, &params, &vertices, &mut counters[0]);
    deposit_vertices(&joined, &params, &vertices, &mut counters[1]);
    assert_eq!(counters[1].balance(), 0);
    assert_eq!(joined.validate().unwrap().energy, counters[1].energy_stored);
    let (mut a, mut b) = (vec![], vec![]);
    estimate_vertices(&split, &params, &vertices, &mut counters[0], |_, estimate| a.push(estimate));
    estimate_vertices(&joined, &params, &vertices, &mut counters[1], |_, estimate| b.push(estimate));
    for (two, one) in a.iter().zip(&b) {
        assert_eq!((two.samples, one.direct), (one.samples, Vec3::ZERO));
        let whole = two.direct + two.further;
        // Each deposit is rounded to half a quantum, 2⁻²¹, twice or once.
        assert!((whole - one.further).abs().max_element() < 3.0 * 2.0_f32.powi(-21) + 1e-6 * whole.max_element());
    }
    assert_eq!((counters[0].hits, counters[0].probes), (counters[1].hits, counters[1].probes));
}

/// Mean and standard error of luminance in f64.
fn model(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The standard error of every cell is that of an f64 model, for radiance from 2⁻⁴⁰ to 2⁴⁰ and any number of threads.
#[test]
fn standard_errors_follow_the_model() {
    for exponent in [-40, -13, 0, 7, 40] {
        let shine = 2.0_f32.powi(exponent);
        let quantum = Quantum::for_scale(shine / 64.0);
        let params = params(Settings { base_size: 1.0 / 32.0, quantum, ..Settings::default() });
        let vertices = wall(3000, shine);
        let mut tables = vec![];
        for threads in [1, 3] {
            let words = storage_of::<Measured>(256, &params);
            let table = Table::<Measured>::with_layout(&words, &params).unwrap();
            claim_vertices(&table, &params, &vertices);
            thread::scope(|scope| {
                for part in vertices.chunks(vertices.len().div_ceil(threads)) {
                    scope.spawn(|| deposit_vertices(&table, &params, part, &mut Counters::default()));
                }
            });
            table.validate().expect("a valid table");
            tables.push(bits(&words));
            for cell in table.cells() {
                let own = |vertex: &&VertexRecord| {
                    let key = hashgrid::key::key(&params, vertex, hashgrid::jitter::SALT_DEPOSIT);
                    table.find(&key.unwrap()).slot == Some(cell.slot)
                };
                let light = |v: &VertexRecord| {
                    (0..3).map(|k| [54.0, 183.0, 19.0][k] / 256.0 * f64::from(v.direct[k] + v.further[k])).sum::<f64>()
                };
                let values: Vec<f64> = vertices.iter().filter(own).map(light).collect();
                let sums = table.sums(cell.slot);
                assert_eq!(sums.count as usize, values.len());
                if values.len() < 2 {
                    assert_eq!(sums.standard_error(quantum), None);
                    continue;
                }
                let (mean, error) = model(&values);
                let found = (sums.mean_luminance(quantum), sums.standard_error(quantum).unwrap());
                assert!((f64::from(found.0) / mean - 1.0).abs() < 1e-6, "{mean} {found:?}");
                // A value is rounded to 2⁻²⁰·L0, and the smallest deviations here are 2⁻⁸ of the values.
                assert!((f64::from(found.1) / error - 1.0).abs() < 1e-4, "{error} {found:?}");
            }
        }
        assert!(tables[0] == tables[1]);
    }
}

/// Equal deposits have no error at all, whatever they are; and the largest ones, 2³⁰ times, still do not overflow.
#[test]
fn squares_are_exact_up_to_the_last_deposit() {
    let q = Quantum::new(0).unwrap();
    let values = [8192.0, 0.3, 7.7, 8192.0, 1e-6, 1.0].map(|v| quantize(q, v).value);
    let largest = [1_u64 << 33; 6];
    for values in [values, largest] {
        let y = u128::from(luminance(&values));
        let full = Sums {
            count: MAX_DEPOSITS,
            light: values.map(|v| v * u64::from(MAX_DEPOSITS)),
            squares: y * y * u128::from(MAX_DEPOSITS),
        };
        assert_eq!(full.standard_error(q), Some(0.0));
        assert_eq!(full.part(1000).standard_error(q), Some(0.0));
        assert_eq!(full.part(MAX_DEPOSITS / 3).part(1), Sums::of(&values));
        // One deposit of another value shows.
        let other = full.minus(&Sums::of(&values)).plus(&Sums::of(&[0; 6]));
        let mean = f64::from(other.mean_luminance(q));
        let expected = mean / f64::from(MAX_DEPOSITS);
        assert!((f64::from(other.standard_error(q).unwrap()) / expected - 1.0).abs() < 1e-5, "{other:?}");
    }
}

/// Energy and errors of vertices in a small table of a layout.
fn check<L: Layout>(params: &Params, vertices: &[VertexRecord]) -> Result<(), TestCaseError> {
    let words = storage_of::<L>(64, params);
    let table = Table::<L>::with_layout(&words, params).unwrap();
    let mut counters = Counters::default();
    claim_vertices(&table, params, vertices);
    deposit_vertices(&table, params, vertices, &mut counters);
    let summary = table.validate().unwrap();
    prop_assert_eq!((counters.balance(), summary.energy), (0, counters.energy_stored));
    let mut fine = true;
    estimate_slots(&table, params, vertices, &mut counters, |_, estimate, slot| {
        let error = slot.and_then(|slot| table.sums(slot).standard_error(params.quantum()));
        fine &= estimate.direct.is_finite() && estimate.further.is_finite();
        fine &= error.unwrap_or(0.0).is_finite() && slot.is_some() == (estimate.samples > 0);
    });
    prop_assert!(fine);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// A part has the mean of the whole to half a quantum, and what remains makes up the rest exactly.
    #[test]
    fn parts_keep_means_and_energy(
        light in prop::array::uniform6(0_u64..1 << 33),
        count in 1_u32..=MAX_DEPOSITS,
        share in 0.0_f64..=1.0,
    ) {
        let one = Sums::of(&light);
        let whole = Sums { count, light: light.map(|v| v * u64::from(count)), squares: one.squares * u128::from(count) };
        let part = whole.part((share * f64::from(count)) as u32);
        let rest = whole.minus(&part);
        prop_assert_eq!(rest.plus(&part), whole);
        prop_assert_eq!(rest.energy().wrapping_add(part.energy()), whole.energy());
        for (sum, value) in part.light.iter().zip(light) {
            prop_assert_eq!(*sum, value * u64::from(part.count));
        }
        prop_assert_eq!(part.squares, one.squares * u128::from(part.count));
    }

    /// Whatever is deposited: every layout keeps the energy, and every error is finite.
    #[test]
    fn layouts_lose_no_energy(
        vertices in prop::collection::vec(any_vertex(), 1..200),
        e in -100_i32..=80,
    ) {
        let params = params(Settings { quantum: Quantum::new(e).unwrap(), ..Settings::default() });
        check::<Standard>(&params, &vertices)?;
        check::<Minimal>(&params, &vertices)?;
        check::<Measured>(&params, &vertices)?;
    }
}
