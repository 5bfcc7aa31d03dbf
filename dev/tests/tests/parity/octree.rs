//! The octree's lookups: from floats to cells, keys, buckets and indices, for any bits.

use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::glam::Vec3;
use hashcache_core::octree::block::{block_key, cell_bit};
use hashcache_core::octree::table::{bucket_pair, multiply_high};
use hashcache_core::octree::{BuildSettings, NO_CELL, OwnedOctree, Serial, build};
use hashcache_core::wgsl::{HASH, OCTREE};
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::harness::{Item, call, expect, inputs};

/// Four walls and a sliver, in cells of a sixteenth.
fn octree() -> OwnedOctree {
    let geometry = Geometry {
        positions: &[[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.0, 1.0, 0.2], [0.9, 0.9, 1.0], [0.9001, 0.9, 1.0]],
        indices: &[[0, 1, 2], [1, 2, 3], [0, 3, 4]],
        meshes: &[Mesh { first_triangle: 0, triangle_count: 3 }],
        instances: &[Instance::identity(0)],
        ..Geometry::default()
    };
    build(&geometry, &BuildSettings { resolution: 16, ..BuildSettings::default() }, &Serial).expect("three triangles")
}

#[test]
fn keys_and_buckets_are_equal_for_any_bits() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let body = "let v = vec3<u32>(word(0u), word(1u), word(2u));
         put(0u, hc_multiply_high(v.x, v.y)); put(1u, hc_cell_bit(v)); put(2u, hc_block_key(v));
         put2(3u, hc_bucket_pair(v.x, v.y, v.z));
         put(5u, hc_map_of(v >> vec3<u32>(word(3u) % 32u), word(4u) % 5u));";
    let global = "var<private> hc_octree: array<u32, 16>;";
    let found = call(&mut backend, "octree, keys", &[HASH, global, OCTREE], body, &items);
    let expected = expect(&items, |item| {
        let [x, y, z, shift, log2, ..] = *item;
        let [a, b] = bucket_pair(x, y, z);
        // The map of a block, from the definition: 1024, 1024 and 2048 blocks a map.
        let at = [x, y, z].map(|v| v >> (shift % 32));
        let at = [at[0] / 1024, at[1] / 1024, at[2] / 2048];
        let side = 1 << (log2 % 5);
        let map = if at.iter().all(|v| *v < side) { at[0] + side * (at[1] + side * at[2]) } else { NO_CELL };
        [multiply_high(x, y), cell_bit([x, y, z]), block_key([x, y, z]), a, b, map]
    });
    for (item, (e, f)) in items.iter().zip(expected.iter().zip(&found)) {
        assert!(e == f, "{item:x?}: {e:x?} in Rust, {f:x?} in WGSL");
    }
}

#[test]
fn cells_are_equal_for_any_bits_and_places() {
    let Some(mut backend) = gpu::backend() else { return };
    let owned = octree();
    let view = owned.view();
    let mut items = inputs();
    // Two of three items ask for points near the scene; the level is any.
    for item in items.iter_mut().enumerate().filter(|(i, _)| i % 3 != 0).map(|(_, item)| item) {
        for word in &mut item[..3] {
            *word = (*word as f32 / u32::MAX as f32 * 2.6 - 0.8).to_bits();
        }
        item[3] %= view.grid().levels + 2;
    }
    let words: Vec<String> = owned.words.iter().map(|word| format!("{word}u")).collect();
    let global: &'static str =
        format!("var<private> hc_octree: array<u32, {0}> = array<u32, {0}>({1});", words.len(), words.join(", "))
            .leak();
    let body = "let c = hc_coordinates(vec3<f32>(word_f32(0u), word_f32(1u), word_f32(2u)));
         put2(0u, c.xy); put(2u, c.z);
         let level = word(3u);
         let of_level = select(c >> vec3<u32>(level % 32u), c, c.x == HC_NO_CELL);
         put(3u, hc_cell(level, of_level)); put(4u, hc_place(level, of_level)); put(5u, hc_side(level % 8u));";
    let found = call(&mut backend, "octree, cells", &[HASH, global, OCTREE], body, &items);
    let expected = expect(&items, |item: &Item| {
        let level = item[3];
        let c = view.coordinates(Vec3::from_array([item[0], item[1], item[2]].map(f32::from_bits)));
        let of_level = c.map_or([NO_CELL; 3], |c| c.map(|v| v >> (level % 32)));
        let [x, y, z] = c.unwrap_or([NO_CELL; 3]);
        let cell = view.cell(level, of_level).unwrap_or(NO_CELL);
        [x, y, z, cell, view.place(level, of_level).unwrap_or(NO_CELL), view.grid().side(level % 8)]
    });
    let hits = expected.iter().filter(|words| words[3] != NO_CELL).count();
    assert!(hits > items.len() / 32, "only {hits} of {} points have a cell", items.len());
    for (item, (e, f)) in items.iter().zip(expected.iter().zip(&found)) {
        assert!(e == f, "{item:x?}: {e:x?} in Rust, {f:x?} in WGSL");
    }
}
