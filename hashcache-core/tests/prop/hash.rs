use hashcache_core::hash::{LCG_INCREMENT, LCG_MULTIPLIER, finish, mix, pcg, pcg2d, pcg3d, pcg4d, to_unit_f32};
use proptest::prelude::*;

/// The multiplicative inverse of an odd number modulo 2³² (Newton's iteration doubles the right bits).
fn inverse(a: u32) -> u32 {
    let mut x = a;
    for _ in 0..5 {
        x = x.wrapping_mul(2_u32.wrapping_sub(a.wrapping_mul(x)));
    }
    assert_eq!(a.wrapping_mul(x), 1);
    x
}

/// Undoes `v ^= v >> s`.
fn unshift(v: u32, s: u32) -> u32 {
    let mut x = v;
    for _ in 0..32 / s {
        x = v ^ (x >> s);
    }
    x
}

fn unlcg(v: u32) -> u32 {
    v.wrapping_sub(LCG_INCREMENT).wrapping_mul(inverse(LCG_MULTIPLIER))
}

fn msub(a: u32, b: u32, c: u32) -> u32 {
    a.wrapping_sub(b.wrapping_mul(c))
}

proptest! {
    /// An inverse exists and returns the argument: no two arguments share a hash.
    #[test]
    fn pcg_is_a_bijection(v: u32) {
        let word = unshift(pcg(v), 22).wrapping_mul(inverse(277_803_737));
        let state = unshift(word, (word >> 28) + 4);
        prop_assert_eq!(state.wrapping_sub(2_891_336_453).wrapping_mul(inverse(747_796_405)), v);
    }

    #[test]
    fn pcg2d_is_a_bijection(v: [u32; 2]) {
        let [mut x, mut y] = pcg2d(v);
        for _ in 0..2 {
            (x, y) = (unshift(x, 16), unshift(y, 16));
            y = msub(y, x, LCG_MULTIPLIER);
            x = msub(x, y, LCG_MULTIPLIER);
        }
        prop_assert_eq!([unlcg(x), unlcg(y)], v);
    }

    #[test]
    fn pcg3d_is_a_bijection(v: [u32; 3]) {
        let [mut x, mut y, mut z] = pcg3d(v);
        for round in 0..2 {
            z = msub(z, x, y);
            y = msub(y, z, x);
            x = msub(x, y, z);
            if round == 0 {
                (x, y, z) = (unshift(x, 16), unshift(y, 16), unshift(z, 16));
            }
        }
        prop_assert_eq!([unlcg(x), unlcg(y), unlcg(z)], v);
    }

    #[test]
    fn pcg4d_is_a_bijection(v: [u32; 4]) {
        let [mut x, mut y, mut z, mut w] = pcg4d(v);
        for round in 0..2 {
            w = msub(w, y, z);
            z = msub(z, x, y);
            y = msub(y, z, x);
            x = msub(x, y, w);
            if round == 0 {
                (x, y, z, w) = (unshift(x, 16), unshift(y, 16), unshift(z, 16), unshift(w, 16));
            }
        }
        prop_assert_eq!([unlcg(x), unlcg(y), unlcg(z), unlcg(w)], v);
    }

    #[test]
    fn mix_and_finish_are_bijections(h: u32, v: u32) {
        let turned = mix(h, v).wrapping_sub(0xe654_6b64).wrapping_mul(inverse(5)).rotate_right(13);
        let k = v.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
        prop_assert_eq!(turned ^ k, h);
        let word = (turned ^ h).wrapping_mul(inverse(0x1b87_3593)).rotate_right(15);
        prop_assert_eq!(word.wrapping_mul(inverse(0xcc9e_2d51)), v);

        let a = unshift(finish(h), 16).wrapping_mul(inverse(0xc2b2_ae35));
        prop_assert_eq!(unshift(unshift(a, 13).wrapping_mul(inverse(0x85eb_ca6b)), 16), h);
    }

    #[test]
    fn unit_floats_are_exact_and_below_one(v: u32) {
        let x = to_unit_f32(v);
        prop_assert!((0.0..1.0).contains(&x));
        prop_assert_eq!(f64::from(x) * 16_777_216.0, f64::from(v >> 8));
    }
}

/// Whole keys through the second family, against published values of `MurmurHash3_x86_32`.
#[test]
fn murmur_matches_published_values() {
    let hash = |seed: u32, bytes: &[u8]| {
        let words = bytes.chunks_exact(4);
        assert!(words.remainder().is_empty(), "whole words only");
        let body = words.fold(seed, |h, w| mix(h, u32::from_le_bytes(w.try_into().unwrap())));
        finish(body ^ bytes.len() as u32)
    };
    assert_eq!(hash(0, b""), 0);
    assert_eq!(hash(1, b""), 0x514e_28b7);
    assert_eq!(hash(0xffff_ffff, b""), 0x81f1_6f39);
    assert_eq!(hash(0, b"test"), 0xba6b_d213);
    assert_eq!(hash(0x9747_b28c, b"aaaa"), 0x5a97_808a);
    assert_eq!(hash(0, &[0, 0, 0, 0]), 0x2362_f9de);
    assert_eq!(hash(0, &[0xff, 0xff, 0xff, 0xff]), 0x7629_3b50);
}

/// Each input bit flips each output bit in nearly half of all cases.
fn avalanche(inputs: u32, hash: impl Fn(u32) -> u32) -> f64 {
    let mut flips = [[0_u32; 32]; 32];
    for i in 0..inputs {
        let v = finish(i ^ 0x5bd1_e995);
        for (bit, row) in flips.iter_mut().enumerate() {
            let changed = hash(v) ^ hash(v ^ (1 << bit));
            for (out, count) in row.iter_mut().enumerate() {
                *count += (changed >> out) & 1;
            }
        }
    }
    let worst = |count: &u32| (f64::from(*count) / f64::from(inputs) - 0.5).abs();
    flips.as_flattened().iter().map(worst).fold(0.0, f64::max)
}

/// 1024 shares of 4096 fair flips deviate by at most 5.5 standard deviations of 1/128: a false alarm in 20,000 sets.
const FAIR: f64 = 5.5 / 128.0;

#[test]
fn finished_hashes_avalanche() {
    assert!(avalanche(4096, finish) < FAIR);
    assert!(avalanche(4096, |v| finish(mix(0, v))) < FAIR);
    // The first of two words is spread by the second round before the end.
    assert!(avalanche(4096, |v| finish(mix(mix(7, v), 13))) < FAIR);
}

/// PCG's one output permutation leaves some pairs of bits biased; what counts is that none is stuck.
#[test]
fn pcg_moves_every_bit() {
    assert!(avalanche(4096, pcg) < 0.45, "{}", avalanche(4096, pcg));
}

/// Coordinates of a small block, as a table sees them: the words' low and high bits fill 4096 bins evenly.
#[test]
fn lattices_fill_tables_evenly() {
    const BINS: usize = 4096;
    let n = 48_u32;
    let mut bins = vec![[0_u32; BINS]; 6];
    for i in 0..n * n * n {
        let c = [i % n, i / n % n, i / n / n];
        let [x, y, z] = pcg3d(c);
        let [a, ..] = pcg4d([c[0], c[1], c[2], 5]);
        let m = finish(c.iter().fold(0, |h, v| mix(h, *v)));
        let words = [x & 0xfff, x >> 20, y >> 20, z >> 20, a >> 20, m & 0xfff];
        for (bins, word) in bins.iter_mut().zip(words) {
            bins[word as usize] += 1;
        }
    }
    let expected = f64::from(n * n * n) / BINS as f64;
    for (which, bins) in bins.iter().enumerate() {
        let chi2: f64 = bins.iter().map(|b| (f64::from(*b) - expected).powi(2) / expected).sum();
        // Mean 4095, standard deviation √8190 = 90.5; six of them above. Below the mean is more even than chance: good.
        assert!(chi2 < 4095.0 + 6.0 * 90.5, "word {which}: chi squared {chi2}");
    }
}
