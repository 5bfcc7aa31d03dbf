//! The hash grid's keys: from floats to cells, hashes and fingerprints, for any bits and any settings.

use hashcache_core::exact::Quantum;
use hashcache_core::record::VertexRecord;
use hashcache_core::wgsl::{HASH, JITTER, LEVEL, PACK, RECORD};
use hashcache_dev_tests::gpu;
use hashcache_dev_tests::harness::{Item, call, expect, inputs};
use hashgrid::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use hashgrid::kernels::{WGSL_KEY, WGSL_LOBE};
use hashgrid::key::{coarser, coarser_offset, finer, fingerprint, home, key};
use hashgrid::lobe::{Lobe, LobeSettings};
use hashgrid::similar::place_home;
use hashgrid::{Key, Params, Settings};

/// The vertex of an item's words.
fn vertex(item: &Item) -> VertexRecord {
    let [x, y, z, footprint, normal, direction, seed, _] = *item;
    VertexRecord {
        position_footprint: [x, y, z, footprint].map(f32::from_bits),
        normal,
        direction,
        seed,
        flags: VertexRecord::VALID,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Coordinates of ordinary scenes among the arbitrary bits: the sign and fraction of a word, an exponent from 2⁻¹⁴ to
/// 2²⁴.
fn tame(items: &mut [Item]) {
    for (i, item) in items.iter_mut().enumerate() {
        if i % 3 != 0 {
            for word in &mut item[..3] {
                *word = (*word & 0x807f_ffff) | ((113 + (*word >> 23) % 38) << 23);
            }
            item[3] = (item[3] & 0x007f_ffff) | ((110 + (item[3] >> 24) % 24) << 23);
        }
    }
}

fn params_wgsl(params: &Params) -> String {
    let words: Vec<String> = bytemuck::cast::<Params, [i32; 12]>(*params)
        .iter()
        .enumerate()
        .map(|(k, word)| match k {
            1 | 2 | 8 => format!("{word}"),
            _ => format!("{}u", *word as u32),
        })
        .collect();
    format!("HgParams({})", words.join(", "))
}

#[test]
fn keys_are_equal_for_any_bits() {
    let Some(mut backend) = gpu::backend() else { return };
    let mut items = inputs();
    tame(&mut items);
    let usual = Settings::default();
    let settings = [
        ("keys, usual", usual),
        ("keys, tiny cells", Settings { base_size: 2.0_f32.powi(-30), cell_footprints: 2.0_f32.powi(-10), ..usual }),
        ("keys, huge cells", Settings { base_size: 2.0_f32.powi(20), cell_footprints: 65_536.0, ..usual }),
        ("keys, no jitter", Settings { jitter: 0.0, normal_bins: 1, pixel_angle: 0.0, seed: u32::MAX, ..usual }),
        ("keys, wide pixels", Settings { pixel_angle: 4.0, normal_bins: 7, quantum: Quantum::for_scale(1e6), ..usual }),
    ];
    for (name, settings) in settings {
        let params = Params::new(&settings).expect("valid settings");
        for (salt, label) in [(SALT_DEPOSIT, name), (SALT_LOOKUP, format!("{name}, lookup").leak())] {
            let body = format!(
                "var v = HcVertexRecord();
                 v.position_footprint = bitcast<vec4<f32>>(vec4<u32>(word2(0u), word2(2u)));
                 v.normal = word(4u); v.direction = word(5u); v.seed = word(6u); v.flags = HC_VALID;
                 let key = hg_key({}, v, {salt}u);
                 put(3u, key.attributes);
                 if key.attributes == HG_NO_KEY {{ put2(0u, vec2<u32>()); put(2u, 0u); put2(4u, vec2<u32>()); return; }}
                 let cell = bitcast<vec3<u32>>(key.cell);
                 put2(0u, cell.xy); put(2u, cell.z);
                 put(4u, hg_home(key)); put(5u, hg_fingerprint(key));",
                params_wgsl(&params)
            );
            let found = call(&mut backend, label, &[HASH, JITTER, PACK, LEVEL, RECORD, WGSL_KEY], &body, &items);
            let expected = expect(&items, |item| match key(&params, &vertex(item), salt) {
                None => [0, 0, 0, u32::MAX, 0, 0],
                Some(key) => {
                    let [x, y, z] = key.cell.map(|c| c as u32);
                    [x, y, z, key.attributes, home(&key), fingerprint(&key)]
                }
            });
            let with_key = expected.iter().filter(|words| words[3] != u32::MAX).count();
            assert!(with_key > items.len() / 3, "{label}: only {with_key} of {} have keys", items.len());
            for (item, (e, f)) in items.iter().zip(expected.iter().zip(&found)) {
                assert!(e == f, "{label} of {item:x?}: {e:x?} in Rust, {f:x?} in WGSL");
            }
        }
    }
}

/// The way from level to level, for any cell and any attributes.
#[test]
fn levels_of_keys_are_equal() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let of = |item: &Item| Key {
        // As far as a doubled coordinate stays in 32 bits.
        cell: [item[0], item[1], item[2]].map(|c| c as i32 >> 2),
        attributes: (item[3] & 0xffff_ff00) | (item[4] & 31),
    };
    let key = "let key = HgKey(vec3<i32>(word_i32(0u), word_i32(1u), word_i32(2u)) >> vec3<u32>(2u),
                            (word(3u) & 0xffffff00u) | (word(4u) & 31u));
               let offset = hg_coarser_offset(word(4u) & 31u);";
    let put = "put(0u, bitcast<u32>(other.cell.x)); put(1u, bitcast<u32>(other.cell.y));
               put(2u, bitcast<u32>(other.cell.z)); put(3u, other.attributes); put(4u, bitcast<u32>(offset));";
    let words = |key: &Key, other: Option<Key>| {
        let other = other.unwrap_or(Key { cell: [0; 3], attributes: u32::MAX });
        let [x, y, z] = other.cell.map(|c| c as u32);
        [x, y, z, other.attributes, coarser_offset(key.level()) as u32]
    };
    let modules = [HASH, JITTER, PACK, LEVEL, RECORD, WGSL_KEY];
    let body = format!("{key} let other = hg_coarser(key); {put}");
    let found = call(&mut backend, "coarser", &modules, &body, &items);
    assert!(found == expect(&items, |item| words(&of(item), coarser(&of(item)))));
    let body = format!("{key} let other = hg_finer(key, word(5u)); {put}");
    let found = call(&mut backend, "finer", &modules, &body, &items);
    assert!(found == expect(&items, |item| words(&of(item), finer(&of(item), item[5]))));
}

/// What layers and directions add, and the home that all normals of a place share.
#[test]
fn lobes_are_equal_for_any_direction() {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let params = Params::new(&Settings { seed: 77, ..Settings::default() }).expect("valid settings");
    for (name, layer, direction_bins, jitter) in [("lobe 3", 3, 15, 1.0), ("lobe 1", 1, 1, 0.5), ("lobe 0", 0, 0, 0.0)]
    {
        let lobe = Lobe::new(&LobeSettings { layer, direction_bins, jitter }).expect("valid settings");
        let direction_jitter = (jitter * 32_768.0 / direction_bins.max(1) as f32) as u32;
        let body = format!(
            "var v = HcVertexRecord();
             v.direction = word(0u); v.seed = word(1u);
             put(0u, hg_attributes(HgLobe({layer}u, {direction_bins}u, {direction_jitter}u), {}, v, word(2u)));
             put(1u, hg_place_home(HgKey(vec3<i32>(word_i32(3u), word_i32(4u), word_i32(5u)), word(6u))));",
            params_wgsl(&params)
        );
        let modules = [HASH, JITTER, PACK, LEVEL, RECORD, WGSL_KEY, WGSL_LOBE];
        let found = call(&mut backend, name, &modules, &body, &items);
        let expected = expect(&items, |item| {
            let [direction, seed, salt, x, y, z, attributes, _] = *item;
            let vertex = VertexRecord { direction, seed, ..bytemuck::Zeroable::zeroed() };
            let key = Key { cell: [x, y, z].map(|v| v as i32), attributes };
            [lobe.attributes(&params, &vertex, salt), place_home(&key)]
        });
        assert!(found == expected, "{name}");
    }
}
