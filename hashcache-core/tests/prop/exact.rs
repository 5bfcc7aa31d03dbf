use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use hashcache_core::counters::Counters;
use hashcache_core::exact::{
    CEILING_BITS, CLAMP_BITS, L0_EXPONENT_MAX, L0_EXPONENT_MIN, MAX_DEPOSITS, Outcome, Quantum, add64, carry,
    dequantize, hi, less64, lo, mean, pair, quantize, shl64, sub64,
};
use hashcache_core::hash::pcg;
use proptest::prelude::*;

use crate::{any_float, log_uniform, next_down, next_up};

const CLAMP: u64 = 1 << CLAMP_BITS;
const CEILING: u64 = 1 << CEILING_BITS;

fn quantum() -> impl Strategy<Value = Quantum> {
    prop_oneof![Just(0), L0_EXPONENT_MIN..=L0_EXPONENT_MAX].prop_map(|e| Quantum::new(e).unwrap())
}

/// `x` in quanta. Exact: an f64 holds a float's 24 bits at any exponent in question.
fn in_quanta(q: Quantum, x: f32) -> f64 {
    f64::from(x) * 2.0_f64.powi(20 - q.l0_exponent())
}

proptest! {
    /// Against rounding in f64, which holds every value below the ceiling and its half exactly.
    #[test]
    fn quantize_rounds_to_nearest(q in quantum(), offset in log_uniform(-45..30)) {
        let x = offset * q.l0();
        prop_assume!(x > 0.0 && x.is_finite());
        let v = in_quanta(q, x);
        let rounded = (v + 0.5).floor();
        let got = quantize(q, x);
        if rounded == 0.0 {
            prop_assert_eq!((got.value, got.outcome), (0, Outcome::Underflow));
            prop_assert_eq!(got.lost as f64, (v * 1_048_576.0 + 0.5).floor());
        } else if v <= CLAMP as f64 {
            prop_assert_eq!((got.value as f64, got.lost, got.outcome), (rounded, 0, Outcome::Exact));
        } else if v <= CEILING as f64 {
            prop_assert_eq!((got.value, got.outcome), (CLAMP, Outcome::Clamped));
            prop_assert_eq!((got.value + got.lost) as f64, v);
        } else {
            prop_assert_eq!((got.value, got.lost, got.outcome), (CLAMP, CEILING - CLAMP, Outcome::Saturated));
        }
    }

    #[test]
    fn every_bit_pattern_has_an_outcome(q in quantum(), x in any_float()) {
        let got = quantize(q, x);
        prop_assert!(got.value <= CLAMP && got.value + got.lost <= CEILING);
        let expected = match x {
            x if !x.is_finite() => Some(Outcome::NonFinite),
            0.0 => Some(Outcome::Exact),
            x if x < 0.0 => Some(Outcome::Negative),
            _ => None,
        };
        if let Some(expected) = expected {
            prop_assert_eq!((got.value, got.lost, got.outcome), (0, 0, expected));
        } else {
            prop_assert!(!matches!(got.outcome, Outcome::NonFinite | Outcome::Negative));
        }
    }

    #[test]
    fn larger_values_never_store_less(q in quantum(), x in log_uniform(-120..120)) {
        let (a, b) = (quantize(q, x), quantize(q, next_up(x)));
        prop_assert!(a.value <= b.value);
    }

    /// Scene and unit scaled together give the same words.
    #[test]
    fn scaling_by_a_power_of_two_changes_nothing(x in log_uniform(-30..20), k in -40_i32..40) {
        let (q0, qk) = (Quantum::new(0).unwrap(), Quantum::new(k).unwrap());
        prop_assert_eq!(quantize(q0, x), quantize(qk, x * 2.0_f32.powi(k)));
    }

    #[test]
    fn stored_values_come_back(q in quantum(), x in log_uniform(-3..13)) {
        // 24 bits of a float from 2⁻³·L0 on fit the 20 bits behind the point and those before it.
        let x = (in_quanta(q, x * q.l0()).round() as f32) * q.quantum();
        prop_assert_eq!(dequantize(q, quantize(q, x).value), x);
    }

    /// Against the sum's exact value in an integer of 128 bits.
    #[test]
    fn dequantize_is_the_nearest_float(sum in any::<u64>(), shift in 0_u32..64) {
        let sum = sum >> shift;
        let got = dequantize(Quantum::new(20).unwrap(), sum);
        let distance = |x: f32| (x as u128).abs_diff(u128::from(sum));
        if sum > 0 {
            prop_assert!(distance(got) <= distance(next_up(got)) && distance(got) <= distance(next_down(got)));
        } else {
            prop_assert_eq!(got.to_bits(), 0);
        }
    }

    #[test]
    fn word_pairs_calculate_like_words(a: u64, b: u64, s in 0_u32..64) {
        prop_assert_eq!(pair(lo(a), hi(a)), a);
        let low = lo(a).wrapping_add(lo(b));
        prop_assert_eq!(pair(low, hi(a).wrapping_add(carry(lo(a), b))), a.wrapping_add(b));
        prop_assert_eq!(add64(sub64(a, b), b), a);
        prop_assert_eq!(less64(a, b), a < b);
        prop_assert_eq!(shl64(a, s), a << s);
    }

    /// Whatever was offered, stored or refused: the balance is 0 and no count is missing.
    #[test]
    fn energy_balances(deposits in prop::collection::vec((any_float(), any::<bool>()), 0..200), q in quantum()) {
        let mut halves = [Counters::default(); 2];
        let mut cells = 0_u64;
        for (i, (x, stored)) in deposits.iter().enumerate() {
            let deposit = quantize(q, *x);
            cells += if *stored { deposit.value } else { 0 };
            halves[i % 2].note(&deposit, *stored);
        }
        let all = halves[0].merge(&halves[1]);
        prop_assert_eq!(all.balance(), 0);
        prop_assert_eq!(all.energy_stored, cells);
        let odd = deposits.iter().filter(|(x, _)| !x.is_finite() || *x < 0.0).count() as u64;
        prop_assert_eq!(all.non_finite + all.negative, odd);
        prop_assert_eq!(Counters::from_words(all.words()), all);
    }
}

/// The largest sum a cell can hold fits, and is still a finite float for every L0.
#[test]
fn the_largest_sum_fits() {
    let sum = CLAMP.checked_mul(u64::from(MAX_DEPOSITS)).unwrap();
    for e in [L0_EXPONENT_MIN, 0, L0_EXPONENT_MAX] {
        let q = Quantum::new(e).unwrap();
        assert!(dequantize(q, sum).is_finite());
        assert_eq!(mean(q, sum, MAX_DEPOSITS), q.clamp());
        assert_eq!(mean(q, 1, 1), q.quantum());
        assert!(q.quantum() >= f32::MIN_POSITIVE);
    }
    assert_eq!(mean(Quantum::new(0).unwrap(), 5, 0), 0.0);
}

#[test]
fn scales_outside_the_range_are_refused_or_brought_in() {
    assert!(Quantum::new(L0_EXPONENT_MIN - 1).is_err());
    assert!(Quantum::new(L0_EXPONENT_MAX + 1).is_err());
    assert_eq!(Quantum::for_scale(f32::MAX).l0_exponent(), L0_EXPONENT_MAX);
    assert_eq!(Quantum::for_scale(f32::from_bits(1)).l0_exponent(), L0_EXPONENT_MIN);
    for odd in [0.0, -5.0, f32::NAN, f32::INFINITY] {
        assert_eq!(Quantum::for_scale(odd).l0(), 1.0);
    }
}

/// 10⁹ deposits of a million values from 2⁻⁴⁰ to 2⁴⁰ quanta: the sum is exactly that of integers of 128 bits, and
/// rounding to quanta moved each deposit by half a quantum at most.
#[test]
fn a_billion_deposits_sum_exactly() {
    const VALUES: u32 = 1_000_000;
    const REPEATS: u64 = 1_000;
    let q = Quantum::new(3).unwrap();
    let (mut sum, mut model, mut clamped_sum) = (0_u64, 0_u128, 0.0_f64);
    for i in 0..VALUES {
        let h = pcg(i);
        let x = (1.0 + (h >> 9) as f32 / 8_388_608.0) * 2.0_f32.powi((h % 81) as i32 - 57);
        let deposit = quantize(q, x);
        model += u128::from(deposit.value) * u128::from(REPEATS);
        clamped_sum += in_quanta(q, x).min(CLAMP as f64) * REPEATS as f64;
        for _ in 0..REPEATS {
            sum = add64(sum, deposit.value);
        }
    }
    assert_eq!(u128::from(sum), model);
    let half_a_quantum_each = 0.5 * f64::from(VALUES) * REPEATS as f64;
    assert!((sum as f64 - clamped_sum).abs() <= half_a_quantum_each + clamped_sum * 1e-12);
}

/// Two threads on a pair of 32-bit atomics that wraps many times.
#[test]
fn carries_survive_threads() {
    let (low, high) = (AtomicU32::new(0), AtomicU32::new(0));
    let add = |v: u64| {
        let old = low.fetch_add(lo(v), Relaxed);
        high.fetch_add(carry(old, v), Relaxed);
    };
    let value = |i: u32| u64::from(pcg(i)) << (i % 12);
    let count = 200_000;
    std::thread::scope(|scope| {
        for part in 0..2 {
            let add = &add;
            scope.spawn(move || (0..count).filter(|i| i % 2 == part).for_each(|i| add(value(i))));
        }
    });
    let expected = (0..count).map(value).fold(0_u64, u64::wrapping_add);
    assert_eq!(pair(low.into_inner(), high.into_inner()), expected);
}
