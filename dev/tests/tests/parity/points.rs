//! The implicit points: where they are, who is nearest, who is drawn.

use hashcache_core::wgsl::{HASH, JITTER, LEVEL, PACK, RECORD};
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::harness::{Item, call, expect, inputs};
use hashgrid::kernels::{WGSL_KEY, WGSL_POINTS};
use hashgrid::points::{
    POINT_BIN, Spot, distance_squared, point_choose, point_draw, point_nearest, point_owner, point_place, point_spot,
};
use hashgrid::{Key, Params, Settings};

const MODULES: [&str; 7] = [HASH, JITTER, PACK, LEVEL, RECORD, WGSL_KEY, WGSL_POINTS];

/// Fewer items: a nearest point costs hundreds of hashes.
fn some() -> Vec<Item> {
    inputs().into_iter().step_by(37).collect()
}

#[test]
fn places_and_owners_are_equal() {
    let Some(mut backend) = gpu::backend() else { return };
    let items: Vec<Item> = inputs().into_iter().step_by(5).collect();
    let body = "let cube = HgKey(vec3<i32>(word_i32(0u), word_i32(1u), word_i32(2u)) >> vec3<u32>(11u),
                                 (word(3u) & 31u) | (HG_POINT_BIN << 8u));
                let place = hg_point_place(cube);
                let owner = hg_point_owner(cube);
                put(0u, u32(place.x)); put(1u, u32(place.y)); put(2u, u32(place.z));
                put(3u, bitcast<u32>(owner.cell.x)); put(4u, bitcast<u32>(owner.cell.y));
                put(5u, bitcast<u32>(owner.cell.z)); put(6u, owner.attributes);
                put(7u, hg_point_choose(vec3<u32>(word(0u) >> 6u, word(1u) >> 6u, word(2u) >> 6u), word(4u)));";
    let found = call(&mut backend, "point places", &MODULES, body, &items);
    let expected = expect(&items, |item| {
        let cell = [item[0], item[1], item[2]].map(|v| v as i32 >> 11);
        let cube = Key { cell, attributes: (item[3] & 31) | (POINT_BIN << 8) };
        let ([u, v, w], owner) = (point_place(cube).map(|v| v as u32), point_owner(cube));
        let [x, y, z] = owner.cell.map(|c| c as u32);
        let chosen = point_choose([item[0] >> 6, item[1] >> 6, item[2] >> 6], item[4]);
        [u, v, w, x, y, z, owner.attributes, chosen]
    });
    assert!(found == expected);
}

#[test]
fn nearest_points_are_equal() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = some();
    let body = "let spot = HgSpot(word(3u) & 31u,
                    vec3<i32>(word_i32(0u), word_i32(1u), word_i32(2u)) >> vec3<u32>(2u));
                let points = hg_point_nearest(spot);
                let d = vec3<u32>(hg_distance_squared(points[0].offset), hg_distance_squared(points[1].offset),
                                  hg_distance_squared(points[2].offset));
                let chosen = hg_point_choose(d, hg_point_draw(spot, word(4u)));
                put(0u, d.x); put(1u, d.y); put(2u, d.z); put(3u, chosen);
                put(4u, bitcast<u32>(points[chosen].owner.cell.x)); put(5u, points[chosen].owner.attributes);
                put(6u, bitcast<u32>(points[0].offset.y)); put(7u, bitcast<u32>(points[2].owner.cell.z));";
    let found = call(&mut backend, "nearest points", &MODULES, body, &items);
    let expected = expect(&items, |item| {
        let spot = Spot { level: item[3] & 31, fixed: [item[0], item[1], item[2]].map(|v| v as i32 >> 2) };
        let points = point_nearest(spot);
        let d = points.map(|point| distance_squared(point.offset));
        let chosen = point_choose(d, point_draw(spot, item[4]));
        let owner = points[chosen as usize].owner;
        let [x, _, _] = owner.cell;
        let last = points[2].owner.cell[2] as u32;
        [d[0], d[1], d[2], chosen, x as u32, owner.attributes, points[0].offset[1] as u32, last]
    });
    assert!(found == expected);
}

#[test]
fn spots_are_equal() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let params = Params::new(&Settings::default()).expect("valid settings");
    let words: Vec<String> = bytemuck::cast::<Params, [i32; 12]>(params)
        .iter()
        .enumerate()
        .map(|(k, word)| if matches!(k, 1 | 2 | 8) { format!("{word}") } else { format!("{}u", *word as u32) })
        .collect();
    let body = format!(
        "let spot = hg_point_spot(HgParams({}), bitcast<vec4<f32>>(vec4<u32>(word2(0u), word2(2u))));
         put(0u, spot.level); put(1u, bitcast<u32>(spot.fixed.x)); put(2u, bitcast<u32>(spot.fixed.y));
         put(3u, bitcast<u32>(spot.fixed.z));",
        words.join(", ")
    );
    let found = call(&mut backend, "spots", &MODULES, &body, &items);
    let expected = expect(&items, |item| {
        let place = [item[0], item[1], item[2], item[3]].map(f32::from_bits);
        let spot = point_spot(&params, place).unwrap_or(Spot { level: u32::MAX, fixed: [0; 3] });
        let [x, y, z] = spot.fixed.map(|v| v as u32);
        [spot.level, x, y, z]
    });
    assert!(found == expected);
}
