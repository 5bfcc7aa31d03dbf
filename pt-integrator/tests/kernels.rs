//! Kernels as a backend runs them, in launches of any cut.
#![allow(
    clippy::disallowed_methods,
    clippy::float_cmp,
    reason = "expectations come from the platform's functions and exact values"
)]

mod common;

use std::sync::atomic::{AtomicU32, AtomicU64};

use backend_api::{HitRecord, Kernel, Launch, RayRecord, Slot, Status, TraceRays};
use bytemuck::{Zeroable, bytes_of, cast_slice, cast_slice_mut};
use common::caster::BruteForce;
use common::mixed::room;
use common::scenes::{add_triangles, inward_box, quad};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::from_record;
use hashcache_core::traits::{RayCaster, Sampler};
use pt_integrator::camera::CameraRays;
use pt_integrator::film::{FilmPixel, MomentPixel, PairedPixel};
use pt_integrator::glam::Vec3;
use pt_integrator::kernels::{
    FIRST_VERTICES, FirstParams, RESOLVE, RESOLVE_MOMENTS, TRACE_FILM, TRACE_MOMENTS, TRACE_PAIRS, TRACE_RECORDS,
    TRACE_VISIBLE, TraceParams, VisibleParams, trace_records, trace_visible,
};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{self, MAX_LAYERS, PathOutcome, PathSettings, RayCounts, Strategy, VisibleSettings};
use pt_integrator::sampler::{Sobol, pixel_seed, vertex_seed};
use pt_integrator::scene::{Camera, Material, SceneData};

struct Rays(BruteForce);

impl TraceRays for Rays {
    fn trace_closest(&self, ray: &RayRecord) -> HitRecord {
        match self.0.closest(&from_record(ray)) {
            Some(h) => HitRecord { t: h.t, u: h.u, v: h.v, triangle: h.triangle, instance: h.instance },
            None => HitRecord { t: 0.0, u: 0.0, v: 0.0, triangle: HitRecord::MISS, instance: 0 },
        }
    }

    fn trace_occluded(&self, ray: &RayRecord) -> bool {
        self.0.occluded(&from_record(ray))
    }
}

const SIZE: [u32; 2] = [12, 9];
const PIXELS: u32 = SIZE[0] * SIZE[1];

fn scene(emission: f32) -> SceneData {
    let mut scene = SceneData::default();
    let walls = Material::lambert([0.7, 0.5, 0.3]);
    // Bright walls all around: their sum leaves the range of f32.
    let walls = if emission > 1e30 { Material { emission: [emission, 0.0, 0.0, 0.0], ..walls } } else { walls };
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.0), Vec3::ONE), walls);
    let lamp = quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.2; 3], [emission, 0.5 * emission, 1.0]));
    scene
}

fn params(samples: u32, first_sample: u32) -> TraceParams {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO, Vec3::Y, 1.0, SIZE[0], SIZE[1]).unwrap();
    TraceParams {
        camera: CameraRays::new(&camera),
        width: SIZE[0],
        first_pixel: 0,
        first_sample,
        samples,
        seed: 5,
        max_bounces: 4,
        roulette_depth: PathSettings::NO_ROULETTE,
        store_length: u32::MAX,
    }
}

/// Runs a kernel whose output is binding `out`, in launches of `cut` items; returns the flags.
fn run(
    kernel: &Kernel,
    params: &[u8],
    inputs: &[&[u8]],
    out: &mut [u8],
    counters: Option<&[AtomicU64]>,
    rays: Option<&dyn TraceRays>,
    cut: usize,
) -> Status {
    let stride = kernel.bindings[inputs.len()].stride as usize;
    assert_eq!(params.len(), kernel.params_size as usize);
    let status = AtomicU32::new(0);
    for (i, chunk) in out.chunks_mut(cut * stride).enumerate() {
        let count = (chunk.len() / stride) as u32;
        let mut slots: Vec<Slot<'_>> = inputs.iter().map(|bytes| Slot::In(bytes)).collect();
        slots.push(Slot::Out(chunk));
        slots.extend(counters.map(Slot::AtomicU64));
        assert_eq!(slots.len(), kernel.bindings.len());
        (kernel.body)(&mut Launch { first: (i * cut) as u32, count, params, slots: &mut slots, status: &status, rays });
    }
    Status::from_bits(status.into_inner())
}

fn trace<T: bytemuck::Pod>(
    kernel: &Kernel,
    emission: f32,
    params: &impl bytemuck::Pod,
    out: &mut [T],
    cut: usize,
) -> (RayCounts, Status) {
    trace_in(&scene(emission), kernel, params, out, cut)
}

fn trace_in<T: bytemuck::Pod>(
    scene: &SceneData,
    kernel: &Kernel,
    params: &impl bytemuck::Pod,
    out: &mut [T],
    cut: usize,
) -> (RayCounts, Status) {
    let packed = PackedScene::new(scene).unwrap();
    let counters: [AtomicU64; RayCounts::WORDS] = Default::default();
    let inputs = [packed.triangle_bytes(), packed.scene_bytes(), packed.texel_bytes()];
    let rays = Rays(BruteForce::new(scene));
    let status = run(kernel, bytes_of(params), &inputs, cast_slice_mut(out), Some(&counters), Some(&rays), cut);
    (RayCounts::from_words(counters.map(AtomicU64::into_inner)), status)
}

#[test]
fn film_is_the_same_for_every_cut() {
    let mut whole = vec![FilmPixel::default(); PIXELS as usize];
    let (counts, status) = trace(&TRACE_FILM, 9.0, &params(3, 0), &mut whole, PIXELS as usize);
    assert_eq!((counts.paths, status), (u64::from(3 * PIXELS), Status::OK));
    assert!(counts.closest > counts.paths && counts.shadow_asked == counts.shadow_traced && counts.shadow_traced > 0);
    for cut in [1, 7, 50] {
        let mut film = vec![FilmPixel::default(); PIXELS as usize];
        assert_eq!(trace(&TRACE_FILM, 9.0, &params(3, 0), &mut film, cut), (counts, Status::OK));
        assert_eq!(film, whole);
    }
    // A batch that starts further on holds those pixels.
    let batch = TraceParams { first_pixel: 40, ..params(3, 0) };
    let mut film = vec![FilmPixel::default(); 16];
    trace(&TRACE_FILM, 9.0, &batch, &mut film, 5);
    assert_eq!(film, whole[40..56]);
}

/// Films that know more hold the same radiance.
#[test]
fn moments_and_pairs_are_films() {
    let mut film = vec![FilmPixel::default(); PIXELS as usize];
    trace(&TRACE_FILM, 9.0, &params(6, 0), &mut film, 64);
    let mut moments = vec![MomentPixel::default(); PIXELS as usize];
    trace(&TRACE_MOMENTS, 9.0, &params(6, 0), &mut moments, 7);
    assert!(moments.iter().zip(&film).all(|(with, pixel)| with.film == *pixel));
    let mut texels = vec![[0.0_f32; 4]; PIXELS as usize];
    run(&RESOLVE_MOMENTS, &[], &[cast_slice(&moments)], cast_slice_mut(&mut texels), None, None, 17);
    assert!(
        texels.iter().zip(&film).all(|(texel, pixel)| texel[..3] == pixel.mean().to_array()[..3] && texel[3] > 0.0)
    );

    // Pixels of any order; the first half is a film by the same seed, the second by the next one.
    let chosen = [40, 3, 107, 0];
    let mut pairs = chosen.map(PairedPixel::new);
    let (counts, status) = trace(&TRACE_PAIRS, 9.0, &params(6, 0), &mut pairs, 3);
    assert_eq!((counts.paths, status), (2 * 6 * 4, Status::OK));
    let mut next = vec![FilmPixel::default(); PIXELS as usize];
    trace(&TRACE_FILM, 9.0, &TraceParams { seed: 6, ..params(6, 0) }, &mut next, 64);
    for (pair, pixel) in pairs.iter().zip(chosen) {
        assert_eq!(pair.halves, [film[pixel as usize], next[pixel as usize]]);
        assert!(pair.pixel == pixel && pair.means()[0] != pair.means()[1]);
    }
}

#[test]
fn records_add_up_to_the_film() {
    let mut film = vec![FilmPixel::default(); PIXELS as usize];
    trace(&TRACE_FILM, 9.0, &params(2, 4), &mut film, 64);
    let mut traced = vec![FilmPixel::default(); PIXELS as usize];
    let mut seeds = Vec::new();
    for sample in [4, 5] {
        let mut records = vec![VertexRecord::zeroed(); PIXELS as usize];
        trace::<VertexRecord>(&TRACE_RECORDS, 9.0, &params(1, sample), &mut records, 10);
        assert!(records.iter().all(|r| r.flags == VertexRecord::VALID && r.position_footprint[3] > 0.0));
        seeds.extend(records.iter().map(|r| r.seed));
        traced.iter_mut().zip(&records).for_each(|(pixel, record)| pixel.add(record.radiance()));
    }
    assert_eq!(traced, film);
    seeds.sort_unstable();
    seeds.dedup();
    assert_eq!(seeds.len(), 2 * PIXELS as usize, "seeds are unique");

    let mut radiance = vec![[0.0_f32; 4]; PIXELS as usize];
    run(&RESOLVE, &[], &[cast_slice(&film)], cast_slice_mut(&mut radiance), None, None, 17);
    assert!(radiance.iter().zip(&film).all(|(texel, pixel)| *texel == pixel.mean().to_array() && texel[3] == 2.0));
}

/// Kernels for every number of kept vertices: the same path, seen by more records.
#[test]
fn further_vertices_stand_behind_the_first() {
    assert!(trace_records(0).is_none() && trace_records(9).is_none() && trace_records(u32::MAX).is_none());
    let none = |count: u32| vec![VertexRecord::zeroed(); (count * PIXELS) as usize];
    let mut first = none(1);
    trace(&TRACE_RECORDS, 9.0, &params(1, 4), &mut first, 10);
    let mut names = vec![TRACE_FILM.name];
    names.extend((1..=8).map(|layers| trace_visible(layers).unwrap().name));
    assert!(trace_visible(0).is_none() && trace_visible(9).is_none() && trace_visible(u32::MAX).is_none());
    for store in 1..=8 {
        let kernel = trace_records(store).unwrap();
        assert!(kernel.is_well_formed());
        names.push(kernel.name);
        let mut records = none(store);
        let (counts, status) = trace(kernel, 9.0, &params(1, 4), &mut records, 10);
        assert_eq!((counts.paths, status), (u64::from(PIXELS), Status::OK));
        let mut cut = none(store);
        trace(kernel, 9.0, &params(1, 4), &mut cut, 7);
        assert_eq!(records, cut);
        let of_first = FirstParams { store, reserved: [0; 3] };
        let mut alone = none(1);
        let out = cast_slice_mut(&mut alone);
        run(&FIRST_VERTICES, bytes_of(&of_first), &[cast_slice(&records)], out, None, None, 13);
        assert_eq!(alone, first);
        let mut seeds: Vec<u32> = records.iter().map(|r| r.seed).collect();
        for (records, first) in records.chunks_exact(store as usize).zip(&first) {
            assert_eq!(records[0], *first);
            for pair in records.windows(2) {
                assert_eq!(pair[1].flags, VertexRecord::VALID | VertexRecord::SECONDARY);
                assert!(pair[1].position_footprint[3] > pair[0].position_footprint[3]);
                assert_eq!(pair[1].emitted, [0.0; 4]);
            }
        }
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), records.len(), "seeds are unique");
        // Without further light only the vertices' own is left.
        let short = TraceParams { store_length: 0, ..params(1, 4) };
        trace(kernel, 9.0, &short, &mut cut, 64);
        assert!(cut.iter().all(|r| r.further == [0.0; 4]));
        assert!(cut.iter().zip(&records).all(|(a, b)| (a.direct, a.normal) == (b.direct, b.normal)));
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 17, "names are unique");
    // A path that ends leaves nothing behind its end, not even a seed.
    let mut records = none(4);
    let ended = TraceParams { max_bounces: 0, ..params(1, 4) };
    trace(trace_records(4).unwrap(), 9.0, &ended, &mut records, 64);
    for records in records.chunks_exact(4) {
        assert!(!records[0].is_valid() && records[1..].iter().all(|r| *r == VertexRecord::zeroed()));
    }
}

fn asked(sample: u32, direct_samples: u32) -> VisibleParams {
    let TraceParams { camera, width, first_pixel, seed, .. } = params(1, 0);
    VisibleParams {
        camera,
        width,
        first_pixel,
        sample,
        seed,
        direct_samples,
        direct_candidates: 1,
        direct_scattered: u32::from(direct_samples > 0),
        max_bounces: 8,
    }
}

/// Every number of layers is written as the function finds them, with these numbers, in whatever cut.
#[test]
fn layers_are_the_functions() {
    const SALTS: [u32; 3] = [0x6c69_6768, 0x7363_6174, 0x6368_6169];
    let scene = room(None);
    let packed = PackedScene::new(&scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(&scene));
    let asked = VisibleParams { direct_candidates: 2, first_pixel: 20, ..asked(3, 2) };
    let of_layer = |seed, layer| if layer == 0 { seed } else { vertex_seed(seed, layer) };
    let mut filled = [0; MAX_LAYERS];
    for count in 1..=MAX_LAYERS {
        let mut records = vec![VertexRecord::zeroed(); count * 60];
        let kernel = trace_visible(count as u32).unwrap();
        assert!(kernel.is_well_formed());
        let (counts, status) = trace_in(&scene, kernel, &asked, &mut records, 60);
        assert_eq!(status, Status::OK);
        let mut cut = records.clone();
        assert_eq!(trace_in(&scene, kernel, &asked, &mut cut, 7), (counts, status));
        assert_eq!(records, cut);
        let mut expected_counts = RayCounts::default();
        for (item, records) in (0..).zip(records.chunks_exact(count)) {
            let pixel = asked.first_pixel + item;
            let seed = pixel_seed(pixel, asked.seed);
            let u = Sobol::new(asked.sample, seed).next_2d();
            let ray = asked.camera.ray([pixel % SIZE[0], pixel / SIZE[0]], u);
            let first = [asked.sample * 4, asked.sample, asked.sample];
            let settings = VisibleSettings { direct: asked.direct().for_scene(&view), ..asked.settings() };
            let numbers = |strategy: Strategy, layer, i: u32| {
                let seed = of_layer(vertex_seed(seed, SALTS[strategy as usize]), layer);
                Sobol::new(first[strategy as usize] + i, seed)
            };
            let mut layers = [PathOutcome::NONE; MAX_LAYERS];
            let found = &mut layers[..count];
            path::trace_visible(&view, &caster, &ray, &settings, found, numbers, &mut expected_counts);
            let seed = vertex_seed(seed, asked.sample);
            for (k, (record, outcome)) in (0..).zip(records.iter().zip(found)) {
                let mut expected = outcome.record(asked.camera.pixel_angle(), of_layer(seed, k));
                if outcome.has_vertex {
                    expected.flags |= VertexRecord::VISIBLE_ONLY;
                }
                if k > 0 && *outcome == PathOutcome::NONE {
                    expected = VertexRecord::zeroed();
                } else {
                    filled[k as usize] += 1;
                }
                assert_eq!(*record, expected, "{count} layers, pixel {pixel}, layer {k}");
            }
        }
        assert_eq!(counts, expected_counts);
    }
    assert!(filled.iter().all(|filled| *filled > 0), "every layer is used: {filled:?}");
}

/// Vertices that only ask stand where a path of the same index has its first vertex, in whatever cut.
#[test]
fn visible_vertices_are_those_of_paths() {
    let mut sums = [Vec3::ZERO; 2];
    for sample in 0..32 {
        let mut path = vec![VertexRecord::zeroed(); PIXELS as usize];
        trace(&TRACE_RECORDS, 9.0, &params(1, sample), &mut path, 64);
        let mut dark = path.clone();
        let (counts, status) = trace(&TRACE_VISIBLE, 9.0, &asked(sample, 0), &mut dark, 64);
        assert_eq!((counts.closest, counts.shadow_asked, status), (u64::from(PIXELS), 0, Status::OK));
        let mut lit = path.clone();
        trace(&TRACE_VISIBLE, 9.0, &asked(sample, 4), &mut lit, 64);
        let mut cut = path.clone();
        trace(&TRACE_VISIBLE, 9.0, &asked(sample, 4), &mut cut, 7);
        assert_eq!(lit, cut);
        for ((path, dark), lit) in path.iter().zip(&dark).zip(&lit) {
            let flags = VertexRecord::VALID | VertexRecord::VISIBLE_ONLY;
            assert!(!lit.is_recordable() && path.is_recordable());
            assert_eq!(*dark, VertexRecord { direct: [0.0; 4], further: [0.0; 4], flags, ..*path });
            assert_eq!(*lit, VertexRecord { direct: lit.direct, ..*dark });
            sums[0] += Vec3::from_slice(&path.direct);
            sums[1] += Vec3::from_slice(&lit.direct);
        }
    }
    assert!((sums[1] / sums[0] - Vec3::ONE).abs().max_element() < 0.03, "{} and {}", sums[1], sums[0]);
}

#[test]
fn light_beyond_numbers_is_reported() {
    let mut film = vec![FilmPixel::default(); PIXELS as usize];
    let (counts, status) = trace(&TRACE_FILM, 3e38, &params(1, 0), &mut film, 64);
    assert!(counts.non_finite > 0 && status.contains(Status::NON_FINITE));
    assert!(film.iter().all(|p| p.mean().is_finite() && p.mean().w == 1.0));
}
