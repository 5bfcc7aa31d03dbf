//! The stages on the CPU's backends: the same bits for any number of threads, and the picture that plain functions make.

use backend_api::{Backend, Binding, BufferDesc};
use backend_cpu::CpuBackend;
use bytemuck::Zeroable;
use hashcache_core::glam::Vec3;
use hashcache_core::hash::{pcg4d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use layered_filter::{
    ATrous, Composition, CrossBilateral, Direct, Filter, FilterSettings, FilterStages, LuminanceWeight, Taps,
    WeightSettings,
};

const WIDTH: u32 = 61;
const HEIGHT: u32 = 37;
const STORE: usize = 2;

/// A floor in front of a wall with sky above, some vertices without an answer, some broken ones.
fn samples(sample: u32) -> (Vec<VertexRecord>, Vec<EstimateRecord>) {
    let pixels = WIDTH * HEIGHT;
    let mut records = vec![VertexRecord::zeroed(); pixels as usize * STORE];
    let mut estimates = vec![EstimateRecord::zeroed(); pixels as usize];
    for i in 0..pixels {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let r = pcg4d([i, sample, 3, 9]).map(to_unit_f32);
        let floor = y > 20;
        let normal = if floor { Vec3::Y } else { Vec3::Z };
        let record = &mut records[i as usize * STORE];
        *record = VertexRecord {
            position_footprint: [x as f32 * 0.1, (HEIGHT - y) as f32 * 0.1, 0.0, 0.004],
            direct: [r[0], r[1], 0.5, 0.0],
            throughput: [0.6, if x < 30 { 0.2 } else { 0.5 }, 0.0, 0.0],
            emitted: [0.0, 0.0, r[2] * 0.1, 0.0],
            normal: octahedral_encode(normal),
            flags: if y < 4 { 0 } else { VertexRecord::VALID | VertexRecord::VISIBLE_ONLY },
            ..VertexRecord::zeroed()
        };
        let never = x / 5 == 4 && y / 5 == 3;
        let answered = if never || r[3] < 0.1 { 0.0 } else { 5.0 };
        estimates[i as usize] =
            EstimateRecord { direct: [0.0, 0.0, 0.0, answered], further: [r[1], 0.2 * r[0], 0.3, 0.0] };
    }
    records[500 * STORE].direct[1] = f32::NAN;
    (records, estimates)
}

fn upload<T: bytemuck::Pod>(backend: &mut CpuBackend, values: &[T]) -> Binding {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let size = bytes.len() as u64;
    let buffer = backend.create(&BufferDesc { name: "samples", size }).unwrap();
    backend.write(buffer, 0, bytes).unwrap();
    Binding { buffer, offset: 0, size }
}

fn read<T: bytemuck::Pod>(backend: &mut CpuBackend, binding: Binding) -> Vec<T> {
    let ticket = backend.read(binding.buffer, binding.offset, binding.size).unwrap();
    bytemuck::pod_collect_to_vec(&backend.redeem(ticket, true).unwrap().unwrap())
}

fn settings(direct: Direct, filter: &Filter) -> FilterSettings {
    FilterSettings {
        width: WIDTH,
        height: HEIGHT,
        direct,
        radius: 10.0,
        pixel_angle: 0.002,
        further: *filter,
        direct_filter: *filter,
        carried: *filter,
        layers: 1,
        composition: Composition::Layered,
    }
}

/// Three samples a pixel, gathered in two batches each, then the picture and the counters.
fn picture(backend: &mut CpuBackend, settings: &FilterSettings) -> (Vec<[f32; 4]>, [u64; 6]) {
    let mut stages = FilterStages::new(settings).unwrap();
    stages.prepare(backend).unwrap();
    for sample in 0..3 {
        let (records, estimates) = samples(sample);
        let half = 1000;
        for (first, count) in [(0, half), (half, WIDTH * HEIGHT - half)] {
            let range = first as usize..(first + count) as usize;
            let record_range = range.start * STORE..range.end * STORE;
            let (records, estimates) = (upload(backend, &records[record_range]), upload(backend, &estimates[range]));
            stages.gather(backend, records, STORE as u32, estimates, 1, first, count).unwrap();
        }
    }
    stages.filter(backend).unwrap();
    backend.submit().unwrap();
    backend.statuses().unwrap();
    let ticket = stages.read_counters(backend).unwrap();
    let counters = FilterStages::counters(&backend.redeem(ticket, true).unwrap().unwrap());
    let radiance = stages.radiance().unwrap();
    let image = read(backend, radiance);
    stages.release(backend).unwrap();
    (image, bytemuck::cast(counters))
}

fn filters() -> Vec<Filter> {
    let guided = WeightSettings { luminance: LuminanceWeight::Deviation { scale: 4.0 }, ..WeightSettings::PAPER };
    vec![
        Filter::None,
        Filter::CrossBilateral(CrossBilateral::new(&WeightSettings::PAPER, 12.0, 1, 7).unwrap()),
        Filter::ATrous(ATrous::new(&guided, Taps::TwentyFive, 3).unwrap()),
    ]
}

#[test]
fn threads_do_not_matter() {
    for filter in filters() {
        for direct in [Direct::Record, Direct::Estimate] {
            let settings = settings(direct, &filter);
            let serial = picture(&mut CpuBackend::serial(), &settings);
            let cut = picture(&mut CpuBackend::serial().with_launch_items(7), &settings);
            let rayon = picture(&mut CpuBackend::rayon(3).unwrap().with_launch_items(100), &settings);
            assert!(serial == cut && serial == rayon, "{filter:?}");
            assert!(serial.0.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
            let [samples, vertices, holes, left_out, filled, empty] = serial.1;
            let pixels = u64::from(WIDTH * HEIGHT);
            assert_eq!((samples, vertices), (3 * pixels, 3 * (pixels - 4 * u64::from(WIDTH))));
            assert!(holes > 0 && filled > 0 && empty == 0, "{:?}", serial.1);
            assert_eq!(left_out, if direct == Direct::Record { 3 } else { 0 });
        }
    }
}
