//! Scenes and words that nobody should have, and sizes that do not fit.

use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec3;
use hashcache_core::octree::{
    BuildError, BuildSettings, Grid, Octree, Partition, Serial, Triangles, build, build_within, finish, predict_bytes,
    resolution_for_footprint,
};
use proptest::prelude::*;

use crate::common::{Scene, overlaps, sheet};

const NAN: Vec3 = Vec3::NAN;

#[test]
fn triangles_without_place_are_left_out() {
    let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let bad = [[NAN, Vec3::X, Vec3::Y], [Vec3::ZERO, Vec3::INFINITY, Vec3::Y], [NAN; 3]];
    let with = Scene::new(&[bad[0], good, bad[1], bad[2]]).build(32);
    assert_eq!(with.words, Scene::new(&[good]).build(32).words);
    for none in [&bad[..], &[]] {
        let built = build(&Scene::new(none).geometry(), &BuildSettings::default(), &Serial);
        assert_eq!(built.err(), Some(BuildError::Empty));
    }
}

#[test]
fn resolutions_that_are_none_are_refused() {
    let scene = Scene::new(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    for resolution in [0, 1, 2, 3, 5, 1 << 17, u32::MAX] {
        let built = build(&scene.geometry(), &BuildSettings { resolution, ..BuildSettings::default() }, &Serial);
        assert!(matches!(built, Err(BuildError::Param(_))), "{resolution}: {built:?}");
    }
    for (low, high) in
        [(NAN, Vec3::ONE), (Vec3::ONE, Vec3::ZERO), (Vec3::ZERO, Vec3::INFINITY), (Vec3::ZERO, Vec3::MAX)]
    {
        assert!(Grid::new(low, high, 64).is_err(), "{low} {high}");
    }
    assert_eq!(Grid::new(Vec3::ZERO, Vec3::ONE, 48), Err(ParamError::NotPowerOfTwo { name: "resolution", value: 48 }));
}

/// A scene of one point, of a line, and of sizes at the ends of what metres are used for.
#[test]
fn scenes_of_any_size_have_an_octree() {
    let line = [Vec3::ZERO, Vec3::X, Vec3::X];
    for triangle in [[Vec3::ZERO; 3], [Vec3::splat(1e7); 3], line, line.map(|p| p * 1e-20), line.map(|p| p * 1e20)] {
        for resolution in [4, 512, 65_536] {
            let built = Scene::new(&[triangle]).build(resolution);
            let octree = built.view();
            assert_eq!(octree.validate(), Ok(()), "{triangle:?} at {resolution}");
            for corner in triangle {
                let cell = octree.coordinates(corner).expect("inside");
                assert!(octree.cell(0, cell).is_some(), "{triangle:?} at {resolution}");
            }
        }
    }
}

/// The grid of a part of the scene: triangles reach far beyond it, or lie outside.
#[test]
fn triangles_larger_than_the_grid_are_cut_off() {
    let grid = Grid::new(Vec3::ZERO, Vec3::ONE, 8).expect("a box");
    let base = [Vec3::new(-1.0, -1.0, 0.3), Vec3::new(3.0, -0.5, 0.4), Vec3::new(-0.5, 3.0, 0.8)];
    for size in [1.0, 1e3, 1e6] {
        let middle = Vec3::splat(0.5);
        let triangle = base.map(|p| (p - middle) * size + middle);
        let scene = Scene::new(&[triangle, [Vec3::splat(9.0); 3]]);
        let triangles = Triangles::new(&scene.geometry()).expect("two triangles");
        let partition = Partition::new(&grid, &triangles, u64::MAX, &Serial).expect("small");
        let built = finish(&partition, &triangles, &Serial).expect("small");
        let octree = built.view();
        assert_eq!(octree.validate(), Ok(()));
        for cell in (0..16_u32.pow(3)).map(|i| [i & 15, i >> 4 & 15, i >> 8]) {
            let inside = (0..3).all(|axis| cell[axis] >= grid.corner[axis]);
            let stored = octree.cell(0, cell).is_some();
            if stored {
                assert!(overlaps(&grid, &triangle, cell, 2.0 * grid.margin()), "{cell:?} at {size}");
            } else {
                assert!(!inside || !overlaps(&grid, &triangle, cell, 0.0), "{cell:?} at {size}");
            }
        }
    }
    // So far away that double precision knows no plane: anything but a panic or an endless loop.
    let far = Scene::new(&[base.map(|p| p * 1e30), base.map(|p| p * 1e38)]);
    let triangles = Triangles::new(&far.geometry()).expect("two triangles");
    assert!(Partition::new(&grid, &triangles, u64::MAX, &Serial).is_ok());
}

#[test]
fn what_does_not_fit_is_refused_with_its_size() {
    let scene = sheet(20);
    let settings = |resolution, max_bytes| BuildSettings { resolution, max_bytes, ..BuildSettings::default() };
    let cell_bytes = BuildSettings::default().cell_bytes;
    let triangles = Triangles::new(&scene.geometry()).expect("triangles");
    let bytes_at = |resolution| {
        let built = build(&scene.geometry(), &settings(resolution, u64::MAX), &Serial).expect("fits");
        built.bytes() + u64::from(cell_bytes) * u64::from(built.view().cells())
    };
    for resolution in [64, 512] {
        let bytes = bytes_at(resolution);
        let predicted = predict_bytes(&triangles, resolution, cell_bytes, &Serial).expect("a scene");
        let error = (predicted as f64 / bytes as f64 - 1.0).abs();
        assert!(error < if resolution <= 256 { 0.001 } else { 0.15 }, "{predicted} of {bytes}");
        assert!(build(&scene.geometry(), &settings(resolution, bytes), &Serial).is_ok());
        for limit in [bytes - 1, bytes / 20, 0] {
            match build(&scene.geometry(), &settings(resolution, limit), &Serial) {
                Err(BuildError::TooLarge { needed, limit: told }) => {
                    assert!(told == limit && needed > limit, "{needed} {limit}");
                    assert!((needed as f64 / bytes as f64 - 1.0).abs() < 0.15, "{needed} of {bytes}");
                }
                other => panic!("{limit} of {bytes} bytes suffice: {:?}", other.map(|built| built.bytes())),
            }
        }
    }
    let within = build_within(&scene.geometry(), &settings(65_536, bytes_at(128)), &Serial).expect("fits");
    assert_eq!(within.view().grid().resolution, 128);
    let refused = build_within(&scene.geometry(), &settings(65_536, 100), &Serial);
    assert!(matches!(refused, Err(BuildError::TooLarge { .. })));
}

#[test]
fn the_resolution_follows_the_footprint() {
    let scene = Scene::new(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let triangles = Triangles::new(&scene.geometry()).expect("one");
    let at = |footprint| resolution_for_footprint(&triangles, footprint).expect("one");
    for resolution in [4_u16, 64, 4096] {
        let cell = 1.01 / f32::from(resolution);
        assert_eq!([cell * 0.72, cell, cell * 1.4].map(at), [u32::from(resolution); 3]);
    }
    assert_eq!([0.0, -1.0, f32::NAN, 1e-30].map(at), [65_536; 4]);
    assert_eq!([10.0, f32::INFINITY].map(at), [4; 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Any words: refused, or looked up without a panic.
    #[test]
    fn foreign_words_are_survived(seed in any::<u64>(), changes in 1_usize..6, level in 0_u32..40, cell: [u32; 3]) {
        let mut words = sheet(3).build(16).words;
        let mut dice = seed;
        for _ in 0..changes {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (dice >> 33) as usize % words.len().min(200);
            words[at] = if dice & 1 == 0 { dice as u32 >> 1 } else { words[at] ^ (1 << (dice >> 5 & 31)) };
        }
        words.truncate(words.len() - (seed as usize % 3) * (seed as usize % 64));
        if let Ok(octree) = Octree::new(&words) {
            let _ = (octree.cell(level, cell), octree.validate(), octree.coordinates(Vec3::ONE));
        }
        let _ = Octree::new(&words[..words.len() / 7]);
    }

    /// One bit of an occupied entry turned: the octree is no longer valid.
    #[test]
    fn a_turned_bit_is_noticed(pick in any::<u32>(), bit in 0_u32..32, part in 0_u32..3) {
        let mut words = sheet(3).build(16).words;
        let (first, count) = {
            let octree = Octree::new(&words).expect("built");
            prop_assert_eq!(octree.validate(), Ok(()));
            let map = octree.maps()[(pick % octree.maps().len() as u32) as usize];
            (map.first_word, map.buckets * 4)
        };
        let entry = (0..count).map(|k| (pick / 32 + k) % count).find(|k| words[(first + k / 4 * 12 + k % 4) as usize] != u32::MAX);
        let entry = entry.expect("every level has a block");
        words[(first + entry / 4 * 12 + part * 4 + entry % 4) as usize] ^= 1 << bit;
        prop_assert!(Octree::new(&words).expect("the header is as it was").validate().is_err());
    }
}
