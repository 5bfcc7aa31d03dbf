//! The rules over time, beside a model in f64: steps, steady states, whole tables, energy, threads.

use std::thread;

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::exact::{MAX_DEPOSITS, Quantum};
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg, pcg2d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::layout::{Complete, Lasting, Layout, Measured};
use hashgrid::merge::{Merge, Merged};
use hashgrid::names::{Naming, name_vertices};
use hashgrid::sums::Sums;
use hashgrid::temporal::{Adaptive, Change, FixedCount, Integrate, MovingAverage, Rule, change_vertices, fade_cells};
use hashgrid::vertex::{claim_vertices, deposit_vertices};
use hashgrid::{Params, Settings, Table, Word};

fn storage<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(7)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

fn bits(words: &[Word]) -> Vec<u64> {
    words.iter().map(|word| word.load(std::sync::atomic::Ordering::Relaxed)).collect()
}

/// `n` deposits of one light.
fn frame(light: f64, n: u32) -> Sums {
    let quanta = (light * f64::from(1 << 20)).round() as u64;
    let one = Sums::of(&[quanta, quanta, quanta, 0, 0, quanta / 2]);
    (0..n).fold(Sums::default(), |sum, _| sum.plus(&one))
}

/// What the paper's formulas say, in f64: mean and weight after a frame.
type Model<'a> = &'a dyn Fn(f64, f64) -> f64;

/// Runs `frames` through a rule and through mean ← α·mean + (1 − α)·new; `alpha(old, new)`. The counts of the model are
/// real numbers, those of the rule whole ones.
fn compare(rule: &impl Rule, alpha: Model, frames: impl Iterator<Item = (f64, u32)>, tolerance: f64) -> Vec<f64> {
    let q = Quantum::new(0).unwrap();
    let (mut sums, mut mean, mut count) = (Sums::default(), 0.0, 0.0);
    let mut course = vec![];
    for (i, (light, n)) in frames.enumerate() {
        sums = rule.blend(&sums, &frame(light, n), Change::default());
        let a = alpha(count, f64::from(n));
        (mean, count) = (a * mean + (1.0 - a) * light, f64::from(n) / (1.0 - a));
        let found = f64::from(sums.mean_direct(q)[0]);
        assert!((found - mean).abs() <= tolerance, "frame {i}: {found}, {mean} expected");
        assert!((f64::from(sums.count) - count).abs() <= 1.0, "frame {i}: {} deposits, {count} expected", sums.count);
        course.push(found);
    }
    course
}

/// Light of 1 for 100 frames, then of 4, with 16 deposits a frame.
fn step() -> impl Iterator<Item = (f64, u32)> {
    (0..200).map(|i| (if i < 100 { 1.0 } else { 4.0 }, 16))
}

/// Rounding: a mean may be off by half a quantum for each deposit that its history has.
const ROUNDING: f64 = 2e-6;

#[test]
fn integration_weighs_all_frames_alike() {
    let course = compare(&Integrate, &|old, new| old / (old + new), step(), ROUNDING);
    assert!((course[199] - 2.5).abs() < ROUNDING);
}

#[test]
fn a_fixed_count_integrates_and_then_fades() {
    for most in [0, 16, 240, 1000] {
        let alpha = |old: f64, new: f64| old.min(f64::from(most)) / (old.min(f64::from(most)) + new);
        let course = compare(&FixedCount { most }, &alpha, step(), ROUNDING);
        assert!((course[99] - 1.0).abs() < ROUNDING, "steady");
        // After a step what is left of the difference is α a frame.
        let alpha = f64::from(most) / (f64::from(most) + 16.0);
        let left = (4.0 - course[109]) / 3.0;
        assert!((left - alpha.powi(10)).abs() < 1e-5, "{most}: {left}");
    }
}

/// One table that is faded before each frame holds what the rule makes of two, whoever fades which part.
#[test]
fn fading_is_the_fixed_count_in_place() {
    let params = Params::new(&Settings::default()).unwrap();
    for most in [0, 1, 40, 1_000_000] {
        let words = storage::<Measured>(64, &params);
        let table = Table::<Measured>::with_layout(&words, &params).unwrap();
        let mut expected = Sums::default();
        for (light, n) in step().take(120) {
            let vertex = VertexRecord {
                direct: [light as f32; 4],
                normal: octahedral_encode(Vec3::Y),
                flags: VertexRecord::VALID,
                ..Zeroable::zeroed()
            };
            thread::scope(|scope| {
                for part in [0..7, 7..64] {
                    scope.spawn(|| fade_cells(&table, part, most));
                }
            });
            let vertices = vec![vertex; n as usize];
            claim_vertices(&table, &params, &vertices);
            deposit_vertices(&table, &params, &vertices, &mut Counters::default());
            let slot = (0..64).find(|slot| table.sums(*slot).count > 0).expect("a cell");
            let fresh = table.sums(slot).minus(&expected.part(expected.count.min(most)));
            assert_eq!(fresh.count, n);
            expected = FixedCount { most }.blend(&expected, &fresh, Change::default());
            assert_eq!(table.sums(slot), expected);
            assert!(expected.count <= most.saturating_add(n));
        }
        let mean = expected.mean_direct(params.quantum())[0];
        let left = (f64::from(most) / (f64::from(most) + 16.0)).powi(20);
        let expected = if most < 1_000_000 { 4.0 - 3.0 * left } else { 1.5 };
        assert!((f64::from(mean) - expected).abs() < 1e-4, "{most}: {mean}, {expected} expected");
    }
}

#[test]
fn a_moving_average_fades_by_alpha_whatever_the_count() {
    for alpha in [0.0_f32, 0.5, 0.75, 0.9375] {
        let rule = MovingAverage::new(alpha).unwrap();
        let alpha = f64::from(alpha);
        let model = |old: f64, new: f64| {
            let wanted = new * alpha / (1.0 - alpha);
            wanted.min(old) / (wanted.min(old) + new)
        };
        // Counts that jump: one α for all. 15/16 of 16 is the finest.
        let frames = step().enumerate().map(|(i, (light, _))| (light, 16 << (pcg(i as u32) % 4)));
        let frames: Vec<_> = frames.collect();
        let course = compare(&rule, &model, frames.iter().copied(), 3e-6);
        // In the steady state the window is full unless the counts have just jumped up.
        let fades = (101..200).filter(|i| ((4.0 - course[*i]) - alpha * (4.0 - course[i - 1])).abs() < 1e-5).count();
        assert!(fades > 40, "α {alpha}: {fades} frames of 99 fade by α");
    }
    assert!(MovingAverage::new(1.0).is_err() && MovingAverage::new(f32::NAN).is_err());
    // A frame without light leaves what there is.
    let kept = MovingAverage::new(0.5).unwrap().blend(&frame(1.0, 9), &Sums::default(), Change::default());
    assert_eq!(kept, frame(1.0, 9));
}

/// Blended as in the paper: α from old/(old + new) down to 0, linear in the share of changed light.
#[test]
fn the_adaptive_rule_blends_between_both() {
    let q = Quantum::new(0).unwrap();
    for (share, gain) in [(0.0, 1), (0.125, 1), (0.5, 1), (0.5, 2), (1.0, 1), (0.25, 100)] {
        let change = Change { difference: (share * 1e6) as u64, magnitude: 1_000_000 };
        let rule = Adaptive { gain, most: MAX_DEPOSITS };
        let lambda = (share * f64::from(gain)).min(1.0);
        for (old, new) in [(1000, 16), (16, 1000), (1, 1), (1 << 29, 1 << 10), (50, 0)] {
            let (a, b) = (frame(1.0, old.min(5000)), frame(3.0, new.min(5000)));
            let (a, b) =
                (Sums { count: old, light: a.light.map(|v| v / u64::from(a.count.max(1)) * u64::from(old)), ..a }, b);
            let blend = rule.blend(&a, &b, change);
            let (old, new) = (f64::from(old), f64::from(b.count));
            if new == 0.0 {
                assert!((f64::from(blend.count) - (1.0 - lambda) * old).abs() <= 0.5);
                continue;
            }
            let alpha = (1.0 - lambda) * old / (old + new);
            let expected = alpha + (1.0 - alpha) * 3.0;
            let found = f64::from(blend.mean_direct(q)[0]);
            // Half a deposit, and the share's 16 bits.
            let tolerance = 2.0 * 0.5 / f64::from(blend.count) + 1e-4;
            assert!((found - expected).abs() < tolerance, "λ {lambda}, {old} + {new}: {found}, {expected} expected");
        }
    }
    // Nothing known is nothing changed; all changed leaves the frame alone.
    let rule = Adaptive { gain: 1, most: 100 };
    assert_eq!(rule.weight(1000, 5, Change::default()), 100);
    assert_eq!(rule.weight(1000, 5, Change::of(256, 0)), 0);
    assert_eq!(Change::of(7, 7).share(), 0);
    assert_eq!(Change { difference: u64::MAX, magnitude: u64::MAX }.share(), 65_536);
    assert_eq!(Change { difference: u64::MAX >> 1, magnitude: u64::MAX }.share(), 32_767);
}

/// Steady noisy light: the mean of every rule is that of the light, and its spread is what the weights say.
#[test]
fn steady_states_are_unbiased() {
    let q = Quantum::new(0).unwrap();
    let check = |name: &str, rule: &dyn Fn(&Sums, &Sums) -> Sums, effective: f64| {
        let (mut sums, mut all) = (Sums::default(), vec![]);
        for i in 0..4000_u32 {
            let new = (0..4_u32).fold(Sums::default(), |sum, k| {
                let light = f64::from(to_unit_f32(pcg2d([i, k])[0]));
                sum.plus(&frame(light, 1))
            });
            sums = rule(&sums, &new);
            if i >= 200 {
                all.push(f64::from(sums.mean_direct(q)[0]));
            }
        }
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / all.len() as f64;
        // 15 200 uniform numbers have a mean within 0.0024 of 1/2 by one standard deviation.
        assert!((mean - 0.5).abs() < 0.01, "{name}: {mean}");
        let expected = 1.0 / 12.0 / effective;
        assert!((variance / expected).ln().abs() < 0.5, "{name}: {variance}, {expected} expected");
    };
    let none = Change::default();
    // An average of α = c/(c + n) is worth n·(1 + α)/(1 − α) = 2c + n deposits.
    check("fixed", &|old, new| FixedCount { most: 36 }.blend(old, new, none), 76.0);
    let average = MovingAverage::new(0.9).unwrap();
    check("average", &|old, new| average.blend(old, new, none), 76.0);
    check("nothing kept", &|old, new| FixedCount { most: 0 }.blend(old, new, none), 4.0);
}

/// The bound of deposits holds for every rule, and the mean stays.
#[test]
fn the_bound_of_deposits_holds() {
    let full = Sums { count: MAX_DEPOSITS, light: [1_u64 << 63; 6], squares: 0 };
    let new = Sums { count: 1000, light: [1000 << 33; 6], squares: 0 };
    let blend = Integrate.blend(&full, &new, Change::default());
    assert_eq!((blend.count, blend.light), (MAX_DEPOSITS, [1_u64 << 63; 6]));
}

/// Vertices of a wall whose right half is lit by a lamp of brightness `lamp`.
fn wall(count: u32, seed: u32, lamp: f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let [a, b] = pcg2d([i, seed]).map(to_unit_f32);
            VertexRecord {
                position_footprint: [4.0 * a, 4.0 * b, 0.0, 0.03],
                direct: if a > 0.5 { [lamp, 0.5 * lamp, 0.0, 0.0] } else { [0.0; 4] },
                further: [0.25; 4],
                normal: octahedral_encode(Vec3::Z),
                direction: octahedral_encode(Vec3::NEG_Z),
                seed: i ^ seed,
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

/// Claims, names and deposits on one thread.
fn fill<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) {
    claim_vertices(table, params, vertices);
    name_vertices(table, params, vertices, Naming::First);
    name_vertices(table, params, vertices, Naming::Second);
    deposit_vertices(table, params, vertices, &mut Counters::default());
}

/// Merges frames into a lasting table by any number of threads; returns its words, and checks the energy each time.
fn merge_frames<L: Layout>(cells: usize, rule: &(impl Rule + Sync), threads: u32) -> Vec<u64> {
    let params = Params::new(&Settings { base_size: 1.0 / 32.0, max_probes: 16, ..Settings::default() }).unwrap();
    let (lasting_words, frame_words) = (storage::<L>(cells, &params), storage::<L>(cells, &params));
    let lasting = Table::<L>::with_layout(&lasting_words, &params).unwrap();
    let frame = Table::<L>::with_layout(&frame_words, &params).unwrap();
    let mut all = Merged::default();
    for index in 0..6 {
        frame.clear();
        fill(&frame, &params, &wall(3000, index, 1.0 + index as f32));
        let before = lasting.validate().expect("valid").energy;
        let merge = Merge::new(&lasting, &frame).unwrap();
        let part = merge.slots().div_ceil(threads);
        let run = |step: &(dyn Fn(std::ops::Range<u32>) -> Merged + Sync)| -> Merged {
            thread::scope(|scope| {
                let tasks: Vec<_> = (0..threads)
                    .map(|t| scope.spawn(move || step(t * part..((t + 1) * part).min(merge.slots()))))
                    .collect();
                tasks.into_iter().fold(Merged::default(), |sum, task| sum.plus(&task.join().unwrap()))
            })
        };
        run(&|slots| {
            merge.claim(slots);
            Merged::default()
        });
        for step in [Naming::First, Naming::Second] {
            run(&|slots| {
                merge.name(slots, step);
                Merged::default()
            });
        }
        let merged = run(&|slots| merge.add(slots, rule, index));
        let after = lasting.validate().expect("valid").energy;
        assert_eq!(after, before.wrapping_add(merged.energy_added).wrapping_sub(merged.energy_faded));
        let offered = frame.validate().expect("valid").energy;
        assert_eq!(offered, merged.energy_added + merged.energy_refused);
        all = all.plus(&merged);
    }
    assert_eq!(all.refused > 0, cells == 64, "{all:?}");
    bits(&lasting_words)
}

#[test]
fn merges_keep_the_energy_for_any_number_of_threads() {
    for cells in [64, 4096] {
        let one = merge_frames::<Measured>(cells, &FixedCount { most: 20 }, 1);
        assert!(one == merge_frames::<Measured>(cells, &FixedCount { most: 20 }, 3));
        let one = merge_frames::<Lasting>(cells, &MovingAverage::new(0.8).unwrap(), 1);
        assert!(one == merge_frames::<Lasting>(cells, &MovingAverage::new(0.8).unwrap(), 4));
    }
}

/// Integration by merging is what depositing everything into one table gives, to the last bit.
#[test]
fn integrating_frames_is_one_long_frame() {
    let params = Params::new(&Settings { base_size: 1.0 / 32.0, ..Settings::default() }).unwrap();
    let words: Vec<_> = (0..3).map(|_| storage::<Measured>(4096, &params)).collect();
    let [whole, lasting, frame] = [0, 1, 2].map(|k| Table::<Measured>::with_layout(&words[k], &params).unwrap());
    for index in 0..5 {
        let vertices = wall(2000, index, 3.0);
        fill(&whole, &params, &vertices);
        frame.clear();
        fill(&frame, &params, &vertices);
        assert_eq!(Merge::new(&lasting, &frame).unwrap().all(&Integrate, index).refused, 0);
    }
    for cell in whole.cells() {
        let home = cell.home(whole.capacity());
        let found = lasting.find_at(home, hashgrid::tag::tag_fingerprint(cell.tag)).slot.expect("the key");
        assert_eq!(whole.sums(cell.slot), lasting.sums(found));
    }
    assert_eq!(whole.cells().count(), lasting.cells().count());
}

/// A lamp that goes out: re-evaluated paths wipe the cells that it lit and leave the others.
#[test]
fn changes_wipe_what_changed() {
    let params = Params::new(&Settings { base_size: 1.0 / 32.0, jitter: 0.0, ..Settings::default() }).unwrap();
    let words: Vec<_> = (0..2).map(|_| storage::<Complete>(4096, &params)).collect();
    let [lasting, frame] = [0, 1].map(|k| Table::<Complete>::with_layout(&words[k], &params).unwrap());
    let rule = Adaptive { gain: 4, most: MAX_DEPOSITS };
    for index in 0..20 {
        let lamp = if index < 19 { 8.0 } else { 0.0 };
        let (vertices, before) = (wall(4000, 3, lamp), wall(4000, 3, 8.0));
        frame.clear();
        claim_vertices(&frame, &params, &vertices);
        name_vertices(&frame, &params, &vertices, Naming::First);
        name_vertices(&frame, &params, &vertices, Naming::Second);
        let mut counters = Counters::default();
        deposit_vertices(&frame, &params, &vertices, &mut counters);
        // Every other path is traced again.
        let pick = |all: &[VertexRecord]| all.iter().step_by(2).copied().collect::<Vec<_>>();
        change_vertices(&frame, &params, &pick(&before), &pick(&vertices), &mut counters);
        assert_eq!(counters.refusals, 0);
        Merge::new(&lasting, &frame).unwrap().all(&rule, index);
    }
    let (mut dark, mut kept, mut stale) = (0, 0, 0);
    for cell in lasting.cells() {
        let key = lasting.key(cell.slot).expect("a name");
        let lit = key.corner(&params)[0] >= 2.0;
        let mean = cell.mean_direct(params.quantum())[0];
        dark += u32::from(lit && mean == 0.0);
        stale += u32::from(lit && mean > 0.0);
        kept += u32::from(!lit && cell.count > 10);
        assert_eq!(lasting.stamp(cell.slot), 19);
    }
    // Cells where none of the re-evaluated paths went keep 19 twentieths of their light.
    assert!(dark > 4 * stale && dark > 100 && kept > 100, "{dark} dark, {stale} stale, {kept} kept");
}
