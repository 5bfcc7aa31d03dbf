use hashgrid::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use hashgrid::key::{Key, key, lowest_level, origin_shift};

use super::*;

/// Footprint whose cells of 8 footprints are on `level` for a base of 2⁻¹⁰.
fn footprint_of(level: i32) -> f32 {
    2.0_f32.powi(level - 13)
}

fn key_at(params: &Params, position: [f32; 3], level: i32) -> Key {
    let mut vertex = vertex(position, Vec3::Z);
    vertex.position_footprint[3] = footprint_of(level);
    key(params, &vertex, SALT_DEPOSIT).expect("a finite vertex")
}

/// The cell of `x` by the formula, in f64: exact for the sizes used here.
fn model_cell(x: f32, level: i32) -> f64 {
    (f64::from(x) / 2.0_f64.powi(level - 10) + f64::from(origin_shift(level as u32)) / 256.0).floor()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Whatever the bits: no panic (overflow checks are on), no coordinate beyond 24 bits, and a key exactly for finite
    /// positions within reach and finite footprints.
    #[test]
    fn any_vertex_has_a_key_or_a_reason(settings in any_settings(), vertex in any_vertex(), salt: u32) {
        let params = params(settings);
        let found = key(&params, &vertex, salt);
        let finite = vertex.position_footprint.iter().all(|v| v.is_finite());
        let largest = vertex.position_footprint[..3].iter().fold(0.0_f32, |m, v| m.max(v.abs()));
        let within = lowest_level(largest.to_bits(), params.base_exponent()) <= 31;
        prop_assert_eq!(found.is_some(), finite && within);
        if let Some(key) = found {
            prop_assert!(key.cell.iter().all(|c| c.abs() < 1 << 23), "{key:?}");
            prop_assert!(key.level() <= 31);
            prop_assert!(key.normal_bin() < 6 * params.normal_bins() * params.normal_bins());
        }
    }

    /// Without jitter the cell is ⌊x/size + shift⌋ on the level of the footprint.
    #[test]
    fn cells_follow_the_formula(x in -4000.0_f32..4000.0, y in -1.0_f32..1.0, z in -1e-4_f32..1e-4, level in 0_i32..=31) {
        let params = params(still());
        let key = key_at(&params, [x, y, z], level);
        let level = level.max(lowest_level(x.abs().max(y.abs()).to_bits(), params.base_exponent()));
        prop_assert_eq!(key.level() as i32, level);
        for (cell, x) in key.cell.iter().zip([x, y, z]) {
            // Indices of fine levels are counted from another origin: a whole number of cells.
            prop_assert_eq!(f64::from(*cell), model_cell(x, level));
        }
    }

    /// Points of one cell have one key.
    #[test]
    fn points_of_a_cell_share_its_key(x in -100.0_f32..100.0, t in 0.0_f32..1.0, level in 0_i32..31) {
        let params = params(still());
        let key = key_at(&params, [x; 3], level);
        // Floats here are 2⁻¹⁷ apart, and cells at least 2⁻¹⁰ large.
        let corner = key.corner(&params)[0];
        let inside = corner + params.cell_size(key.level()) * (0.01 + 0.98 * t);
        prop_assert_eq!(key_at(&params, [inside; 3], level), key);
    }

    /// A vertex moves by at most one cell of its level in each axis, and its level by at most two.
    #[test]
    fn jitter_stays_near(vertex in any_vertex(), seed: u32) {
        let loose = params(Settings { jitter: 1.0, pixel_angle: 0.01, ..Settings::default() });
        let stiff = params(Settings { pixel_angle: 0.01, ..still() });
        let vertex = VertexRecord { seed, ..vertex };
        if let (Some(a), Some(b)) = (key(&loose, &vertex, SALT_LOOKUP), key(&stiff, &vertex, SALT_LOOKUP)) {
            prop_assert!(a.level().abs_diff(b.level()) <= 2);
            if a.level() == b.level() {
                prop_assert!(a.cell.iter().zip(b.cell).all(|(a, b)| a.abs_diff(b) <= 1));
            }
        }
    }
}

/// Walls on the grid's own lattice are a third of a cell from the nearest border, at every level and on both sides of
/// the origin. The third is 85/256 in the fixed point that is used.
#[test]
fn walls_miss_borders() {
    let params = params(still());
    for level in 0..=31 {
        let size = 2.0_f32.powi(level - 10);
        for wall in [-1024, -3, -2, -1, 0, 1, 2, 3, 7, 1000] {
            let at = wall as f32 * size;
            let cell = |x: f32| key_at(&params, [x, 0.0, 0.0], level).cell[0];
            for side in [-1.0, 1.0] {
                let (inside, outside) = (at + side * size * 84.0 / 256.0, at + side * size * 172.0 / 256.0);
                assert_eq!(cell(inside), cell(at), "level {level}, wall {wall}, side {side}");
                assert_ne!(cell(outside), cell(at), "level {level}, wall {wall}, side {side}");
            }
        }
    }
}

/// Borders of a level are borders of the finer one, up to a 256th of the finer cell.
#[test]
fn borders_nest_to_a_step_of_the_fixed_point() {
    for level in 0..31 {
        let off = (origin_shift(level) - 2 * origin_shift(level + 1)).rem_euclid(256);
        assert!(off <= 1, "level {level}: {off}");
    }
}

/// The level changes exactly where the footprint does: one unit in the last place below a power of two is the level
/// below (12 significant bits count, and cutting never raises).
#[test]
fn levels_change_at_one_unit_in_the_last_place() {
    let params = params(still());
    for level in 1..=31 {
        let mut at = vertex([0.1, 0.2, 0.3], Vec3::Y);
        at.position_footprint[3] = footprint_of(level);
        let mut below = at;
        below.position_footprint[3] = footprint_of(level).next_down();
        let [at, below] = [at, below].map(|vertex| key(&params, &vertex, 0).unwrap().level() as i32);
        assert_eq!((at, below), (level, level - 1));
    }
    let mut huge = vertex([0.0; 3], Vec3::Y);
    for (footprint, level) in [(f32::MAX, 31), (0.0, 0), (-0.0, 0), (-5.0, 0), (1e-44, 0), (1e7, 31)] {
        huge.position_footprint[3] = footprint;
        assert_eq!(key(&params, &huge, 0).unwrap().level(), level, "{footprint}");
    }
}

/// Scenes of 0.1 mm and of 10 000 km, and scenes 1000 km off, have cells as small as floats can tell apart, and points
/// two cells apart have different keys.
#[test]
fn every_scale_is_resolved() {
    let small = params(Settings { base_size: 2.0_f32.powi(-24), ..still() });
    let at = |params: &Params, x: f32, footprint: f32| {
        let mut vertex = vertex([x, -x, 0.0], Vec3::Z);
        vertex.position_footprint[3] = footprint;
        key(params, &vertex, 0).unwrap()
    };
    assert_ne!(at(&small, 1e-4, 1e-9), at(&small, 1e-4 + 2.4e-7, 1e-9));
    let large = params(still());
    for x in [1e6_f32, 1e7] {
        let key = at(&large, x, 1e-6);
        let size = large.cell_size(key.level());
        assert!(size <= x / 1e6, "{size}");
        assert_ne!(key, at(&large, x + 2.0 * size, 1e-6));
    }
}

/// A mean path length change moves levels with the jitter: near the border of two levels both are met.
#[test]
fn levels_blend_across_their_border() {
    let params = params(Settings { pixel_angle: 1.0 / 128.0, ..Settings::default() });
    let mut levels = [0; 32];
    for seed in 0..1000 {
        let mut vertex = vertex([0.0, 0.0, 1.0], Vec3::X);
        // Just above the border: the path grows along z, which the jitter changes.
        vertex.position_footprint[3] = footprint_of(6) * 1.001;
        vertex.seed = seed;
        levels[key(&params, &vertex, SALT_LOOKUP).unwrap().level() as usize] += 1;
    }
    assert_eq!(levels[5] + levels[6], 1000);
    assert!(levels[5] > 300 && levels[6] > 300, "{levels:?}");
}

/// What is not accepted.
#[test]
fn settings_are_checked() {
    let good = Settings::default();
    assert!(Params::new(&good).is_ok());
    for bad in [
        Settings { cell_footprints: 0.0, ..good },
        Settings { cell_footprints: f32::NAN, ..good },
        Settings { base_size: -1.0, ..good },
        Settings { base_size: 1e30, ..good },
        Settings { pixel_angle: f32::INFINITY, ..good },
        Settings { pixel_angle: -0.1, ..good },
        Settings { jitter: 1.01, ..good },
        Settings { normal_bins: 0, ..good },
        Settings { normal_bins: 2, ..good },
        Settings { normal_bins: 17, ..good },
        Settings { max_probes: 0, ..good },
        Settings { max_probes: 65, ..good },
    ] {
        assert!(Params::new(&bad).is_err(), "{bad:?}");
    }
}
