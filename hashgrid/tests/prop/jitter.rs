use hashcache_core::pack::octahedral_decode_int;
use hashgrid::jitter::{
    SALT_DEPOSIT, SALT_LOOKUP, draw, max_component, normal_bin, path_change, tangent_offset, turn, turn_back,
};
use hashgrid::key::key;

use super::*;

proptest! {
    /// Offsets lie in the tangent plane to within the rounding of one division.
    #[test]
    fn offsets_lie_in_the_tangent_plane(code: u32, u in -128_i32..=128, v in -128_i32..=128) {
        let n = octahedral_decode_int(code);
        let o = tangent_offset(n, u, v);
        let off: i32 = (0..3).map(|k| n[k] * o[k]).sum();
        prop_assert!(off.abs() < n[max_component(n) as usize].abs(), "{n:?} {o:?}");
    }

    #[test]
    fn turning_back_undoes(v: [i32; 3], axis in 0_u32..3) {
        prop_assert_eq!(turn_back(turn(v, axis), axis), v);
        prop_assert_eq!(turn(v, axis)[0], v[axis as usize]);
    }

    /// The change of path length is the projection on the direction, within 6.1 % and one unit.
    #[test]
    fn path_changes_are_projections(offset in prop::array::uniform3(-256_i32..=256), code: u32) {
        let d = octahedral_decode_int(code);
        let length = d.iter().map(|d| f64::from(d * d)).sum::<f64>().sqrt();
        let exact = (0..3).map(|k| f64::from(offset[k] * d[k])).sum::<f64>() / length;
        let found = f64::from(path_change(offset, d));
        prop_assert!((found - exact).abs() <= 0.061 * exact.abs() + 1.0, "{found} for {exact}");
    }

    /// Opposite normals never share a bin, and neither do those of different faces, away from the borders.
    #[test]
    fn bins_tell_faces_apart(code: u32, bins in (0_u32..8).prop_map(|k| 2 * k + 1)) {
        let n = octahedral_decode_int(code);
        let bin = normal_bin(n, 0, 0, bins);
        prop_assert_ne!(bin, normal_bin(n.map(|c| -c), 0, 0, bins));
        prop_assert_eq!(bin / (bins * bins), max_component(n) * 2 + u32::from(n[max_component(n) as usize] < 0));
    }
}

/// Axis-aligned normals stay in the middle bin of their face for every draw and every number of bins.
#[test]
fn axis_aligned_normals_keep_their_bin() {
    for bins in (1..=15).step_by(2) {
        let reach = 32_768 / bins;
        for axis in 0..6_u32 {
            let mut n = [0; 3];
            n[(axis / 2) as usize] = if axis.is_multiple_of(2) { 32_767 } else { -32_767 };
            let middle = (axis * bins + bins / 2) * bins + bins / 2;
            for bits in (0..0x1_0000).step_by(251).chain([0xffff]) {
                for other in [0, 0x7fff, 0xffff] {
                    let (u, v) = (draw(bits, reach), draw(other, reach));
                    assert_eq!(normal_bin(n, u, v, bins), middle, "{bins} bins, axis {axis}, {u} {v}");
                }
            }
        }
    }
}

/// A normal on the edge between two faces falls into both, about equally often.
#[test]
fn edges_between_faces_blend() {
    let params = params(Settings::default());
    let mut second = 0;
    for seed in 0..4000 {
        let mut vertex = vertex([0.0; 3], Vec3::new(1.0, 1.0, 0.0));
        vertex.seed = seed;
        second += key(&params, &vertex, SALT_DEPOSIT).unwrap().normal_bin() / 18;
    }
    // 5 standard deviations of a fair coin.
    assert!((1842..=2158).contains(&second), "{second}");
}

/// A vertex falls into its neighbours as often as a box of one cell around it overlaps them; deposits and lookups
/// draw independently.
#[test]
fn jitter_is_uniform() {
    const DRAWS: u32 = 40_000;
    let params = params(Settings { pixel_angle: 0.0, ..Settings::default() });
    // The origin's shift on level 0 is two thirds of a cell (170/256), so this x is 170/256 + 32/256 into its cell.
    let x = 32.0 / 256.0 / 1024.0;
    let mut counts = [[0_u32; 3]; 2];
    let (mut both, mut salts) = (0, [0_u32; 4]);
    for seed in 0..DRAWS {
        let mut vertex = vertex([x, x, 0.0], Vec3::Z);
        vertex.seed = seed;
        let still = key(&self::params(Settings { pixel_angle: 0.0, ..still() }), &vertex, 0).unwrap().cell;
        let deposit = key(&params, &vertex, SALT_DEPOSIT).unwrap().cell;
        let lookup = key(&params, &vertex, SALT_LOOKUP).unwrap().cell;
        assert_eq!(deposit[2], still[2], "the jitter left the plane");
        let next = |cell: [i32; 3], k: usize| cell[k] > still[k];
        for (k, counts) in counts.iter_mut().enumerate() {
            counts[(deposit[k] - still[k] + 1) as usize] += 1;
        }
        both += u32::from(next(deposit, 0) && next(deposit, 1));
        salts[usize::from(next(deposit, 0)) + 2 * usize::from(next(lookup, 0))] += 1;
    }
    // 202/256 into the cell, ±128/256: 74 of 256 draws reach the next cell, none the one before.
    let p = 74.0 / 256.0;
    let near = |count: u32, p: f64| {
        let n = f64::from(DRAWS);
        (f64::from(count) - n * p).abs() < 5.0 * (n * p * (1.0 - p)).sqrt()
    };
    for counts in counts {
        assert_eq!(counts[0], 0);
        assert!(near(counts[2], p), "{counts:?}");
    }
    assert!(near(both, p * p), "{both}");
    assert!(near(salts[3], p * p) && near(salts[1], p * (1.0 - p)), "{salts:?}");
}

/// Draws hit all their values equally often and none outside.
#[test]
fn draws_are_uniform() {
    let mut counts = [0_u32; 256];
    for bits in 0..0x1_0000 {
        counts[(draw(bits, 128) + 128) as usize] += 1;
    }
    assert!(counts.iter().all(|count| *count == 256));
    assert!((0..0x1_0000).all(|bits| draw(bits, 0) == 0));
    assert_eq!((draw(0, 32_768), draw(0xffff, 32_768)), (-32_768, 32_767));
}
