//! The kernels' host bodies, the owning wrappers, and the cache's stages as far as they need no backend.

use alloc::vec;
use alloc::vec::Vec;
use core::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use backend_api::{Kernel, Launch, Slot, Status};
use bytemuck::Zeroable;
use hashcache_core::counters::Counters;
use hashcache_core::geometry::{Instance, Mesh};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::{EstimateRecord, hit_from_record, hit_to_record};
use hashcache_core::traits::RadianceCache;
use hashcache_core::wgsl;
use hashgrid::kernels::{CLAIM, CLEAR, DEPOSIT, LOOKUP};
use hashgrid::{CELL_WORDS, OwnedGrid};
use layered_filter::kernels::{BILATERAL, COMPOSE, FILL, FilterCounters, GATHER, ImageParams, PREPARE};
use layered_filter::{
    CrossBilateral, Direct, GatherParams, GuideScale, LayerPixel, Light, PreparedGuide, WeightSettings, Weights,
};
use pt_integrator::camera::CameraRays;
use pt_integrator::film::FilmPixel;
use pt_integrator::kernels::{RESOLVE, TRACE_FILM, TraceParams, VisibleParams, trace_records, trace_visible};
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts};
use pt_integrator::scene::{Environment, Material, SceneData, TriangleShading};

use crate::checks::Checks;
use crate::floor::{CORNERS, Floor};
use crate::{grid, integrator};

const CELLS: usize = 64;
const PIXELS: u32 = 4;

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    checks.that("wgsl", wgsl::ALL.iter().all(|module| module.contains("HC_") || module.contains("fn hc_")));
    checks.that("stages::hit_to_record", hit_from_record(&hit_to_record(None)).is_none());
    owned(checks);
    let Some(records) = traced(checks) else { return checks.that("PackedScene::new", false) };
    cached(checks, &records);
}

/// Runs all items in one launch; the flags that were raised.
fn launch<const N: usize>(kernel: &Kernel, params: &[u8], count: u32, slots: [Slot<'_>; N]) -> Status {
    let status = AtomicU32::new(0);
    // Bound anew, so that their lifetime shrinks to the status word's.
    let mut slots: [Slot<'_>; N] = slots;
    (kernel.body)(&mut Launch { first: 0, count, params, slots: &mut slots, status: &status, rays: Some(&Floor) });
    Status::from_bits(status.load(Relaxed))
}

fn words(count: usize) -> Vec<AtomicU64> {
    (0..count).map(|_| AtomicU64::new(0)).collect()
}

fn owned(checks: &mut Checks) {
    let Some(params) = grid::params() else { return checks.that("Params::new", false) };
    let Ok(mut cache) = OwnedGrid::new(params, CELLS) else { return checks.that("OwnedGrid::new", false) };
    let vertices = grid::vertices();
    for vertex in &vertices {
        cache.record(vertex);
    }
    cache.end_frame();
    checks.that("OwnedGrid", cache.estimate(&vertices[0]).samples == 4 && cache.counters().balance() == 0);
}

/// Records of the floor under a sky, and the same light through the film.
fn traced(checks: &mut Checks) -> Option<Vec<VertexRecord>> {
    let scene = SceneData {
        positions: CORNERS.to_vec(),
        indices: vec![[0, 1, 2]],
        meshes: vec![Mesh { first_triangle: 0, triangle_count: 1 }],
        instances: vec![Instance::identity(0)],
        triangle_shading: vec![TriangleShading::flat(0)],
        materials: vec![Material::lambert([0.5; 3])],
        environment: Some(Environment::Constant([1.0; 3])),
        ..SceneData::default()
    };
    let packed = PackedScene::new(&scene).ok()?;
    let settings = PathSettings::default();
    let params = TraceParams {
        camera: CameraRays::new(&integrator::camera()?),
        width: 2,
        first_pixel: 0,
        first_sample: 0,
        samples: 2,
        seed: 1,
        max_bounces: settings.max_bounces,
        roulette_depth: settings.roulette_depth,
        store_length: u32::MAX,
    };
    let visible = VisibleParams {
        camera: params.camera,
        width: 2,
        first_pixel: 0,
        sample: 0,
        seed: 1,
        direct_samples: 1,
        direct_candidates: 1,
        direct_scattered: 1,
        max_bounces: settings.max_bounces,
    };
    let (params, visible) = (bytemuck::bytes_of(&params), bytemuck::bytes_of(&visible));
    let counters = words(RayCounts::WORDS);
    let mut film = [FilmPixel::default(); PIXELS as usize];
    let mut records: Vec<VertexRecord> = vec![Zeroable::zeroed(); PIXELS as usize];
    let mut asked = records.clone();
    let mut pairs: Vec<VertexRecord> = vec![Zeroable::zeroed(); 2 * PIXELS as usize];
    for (kernel, params, out) in [
        (&TRACE_FILM, params, bytemuck::cast_slice_mut(&mut film)),
        (trace_records(2)?, params, bytemuck::cast_slice_mut::<VertexRecord, u8>(&mut pairs)),
        (trace_records(1)?, params, bytemuck::cast_slice_mut::<VertexRecord, u8>(&mut records)),
        (trace_visible(1)?, visible, bytemuck::cast_slice_mut::<VertexRecord, u8>(&mut asked)),
    ] {
        let slots = [
            Slot::In(packed.triangle_bytes()),
            Slot::In(packed.scene_bytes()),
            Slot::In(packed.texel_bytes()),
            Slot::Out(out),
            Slot::AtomicU64(&counters),
        ];
        checks.that(kernel.name, launch(kernel, params, PIXELS, slots) == Status::OK);
    }
    checks.that("pt film", film.iter().all(|pixel| is_half(pixel) && pixel.mean().w > 1.5));
    checks.that("pt records", records.iter().all(VertexRecord::is_recordable));
    checks.that("pt kept", pairs.chunks(2).zip(&records).all(|(pair, first)| pair[0] == *first && !pair[1].is_valid()));
    checks.that("pt visible", asked.iter().all(|v| v.is_valid() && !v.is_recordable() && v.direct[0] > 0.5));

    let mut image = [[0.0_f32; 4]; PIXELS as usize];
    let slots = [Slot::In(bytemuck::cast_slice(&film)), Slot::Out(bytemuck::cast_slice_mut(&mut image))];
    checks.that(RESOLVE.name, launch(&RESOLVE, &[], PIXELS, slots) == Status::OK);
    checks.that("pt image", image.iter().all(|rgba| (rgba[0] - 0.5).abs() < 1e-5));
    Some(records)
}

/// The records through the grid, and its answers into the film.
fn cached(checks: &mut Checks, records: &[VertexRecord]) {
    let Some(params) = grid::params() else { return checks.that("Params::new", false) };
    let params = bytemuck::bytes_of(&params);
    let (table, counters) = (words(CELLS * CELL_WORDS), words(Counters::WORDS));
    let mut estimates: Vec<EstimateRecord> = vec![Zeroable::zeroed(); records.len()];
    let records = bytemuck::cast_slice(records);
    checks.that(CLEAR.name, launch(&CLEAR, params, CELLS as u32, [Slot::AtomicU64(&table)]) == Status::OK);
    checks.that(CLAIM.name, launch(&CLAIM, params, PIXELS, [Slot::AtomicU64(&table), Slot::In(records)]) == Status::OK);
    let slots = [Slot::AtomicU64(&table), Slot::In(records), Slot::AtomicU64(&counters)];
    checks.that(DEPOSIT.name, launch(&DEPOSIT, params, PIXELS, slots) == Status::OK);
    let slots = [
        Slot::AtomicU64(&table),
        Slot::In(records),
        Slot::AtomicU64(&counters),
        Slot::Out(bytemuck::cast_slice_mut(&mut estimates)),
    ];
    checks.that(LOOKUP.name, launch(&LOOKUP, params, PIXELS, slots) == Status::OK);
    checks.that("grid estimates", estimates.iter().all(|e| (e.direct[0] - 1.0).abs() < 1e-5 && e.direct[3] > 0.5));

    filtered(checks, records, bytemuck::cast_slice(&estimates));
}

/// The same pixels through the filter, as a picture of 2×2.
fn filtered(checks: &mut Checks, records: &[u8], estimates: &[u8]) {
    let settings = WeightSettings::surface(0.01);
    let (Ok(gather), Ok(scale)) = (GatherParams::new(0.01, Direct::Estimate, 1, 1), GuideScale::new(10.0)) else {
        return checks.that("GatherParams::new", false);
    };
    let (Ok(weights), Ok(denoiser)) = (Weights::new(&settings), CrossBilateral::new(&settings, 2.0, 1, 0)) else {
        return checks.that("CrossBilateral::new", false);
    };
    let mut sums: [LayerPixel; PIXELS as usize] = Zeroable::zeroed();
    let slots = [Slot::In(records), Slot::In(estimates), Slot::Out(bytemuck::cast_slice_mut(&mut sums))];
    checks.that(GATHER.name, launch(&GATHER, bytemuck::bytes_of(&gather), PIXELS, slots) == Status::OK);

    let mut guides = [PreparedGuide::NONE; PIXELS as usize];
    let mut images = [[Light::default(); PIXELS as usize]; 4];
    let [direct, further, filled, radiance] = &mut images;
    let counters = words(FilterCounters::WORDS);
    let slots = [
        Slot::In(bytemuck::cast_slice(&sums)),
        Slot::Out(bytemuck::cast_slice_mut(&mut guides)),
        Slot::Out(bytemuck::cast_slice_mut(direct)),
        Slot::Out(bytemuck::cast_slice_mut(further)),
        Slot::AtomicU64(&counters),
    ];
    checks.that(PREPARE.name, launch(&PREPARE, bytemuck::bytes_of(&scale), PIXELS, slots) == Status::OK);

    let guides = bytemuck::cast_slice(&guides);
    let size = ImageParams { width: 2, height: 2, pass: 0, first: 0 };
    let params = [bytemuck::bytes_of(&size), bytemuck::bytes_of(&weights)].concat();
    let slots = [
        Slot::In(guides),
        Slot::In(bytemuck::cast_slice(further)),
        Slot::Out(bytemuck::cast_slice_mut(filled)),
        Slot::AtomicU64(&counters),
    ];
    checks.that(FILL.name, launch(&FILL, &params, PIXELS, slots) == Status::OK);
    let params = [bytemuck::bytes_of(&size), bytemuck::bytes_of(&denoiser)].concat();
    let slots =
        [Slot::In(guides), Slot::In(bytemuck::cast_slice(filled)), Slot::Out(bytemuck::cast_slice_mut(further))];
    checks.that(BILATERAL.name, launch(&BILATERAL, &params, PIXELS, slots) == Status::OK);

    let slots = [
        Slot::In(bytemuck::cast_slice(&sums)),
        Slot::In(bytemuck::cast_slice(direct)),
        Slot::In(bytemuck::cast_slice(further)),
        Slot::Out(bytemuck::cast_slice_mut(radiance)),
    ];
    let status = launch(&COMPOSE, &[], PIXELS, slots);
    let half = |light: &Light| light[..3].iter().all(|v| (v - 0.5).abs() < 1e-5);
    checks.that(COMPOSE.name, status == Status::OK && radiance.iter().all(half));
}

fn is_half(pixel: &FilmPixel) -> bool {
    (pixel.mean().truncate() - 0.5).abs().max_element() < 1e-5
}
