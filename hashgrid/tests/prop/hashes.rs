use hashgrid::Key;
use hashgrid::key::{fingerprint, home};

use super::*;

/// Keys as scenes have them: a slab of cells, on two levels, with three bins of normals. All different.
fn keys(count: u32) -> impl Iterator<Item = Key> {
    (0..count).map(|i| {
        let (x, y, z) = (i & 255, (i >> 8) & 255, (i >> 16) & 3);
        let cell = [x as i32 - 128, y as i32 - 128, z as i32];
        let (level, bin) = (4 + ((i >> 18) & 1), 4 + 9 * (i >> 19));
        Key { cell, attributes: level | (bin << 8) }
    })
}

/// Pairs of equal numbers.
fn equal_pairs(mut values: Vec<u64>) -> u64 {
    values.sort_unstable();
    values.chunk_by(|a, b| a == b).map(|run| run.len() as u64 * (run.len() as u64 - 1) / 2).sum()
}

/// Fingerprints, homes, and both together collide as often as random numbers do: the false matches of a table are within
/// twice the theory. (5 standard deviations are allowed beside the factor.)
#[test]
fn false_matches_are_as_rare_as_theory_says() {
    const COUNT: u32 = 1 << 20;
    let pairs = f64::from(COUNT) * f64::from(COUNT) / 2.0;
    let check = |name: &str, range: f64, values: Vec<u64>| {
        let (found, expected) = (equal_pairs(values) as f64, pairs / range);
        assert!(found <= 2.0 * expected + 5.0 * expected.sqrt(), "{name}: {found} pairs, {expected} expected");
        assert!(found >= expected / 2.0 - 5.0 * expected.sqrt(), "{name}: {found} pairs, {expected} expected");
    };
    let of = |f: &dyn Fn(&Key) -> u64| keys(COUNT).map(|key| f(&key)).collect::<Vec<_>>();
    check("fingerprint", 2.0_f64.powi(25), of(&|key| u64::from(fingerprint(key))));
    check("home of 2^24", 2.0_f64.powi(24), of(&|key| u64::from(home(key) & 0x00ff_ffff)));
    check("whole home", 2.0_f64.powi(32), of(&|key| u64::from(home(key))));
    let both =
        |bits: u32| move |key: &Key| (u64::from(home(key) & ((1 << bits) - 1)) << 32) | u64::from(fingerprint(key));
    check("home of 2^8 and fingerprint", 2.0_f64.powi(33), of(&both(8)));
    check("home of 2^12 and fingerprint", 2.0_f64.powi(37), of(&both(12)));
    assert_eq!(equal_pairs(of(&both(24))), 0, "1/64 expected");
}

/// Slots of a small table are hit evenly (chi-squared, 1023 degrees of freedom, 6 standard deviations).
#[test]
fn homes_are_even() {
    let mut counts = [0_u32; 1024];
    for key in keys(1 << 20) {
        counts[(home(&key) & 1023) as usize] += 1;
    }
    let chi: f64 = counts.iter().map(|c| (f64::from(*c) - 1024.0).powi(2) / 1024.0).sum();
    assert!((chi - 1023.0).abs() < 6.0 * (2.0_f64 * 1023.0).sqrt(), "{chi}");
}

/// Each part of the key tells cells apart: level and bin are hashed, too.
#[test]
fn every_part_of_the_key_counts() {
    let key = Key { cell: [1, 2, 3], attributes: 5 | (7 << 8) };
    let mut others = vec![];
    for k in 0..3 {
        let mut other = key;
        other.cell[k] += 1;
        others.push(other);
    }
    others.push(Key { attributes: 6 | (7 << 8), ..key });
    others.push(Key { attributes: 5 | (8 << 8), ..key });
    others.push(Key { cell: [2, 1, 3], ..key });
    for other in others {
        assert_ne!((home(&key), fingerprint(&key)), (home(&other), fingerprint(&other)), "{other:?}");
        assert_ne!(home(&key), home(&other), "{other:?}");
        assert_ne!(fingerprint(&key), fingerprint(&other), "{other:?}");
    }
}

proptest! {
    #[test]
    fn fingerprints_leave_all_ones_to_the_empty(cell: [i32; 3], attributes: u32) {
        let key = Key { cell, attributes };
        prop_assert!(fingerprint(&key) < (1 << 25) - 1);
    }
}
