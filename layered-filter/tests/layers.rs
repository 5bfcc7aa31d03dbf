//! Pictures of several layers on the CPU's backends, beside the plain functions and for the laws of their composition.

use backend_api::{Backend, Binding, BufferDesc};
use backend_cpu::CpuBackend;
use bytemuck::{Pod, Zeroable};
use hashcache_core::glam::{DVec3, Vec3};
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use hashcache_core::traits::Estimate;
use layered_filter::fill::fill;
use layered_filter::image::is_hole;
use layered_filter::{
    Behind, Carry, Composition, CrossBilateral, Direct, Filter, FilterSettings, FilterStages, FrontPixel, GatherParams,
    GuideScale, LayerPixel, Light, MAX_LAYERS, PreparedGuide, View, WeightSettings, filter,
};

const WIDTH: u32 = 41;
const HEIGHT: u32 = 23;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;
const ANGLE: f32 = 0.002;
const RADIUS: f32 = 10.0;

/// Records and estimates of a sample, `layers` of each for every pixel.
struct Sample {
    records: Vec<VertexRecord>,
    estimates: Vec<EstimateRecord>,
}

/// Left a mirror or glass, in the middle a rough floor, right a plain wall; behind them, other walls. Some chains end early.
fn sample(layers: u32, index: u32) -> Sample {
    let mut sample = Sample { records: Vec::new(), estimates: Vec::new() };
    for i in 0..PIXELS as u32 {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let mut goes_on = true;
        for layer in 0..layers {
            let r = pcg4d([i, index, layer, 9]).map(to_unit_f32);
            let shininess = [1.0, 0.5, 0.0][(x * 3 / WIDTH) as usize];
            let mirror = shininess > 0.9 && layer == 0;
            let normal = if (x + 7 * layer) / 13 % 2 == 0 { Vec3::Y } else { Vec3::Z };
            let surface = if mirror { VertexRecord::GUIDE } else { VertexRecord::VALID | VertexRecord::VISIBLE_ONLY };
            let depth = 1.0 + layer as f32;
            let record = VertexRecord {
                position_footprint: [x as f32 * 0.1, y as f32 * 0.1 * depth, 0.0, 0.004 * depth],
                direct: [r[0], r[1], 0.5, 0.0],
                throughput: if mirror { [0.0, 0.0, 0.0, 1.0] } else { [0.6 / depth, 0.3, 0.1 * r[2], shininess] },
                emitted: [0.0, 0.2 * r[3], 0.1 * r[2], 0.0],
                normal: octahedral_encode(normal),
                flags: surface | VertexRecord::layer_bits(layer),
                ..VertexRecord::zeroed()
            };
            let answered = if r[3] < 0.1 || x / 5 == 3 && y / 5 == 2 { 0.0 } else { 5.0 };
            let estimate = EstimateRecord { direct: [0.0, 0.0, 0.0, answered], further: [r[1], 0.2 * r[0], 0.3, 0.0] };
            sample.records.push(if goes_on { record } else { VertexRecord::zeroed() });
            sample.estimates.push(if goes_on && !mirror { estimate } else { EstimateRecord::zeroed() });
            goes_on &= mirror || shininess > 0.0 && r[2] < 0.7;
        }
    }
    sample
}

fn denoiser() -> CrossBilateral {
    let settings = WeightSettings::surface(ANGLE);
    CrossBilateral::new(&settings, 5.0, 1, 7).and_then(|filter| filter.with_radius_by_samples(100.0)).unwrap()
}

fn settings(layers: u32, composition: Composition, direct: Direct, filter: &Filter) -> FilterSettings {
    FilterSettings {
        width: WIDTH,
        height: HEIGHT,
        direct,
        radius: RADIUS,
        pixel_angle: ANGLE,
        further: *filter,
        direct_filter: *filter,
        carried: *filter,
        layers,
        composition,
    }
}

fn upload<T: Pod>(backend: &mut CpuBackend, values: &[T]) -> Binding {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let size = bytes.len() as u64;
    let buffer = backend.create(&BufferDesc { name: "samples", size }).unwrap();
    backend.write(buffer, 0, bytes).unwrap();
    Binding { buffer, offset: 0, size }
}

/// The picture of some samples. Pixels are gathered in two runs.
fn picture(backend: &mut CpuBackend, settings: &FilterSettings, samples: &[Sample]) -> Vec<Light> {
    let mut stages = FilterStages::new(settings).unwrap();
    stages.prepare(backend).unwrap();
    // What was there before does not matter.
    gather(backend, &stages, settings.layers, &samples[0]);
    stages.clear(backend).unwrap();
    for sample in samples {
        gather(backend, &stages, settings.layers, sample);
    }
    stages.filter(backend).unwrap();
    backend.submit().unwrap();
    backend.statuses().unwrap();
    let Binding { buffer, offset, size } = stages.radiance().unwrap();
    let ticket = backend.read(buffer, offset, size).unwrap();
    let image = bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).unwrap().unwrap());
    assert!(stages.sums(settings.layers - 1).is_some() && stages.sums(settings.layers).is_none());
    stages.release(backend).unwrap();
    image
}

fn gather(backend: &mut CpuBackend, stages: &FilterStages, layers: u32, sample: &Sample) {
    let half = 496;
    for (first, count) in [(0, half), (half, PIXELS as u32 - half)] {
        let range = (first * layers) as usize..((first + count) * layers) as usize;
        let records = upload(backend, &sample.records[range.clone()]);
        let estimates = upload(backend, &sample.estimates[range]);
        stages.gather(backend, records, layers, estimates, layers, first, count).unwrap();
    }
}

fn samples(layers: u32, count: u32) -> Vec<Sample> {
    (0..count).map(|index| sample(layers, index)).collect()
}

fn estimate(record: &EstimateRecord) -> Estimate {
    let EstimateRecord { direct: [r, g, b, samples], further: [x, y, z, variance] } = *record;
    Estimate { direct: Vec3::new(r, g, b), further: Vec3::new(x, y, z), samples: samples as u32, variance }
}

/// A layer's light by plain functions: holes filled, then filtered.
fn layer_light(view: &View<'_>, image: &[Light], filtered: bool) -> Vec<Light> {
    let denoiser = denoiser();
    let filled = (0..PIXELS as u32).map(|i| fill(denoiser.weights(), view, image, i % WIDTH, i / WIDTH).0);
    let mut filled: Vec<Light> = filled.collect();
    if filtered {
        filter(&denoiser, view, &mut filled, &mut vec![[0.0; 4]; PIXELS]);
    }
    filled
}

/// The same by the crate's plain functions.
fn model(layers: u32, composition: Composition, samples: &[Sample]) -> Vec<Light> {
    let scale = GuideScale::new(RADIUS).unwrap();
    let mut behind = vec![Behind::default(); PIXELS];
    for layer in (0..layers as usize).rev() {
        let params = GatherParams::new(ANGLE, Direct::Estimate, 1, 1).unwrap();
        let (mut pixels, mut fronts) = (vec![LayerPixel::zeroed(); PIXELS], vec![FrontPixel::zeroed(); PIXELS]);
        for sample in samples {
            for i in 0..PIXELS {
                let at = i * layers as usize + layer;
                pixels[i].add(&params, &sample.records[at], &estimate(&sample.estimates[at]));
                fronts[i].add(&params, &sample.records[at]);
            }
        }
        let carry = match composition {
            Composition::LayeredRough if layer + 1 < layers as usize => Some(Carry::Rough),
            Composition::Screen if layer == 0 && layers > 1 => Some(Carry::All),
            _ => None,
        };
        if let Some(carry) = carry {
            let taken: Vec<_> =
                fronts.iter().zip(&mut behind).map(|(front, behind)| behind.take(front, carry)).collect();
            let guides: Vec<_> = taken
                .iter()
                .zip(&fronts)
                .map(|(taken, front)| match taken {
                    Some(_) => PreparedGuide::of_front(&scale, front),
                    None => PreparedGuide::NONE,
                })
                .collect();
            let mut carried: Vec<Light> = taken.into_iter().map(Option::unwrap_or_default).collect();
            let view = View::new(WIDTH, HEIGHT, &guides).unwrap();
            filter(&denoiser(), &view, &mut carried, &mut vec![[0.0; 4]; PIXELS]);
            behind
                .iter_mut()
                .zip(&carried)
                .for_each(|(behind, light)| behind.give(Vec3::new(light[0], light[1], light[2])));
        }
        let guides: Vec<_> = pixels.iter().map(|pixel| PreparedGuide::of_pixel(&scale, pixel)).collect();
        let further: Vec<_> = pixels.iter().map(LayerPixel::further_light).collect();
        let view = View::new(WIDTH, HEIGHT, &guides).unwrap();
        let light = layer_light(&view, &further, composition != Composition::Screen || layer == 0);
        for ((behind, pixel), light) in behind.iter_mut().zip(&pixels).zip(&light) {
            let light = if is_hole(light) { Vec3::ZERO } else { Vec3::new(light[0], light[1], light[2]) };
            behind.add(pixel, light);
        }
    }
    behind.iter().map(|behind| behind.radiance().extend(0.0).to_array()).collect()
}

const ALL: [Composition; 3] = [Composition::Layered, Composition::LayeredRough, Composition::Screen];

#[test]
fn stages_are_the_plain_functions() {
    for layers in [1, 2, 4, MAX_LAYERS] {
        let samples = samples(layers, 3);
        for composition in ALL {
            let settings = settings(layers, composition, Direct::Estimate, &Filter::CrossBilateral(denoiser()));
            let image = picture(&mut CpuBackend::serial(), &settings, &samples);
            assert!(image.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
            let expected = model(layers, composition, &samples);
            assert!(image == expected, "{layers} layers, {composition:?}");
        }
    }
}

#[test]
fn a_single_layer_is_composed_in_one_way_only() {
    let samples = samples(1, 3);
    for direct in [Direct::Record, Direct::Estimate] {
        let of = |composition| {
            let settings = settings(1, composition, direct, &Filter::CrossBilateral(denoiser()));
            let stages = FilterStages::new(&settings).unwrap();
            let kernels = ["lf.gather", "lf.prepare", "lf.fill", "lf.bilateral", "lf.compose"];
            let bytes = if direct == Direct::Record { 272 } else { 256 };
            assert_eq!((stages.kernels(), stages.bytes()), (kernels.to_vec(), PIXELS as u64 * bytes + 48));
            picture(&mut CpuBackend::serial(), &settings, &samples)
        };
        let [first, rest @ ..] = ALL.map(of);
        assert!(rest.iter().all(|image| *image == first));
    }
}

/// Layers that are there and empty change no bit.
#[test]
fn empty_layers_add_nothing() {
    let one = samples(1, 3);
    let padded: Vec<Sample> = one
        .iter()
        .map(|sample| {
            let mut padded = Sample { records: Vec::new(), estimates: Vec::new() };
            for (record, estimate) in sample.records.iter().zip(&sample.estimates) {
                padded.records.extend([*record, VertexRecord::zeroed(), VertexRecord::zeroed()]);
                padded.estimates.extend([*estimate, EstimateRecord::zeroed(), EstimateRecord::zeroed()]);
            }
            padded
        })
        .collect();
    let filter = Filter::CrossBilateral(denoiser());
    for composition in ALL {
        let of = |layers, samples: &[Sample]| {
            let settings = settings(layers, composition, Direct::Record, &filter);
            picture(&mut CpuBackend::serial(), &settings, samples)
        };
        assert!(of(3, &padded) == of(1, &one), "{composition:?}");
    }
}

#[test]
fn threads_do_not_matter() {
    let samples = samples(3, 2);
    for composition in ALL {
        for direct in [Direct::Record, Direct::Estimate] {
            let settings = settings(3, composition, direct, &Filter::CrossBilateral(denoiser()));
            let serial = picture(&mut CpuBackend::serial(), &settings, &samples);
            let cut = picture(&mut CpuBackend::serial().with_launch_items(7), &settings, &samples);
            let rayon = picture(&mut CpuBackend::rayon(3).unwrap().with_launch_items(100), &settings, &samples);
            assert!(serial == cut && serial == rayon, "{composition:?}");
        }
    }
}

/// Without a denoiser a pixel is the mean of its samples' own radiance, over all layers.
#[test]
fn unfiltered_layers_are_means_of_chains() {
    let (layers, samples) = (4, samples(4, 3));
    for composition in ALL {
        let settings = settings(layers, composition, Direct::Record, &Filter::None);
        let image = picture(&mut CpuBackend::serial(), &settings, &samples);
        for (i, found) in image.iter().enumerate() {
            let (mut sum, mut holes) = (DVec3::ZERO, false);
            for sample in &samples {
                for at in i * layers as usize..(i + 1) * layers as usize {
                    let (record, estimate) = (&sample.records[at], estimate(&sample.estimates[at]));
                    let wide = |[r, g, b, _]: [f32; 4]| DVec3::new(r.into(), g.into(), b.into());
                    sum += wide(record.emitted);
                    if record.is_valid() {
                        sum += wide(record.throughput) * (wide(record.direct) + estimate.further.as_dvec3());
                        holes |= estimate.samples == 0;
                    }
                }
            }
            // A hole takes its light from elsewhere.
            if !holes {
                let [r, g, b, _] = found.map(f64::from);
                assert!((DVec3::new(r, g, b) - sum / 3.0).abs().max_element() < 2e-6, "{composition:?} at {i}");
            }
        }
    }
}

/// The same illumination everywhere, the same throughput on each surface: nothing to filter, so nothing changes.
#[test]
fn flat_pictures_stay_flat() {
    let layers = 3;
    let mut samples = samples(layers, 2);
    for sample in &mut samples {
        for (i, (record, estimate)) in sample.records.iter_mut().zip(&mut sample.estimates).enumerate() {
            let layer = i % layers as usize;
            let shininess = if layer + 1 < layers as usize { 0.3 } else { 0.0 };
            *record = VertexRecord {
                throughput: [0.5, 0.25, 0.125, shininess],
                emitted: [0.25, 0.0, 0.0, 0.0],
                flags: VertexRecord::VALID,
                position_footprint: [i as f32, 0.0, 0.0, 0.01],
                normal: octahedral_encode(Vec3::Y),
                ..VertexRecord::zeroed()
            };
            *estimate = EstimateRecord { direct: [0.0, 0.0, 0.0, 3.0], further: [2.0, 4.0, 8.0, 0.0] };
        }
    }
    for composition in ALL {
        let settings = settings(layers, composition, Direct::Estimate, &Filter::CrossBilateral(denoiser()));
        let image = picture(&mut CpuBackend::serial(), &settings, &samples);
        assert!(
            image.iter().all(|light| light.map(f32::to_bits) == [3.75_f32, 3.0, 3.0, 0.0].map(f32::to_bits)),
            "{composition:?}: {:?}",
            image[0]
        );
    }
}

/// Light passes a mirror untouched and a rough lobe filtered, whatever lies behind.
#[test]
fn only_rough_fronts_mix_what_is_behind() {
    let params = GatherParams::new(ANGLE, Direct::Estimate, 1, 1).unwrap();
    let front = |shininess: f32, flags: u32| {
        let mut front = FrontPixel::zeroed();
        let record = VertexRecord {
            position_footprint: [0.0, 0.0, 0.0, 0.01],
            throughput: [0.0, 0.0, 0.0, shininess],
            normal: octahedral_encode(Vec3::Y),
            flags,
            ..VertexRecord::zeroed()
        };
        front.add(&params, &record);
        front
    };
    let behind = Behind { light: [1.0, 2.0, 3.0, 0.0], emitted: [0.5, 0.5, 0.5, 0.0] };
    let take = |front: &FrontPixel, carry| {
        let mut behind = behind;
        let taken = behind.take(front, carry).map(|light| light[..3].to_vec());
        (taken, behind.radiance())
    };
    let mirror = front(1.0, VertexRecord::GUIDE);
    assert_eq!(take(&mirror, Carry::Rough), (None, behind.radiance()));
    assert_eq!(take(&mirror, Carry::All), (Some(vec![1.0, 2.0, 3.0]), Vec3::splat(0.5)));
    for rough in [front(0.8, VertexRecord::VALID), front(0.3, VertexRecord::GUIDE), front(0.0, VertexRecord::GUIDE)] {
        for carry in [Carry::Rough, Carry::All] {
            assert_eq!(take(&rough, carry), (Some(vec![1.5, 2.5, 3.5]), Vec3::ZERO));
        }
    }
    assert!(!front(0.81, VertexRecord::VALID).is_rough());
    // The end of a chain, and records that are no vertex or broken, are no front.
    for none in [front(0.0, VertexRecord::VALID), front(1.0, 0), front(f32::NAN, VertexRecord::VALID)] {
        assert_eq!(take(&none, Carry::All), (None, behind.radiance()));
    }
}
