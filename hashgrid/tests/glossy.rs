//! Directions, layers and similar normals.

use std::collections::BTreeSet;

use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashgrid::jitter::{SALT_DEPOSIT, SALT_LOOKUP};
use hashgrid::key::{NO_KEY, fingerprint, home, key};
use hashgrid::keyed::{claim_keyed, deposit_keyed, estimate_keyed, name_keyed};
use hashgrid::layout::{Lasting, Layout, Standard};
use hashgrid::lobe::{Lobe, LobeSettings, MAX_LAYER};
use hashgrid::names::Naming;
use hashgrid::similar::{claim_similar, deposit_similar, estimate_similar, place_home};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{Params, Settings, Table, Word};

fn storage<L: Layout>(cells: usize, params: &Params) -> Vec<Word> {
    let words: Vec<Word> = (0..cells * L::WORDS).map(|_| Word::new(7)).collect();
    Table::<L>::with_layout(&words, params).expect("storage of a test").clear();
    words
}

fn params(jitter: f32, normal_bins: u32) -> Params {
    let settings = Settings { base_size: 1.0 / 64.0, jitter, normal_bins, max_probes: 64, ..Settings::default() };
    Params::new(&settings).unwrap()
}

fn unit(a: f32, b: f32, c: f32) -> Vec3 {
    Vec3::new(a - 0.5, b - 0.5, c - 0.5).normalize_or(Vec3::Z)
}

/// Vertices on a sphere of 1 m, seen from all around; light as `light(normal, direction)`, noisy.
fn sphere(count: u32, seed: u32, light: impl Fn(Vec3, Vec3) -> f32) -> Vec<VertexRecord> {
    (0..count)
        .map(|i| {
            let [a, b, c, d] = pcg4d([i, seed, 1, 2]).map(to_unit_f32);
            let [e, f, g, _] = pcg4d([i, seed, 3, 4]).map(to_unit_f32);
            let (normal, direction) = (unit(a, b, c), unit(e, f, g));
            VertexRecord {
                position_footprint: [normal.x, normal.y, normal.z, 0.02],
                direct: [2.0 * d * light(normal, direction); 4],
                normal: octahedral_encode(normal),
                direction: octahedral_encode(direction),
                seed: i ^ (seed << 20),
                flags: VertexRecord::VALID,
                ..VertexRecord::zeroed()
            }
        })
        .collect()
}

/// Layers and directions of any settings end in keys of their own; without either the key is the plain one.
#[test]
fn lobes_tell_layers_and_directions_apart() {
    let params = params(1.0, 15);
    let vertices = sphere(500, 1, |_, _| 1.0);
    let mut bins = BTreeSet::new();
    for direction_bins in [0, 1, 3, 15] {
        for layer in 0..=MAX_LAYER {
            let lobe = Lobe::new(&LobeSettings { layer, direction_bins, jitter: 1.0 }).unwrap();
            for vertex in &vertices {
                for salt in [SALT_DEPOSIT, SALT_LOOKUP] {
                    let (plain, found) =
                        (key(&params, vertex, salt).unwrap(), lobe.key(&params, vertex, salt).unwrap());
                    assert_eq!((found.cell, found.level()), (plain.cell, plain.level()));
                    assert_eq!((found.normal_bin(), found.layer()), (plain.normal_bin(), layer));
                    assert_eq!(found.direction_bin().is_some(), direction_bins > 0);
                    assert!(found.direction_bin().is_none_or(|bin| bin < 6 * direction_bins * direction_bins));
                    assert_eq!(found == plain, layer == 0 && direction_bins == 0);
                    assert_ne!(found.attributes, NO_KEY);
                    bins.extend(found.direction_bin());
                }
            }
        }
    }
    assert!(bins.len() > 500, "{}", bins.len());
    let good = LobeSettings { layer: 0, direction_bins: 3, jitter: 0.5 };
    for bad in [
        LobeSettings { layer: 4, ..good },
        LobeSettings { direction_bins: 4, ..good },
        LobeSettings { direction_bins: 17, ..good },
        LobeSettings { jitter: f32::NAN, ..good },
        LobeSettings { jitter: 1.5, ..good },
    ] {
        let error = Lobe::new(&bad);
        assert!(matches!(error, Err(ParamError::OutOfRange { .. } | ParamError::NotFinite { .. })), "{bad:?}");
    }
}

/// The direction's jitter is its own: it moves by up to half a bin, while nothing else moves.
#[test]
fn directions_have_a_jitter_of_their_own() {
    let params = params(0.0, 3);
    let lobe = |jitter| Lobe::new(&LobeSettings { layer: 1, direction_bins: 3, jitter }).unwrap();
    let (mut moved, vertices) = (0, sphere(4000, 2, |_, _| 1.0));
    for vertex in &vertices {
        let still = lobe(0.0).key(&params, vertex, SALT_DEPOSIT).unwrap();
        let loose = lobe(1.0).key(&params, vertex, SALT_DEPOSIT).unwrap();
        assert_eq!((still.cell, still.normal_bin(), still.level()), (loose.cell, loose.normal_bin(), loose.level()));
        moved += u32::from(still != loose);
    }
    // Uniform in two axes by up to half a bin: a quarter crosses a border in each.
    assert!((1400..2100).contains(&moved), "{moved}");
    let mut straight = vertices[0];
    straight.direction = octahedral_encode(Vec3::NEG_Y);
    let bins: BTreeSet<_> = (0..100)
        .map(|seed| lobe(1.0).key(&params, &VertexRecord { seed, ..straight }, SALT_DEPOSIT).unwrap().direction_bin())
        .collect();
    assert_eq!(bins.len(), 1, "a direction along an axis stays in the middle bin");
}

/// A mirror-like layer in cells that know directions beside a diffuse one in the same table: each gets its own light.
#[test]
fn glossy_and_diffuse_layers_share_a_table() {
    let params = params(1.0, 3);
    let coarse =
        Params::new(&Settings { cell_footprints: 16.0, base_size: 1.0 / 64.0, ..Settings::default() }).unwrap();
    let words = storage::<Lasting>(1 << 15, &params);
    let table = Table::<Lasting>::with_layout(&words, &params).unwrap();
    let diffuse = Lobe::new(&LobeSettings { layer: 0, direction_bins: 0, jitter: 0.0 }).unwrap();
    let glossy = Lobe::new(&LobeSettings { layer: 1, direction_bins: 3, jitter: 1.0 }).unwrap();
    let shine = |_: Vec3, direction: Vec3| if direction.y > 0.0 { 4.0 } else { 0.5 };
    let (flat, glint) = (sphere(8000, 3, |_, _| 1.0), sphere(20_000, 4, shine));
    let mut counters = Counters::default();
    for (lobe, params, vertices) in [(diffuse, &params, &flat), (glossy, &coarse, &glint)] {
        let key_of = |vertex: &VertexRecord| lobe.key(params, vertex, SALT_DEPOSIT);
        assert!(!claim_keyed(&table, vertices, key_of));
        name_keyed(&table, vertices, key_of, Naming::First);
        name_keyed(&table, vertices, key_of, Naming::Second);
        deposit_keyed(&table, params, vertices, key_of, &mut counters);
    }
    assert_eq!((counters.balance(), counters.refusals), (0, 0));
    assert_eq!(table.validate().expect("valid").energy, counters.energy_stored);
    let mean = |lobe: Lobe, params: &Params, vertices: &[VertexRecord], wanted: &dyn Fn(Vec3) -> bool| {
        let (mut sum, mut count) = (0.0, 0.0);
        let key_of = |vertex: &VertexRecord, salt| lobe.key(params, vertex, salt);
        estimate_keyed(&table, params, vertices, key_of, &mut Counters::default(), |i, estimate| {
            let direction = hashcache_core::pack::octahedral_decode(vertices[i].direction);
            if wanted(direction) {
                sum += f64::from(estimate.direct.x);
                count += 1.0;
            }
        });
        sum / count
    };
    assert!((mean(diffuse, &params, &flat, &|_| true) - 1.0).abs() < 0.05);
    // Far from the border of both halves each sees its own light; without directions both would see 2.25.
    assert!((mean(glossy, &coarse, &glint, &|direction| direction.y > 0.7) - 4.0).abs() < 0.2);
    assert!((mean(glossy, &coarse, &glint, &|direction| direction.y < -0.7) - 0.5).abs() < 0.2);
}

/// All normals of a place begin at one slot, and other places elsewhere.
#[test]
fn a_place_has_one_home() {
    let params = params(0.0, 5);
    let mut vertex = sphere(1, 5, |_, _| 1.0)[0];
    let homes: BTreeSet<_> = (0..200)
        .map(|i| {
            let [a, b, c, _] = pcg4d([i, 6, 6, 6]).map(to_unit_f32);
            vertex.normal = octahedral_encode(unit(a, b, c));
            let key = key(&params, &vertex, SALT_DEPOSIT).unwrap();
            (place_home(&key), fingerprint(&key), home(&key))
        })
        .collect();
    assert_eq!(homes.iter().map(|(place, ..)| place).collect::<BTreeSet<_>>().len(), 1);
    assert!(homes.len() > 50);
}

/// Mean squared errors of plain lookups and of the search among similar normals, on a sphere lit from above.
#[test]
fn similar_normals_help_where_vertices_are_few() {
    let params = params(1.0, 5);
    let lit = |normal: Vec3, _: Vec3| normal.y.max(0.0);
    let truth = |vertex: &VertexRecord| f64::from(hashcache_core::pack::octahedral_decode(vertex.normal).y.max(0.0));
    for (count, wins) in [(1500, true), (60_000, false)] {
        let vertices = sphere(count, 8, lit);
        let words: Vec<_> = (0..2).map(|_| storage::<Standard>(1 << 14, &params)).collect();
        let [apart, place] = [0, 1].map(|k| Table::<Standard>::with_layout(&words[k], &params).unwrap());
        let mut counters = [Counters::default(); 2];
        claim_vertices(&apart, &params, &vertices);
        deposit_vertices(&apart, &params, &vertices, &mut counters[0]);
        claim_similar(&place, &params, &vertices);
        deposit_similar(&place, &params, &vertices, &mut counters[1]);
        assert_eq!((counters[1].balance(), counters[1].refusals), (0, 0));
        assert_eq!(place.validate().expect("valid").energy, apart.validate().expect("valid").energy);
        let (mut plain, mut similar, mut least) = (0.0, 0.0, 0);
        estimate_vertices(&apart, &params, &vertices, &mut counters[0], |i, estimate| {
            plain += (f64::from(estimate.direct.x) - truth(&vertices[i])).powi(2);
        });
        estimate_similar(&place, &params, &vertices, 6, &mut counters[1], |i, estimate| {
            similar += (f64::from(estimate.direct.x) - truth(&vertices[i])).powi(2);
            least += u32::from(estimate.samples >= 6);
        });
        assert_eq!(counters[0].hits + counters[0].fallbacks, counters[1].hits + counters[1].fallbacks);
        let most = if wins { 0.8 * plain } else { 1.1 * plain };
        assert!(similar < most, "{count} vertices: error {plain} in the key, {similar} by probing");
        let probes = counters.map(|counters| counters.probes);
        assert!(probes[1] > probes[0] && least > 0, "{count} vertices: {probes:?} probes, {least} with enough");
    }
}

/// Without a search both answer alike: the cells are the same, only elsewhere.
#[test]
fn probing_finds_what_keys_find() {
    let params = params(1.0, 3);
    let vertices = sphere(4000, 9, |normal, _| normal.x.abs());
    let words: Vec<_> = (0..2).map(|_| storage::<Standard>(1 << 14, &params)).collect();
    let [apart, place] = [0, 1].map(|k| Table::<Standard>::with_layout(&words[k], &params).unwrap());
    let (mut counters, mut expected) = (Counters::default(), vec![]);
    claim_vertices(&apart, &params, &vertices);
    deposit_vertices(&apart, &params, &vertices, &mut counters);
    claim_similar(&place, &params, &vertices);
    deposit_similar(&place, &params, &vertices, &mut counters);
    estimate_vertices(&apart, &params, &vertices, &mut counters, |_, estimate| expected.push(estimate));
    estimate_similar(&place, &params, &vertices, 0, &mut counters, |i, estimate| assert_eq!(estimate, expected[i]));
}
