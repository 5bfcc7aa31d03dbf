//! A renderer's own layers through the filter: a room whose far wall carries a mirror, lit by one noisy sample a pixel.
//! What stands in the mirror is a layer of its own, filtered by its own surfaces.
//! `cargo run -p hashcache-layered-filter --example mirror`

use bytemuck::Zeroable;
use hashcache_core::error::ParamError;
use hashcache_core::float::{floor, ln};
use hashcache_core::glam::{Vec3, vec3};
use hashcache_core::hash::{pcg2d, to_unit_f32};
use hashcache_core::pack::octahedral_encode;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;
use layered_filter::image::is_hole;
use layered_filter::{
    Behind, CrossBilateral, Direct, GatherParams, GuideScale, LayerPixel, Light, PreparedGuide, View, WeightSettings,
    filter,
};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;
const ANGLE: f32 = 0.0044;
const LOW: Vec3 = vec3(-3.0, 0.0, -3.0);
const HIGH: Vec3 = vec3(3.0, 3.0, 4.0);
const TINT: Vec3 = vec3(0.9, 0.95, 0.9);
/// What a path brought to a vertex, of what is there.
type Noise<'a> = &'a dyn Fn(u32) -> f32;

/// Where a ray leaves the room: distance and the wall's normal.
fn wall(from: Vec3, way: Vec3) -> (f32, Vec3) {
    let exits = [0, 1, 2].map(|k| (if way[k] > 0.0 { HIGH[k] - from[k] } else { LOW[k] - from[k] }) / way[k]);
    let k = (0..3).fold(0, |best, k| if exits[k] < exits[best] { k } else { best });
    (exits[k], -Vec3::AXES[k] * way[k].signum())
}

/// The vertices that a pixel shows, one a layer: a wall; or the mirror, and the wall in it.
fn look(pixel: u32, noise: Noise<'_>) -> [VertexRecord; 2] {
    let [x, y] = [pixel % WIDTH, pixel / WIDTH].map(|v| v as f32 + 0.5);
    let eye = vec3(0.3, 1.5, 3.5);
    let way = vec3((x - 0.5 * WIDTH as f32) * ANGLE, (0.5 * HEIGHT as f32 - y) * ANGLE, -1.0).normalize();
    let (length, normal) = wall(eye, way);
    let place = eye + way * length;
    if normal != Vec3::Z || place.x.abs() > 1.6 || (place.y - 1.5).abs() > 1.0 {
        return [vertex(place, normal, length, Vec3::ONE, noise(pixel)), VertexRecord::zeroed()];
    }
    let mirror = VertexRecord {
        position_footprint: place.extend(length * ANGLE).to_array(),
        throughput: [0.0, 0.0, 0.0, 1.0],
        normal: octahedral_encode(normal),
        flags: VertexRecord::GUIDE,
        ..VertexRecord::zeroed()
    };
    let on = way.reflect(normal);
    let (further, normal) = wall(place, on);
    let mut behind = vertex(place + on * further, normal, length + further, TINT, noise(pixel));
    behind.flags |= VertexRecord::layer_bits(1);
    [mirror, behind]
}

/// A tile of a wall under a small lamp, seen through `tint`.
fn vertex(place: Vec3, normal: Vec3, length: f32, tint: Vec3, noise: f32) -> VertexRecord {
    let tile = (place * 2.0 + 0.25).to_array().map(|v| floor(v) as i32).iter().sum::<i32>().rem_euclid(3);
    let albedo = [vec3(0.8, 0.3, 0.2), vec3(0.2, 0.5, 0.7), vec3(0.7, 0.7, 0.6)][tile as usize];
    let way = vec3(0.0, 1.6, 0.5) - place;
    let light = 2.0 * way.normalize().dot(normal).max(0.0) / way.length_squared();
    VertexRecord {
        position_footprint: place.extend(length * ANGLE).to_array(),
        direct: [light * noise, light * noise, light * noise, 0.0],
        throughput: (tint * albedo).extend(0.0).to_array(),
        normal: octahedral_encode(normal),
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    }
}

/// The picture of some chains of vertices; each layer is filtered by its own guides.
fn picture(chains: &[[VertexRecord; 2]]) -> Result<Vec<Vec3>, ParamError> {
    let (gather, scale) = (GatherParams::new(ANGLE, Direct::Estimate, 1, 1)?, GuideScale::new(4.8)?);
    // Light changes over half a metre here, and what the mirror shows lies far apart from pixel to pixel.
    let weights = WeightSettings { position_scale: 10.0, ..WeightSettings::surface(ANGLE) };
    let denoiser = CrossBilateral::new(&weights, 8.0, 3, 1)?;
    let mut behind = vec![Behind::default(); PIXELS];
    for layer in (0..2).rev() {
        let pixels: Vec<_> = chains.iter().map(|chain| sums(&gather, &chain[layer])).collect();
        let guides: Vec<_> = pixels.iter().map(|pixel| PreparedGuide::of_pixel(&scale, pixel)).collect();
        let mut image: Vec<Light> = pixels.iter().map(LayerPixel::further_light).collect();
        let view = View::new(WIDTH, HEIGHT, &guides).expect("a guide a pixel");
        filter(&denoiser, &view, &mut image, &mut vec![[0.0; 4]; PIXELS]);
        for ((behind, pixel), light) in behind.iter_mut().zip(&pixels).zip(&image) {
            assert!(!is_hole(light), "every vertex brings light of its own");
            behind.add(pixel, vec3(light[0], light[1], light[2]));
        }
    }
    Ok(behind.iter().map(Behind::radiance).collect())
}

/// A pixel of one sample, answered by its own light; with a cache, its estimate stands here.
fn sums(gather: &GatherParams, record: &VertexRecord) -> LayerPixel {
    let [r, g, b, _] = record.direct;
    let own = Estimate { direct: vec3(r, g, b), further: Vec3::ZERO, samples: 1, variance: 0.0 };
    let mut pixel = LayerPixel::zeroed();
    pixel.add(gather, record, &own);
    pixel
}

fn main() -> Result<(), ParamError> {
    // Like one path a pixel: right on average, with a deviation as large as the light itself.
    let noisy = |pixel| -ln(1.0 - to_unit_f32(pcg2d([pixel, 7])[0]));
    let show = |noise: Noise<'_>| (0..PIXELS as u32).map(|i| look(i, noise)).collect::<Vec<_>>();
    let (chains, truth) = (show(&noisy), show(&|_| 1.0));
    let radiance = |chains: &[[VertexRecord; 2]]| {
        chains.iter().map(|chain| chain[0].radiance() + chain[1].radiance()).collect::<Vec<_>>()
    };
    let (before, truth, after) = (radiance(&chains), radiance(&truth), picture(&chains)?);
    for (name, mirrors) in [("seen directly", false), ("in the mirror", true)] {
        let error = |image: &[Vec3]| {
            let of = |i: &usize| f64::from((image[*i] - truth[*i]).length_squared());
            let pixels = (0..PIXELS).filter(|i| (chains[*i][0].flags & VertexRecord::GUIDE != 0) == mirrors);
            let (sum, count) = pixels.fold((0.0, 0), |(sum, count), i| (sum + of(&i), count + 1));
            sum / f64::from(count)
        };
        let (traced, filtered) = (error(&before), error(&after));
        println!(
            "{name}: squared error {traced:.5} traced, {filtered:.5} filtered, {:.0} times less",
            traced / filtered
        );
        assert!(filtered * 10.0 < traced, "the filter removes most of the noise, in the mirror too");
    }
    Ok(())
}
