//! Every sampling routine against the density it states.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions and exact values")]

mod common;

use std::f32::consts::PI;

use common::chi2;
use common::scenes::{add_triangles, quad};
use hashcache_core::traits::Sampler;
use pt_integrator::glam::Vec3;
use pt_integrator::light::{EnvironmentTables, build_alias, guide_buckets, luminance, pick_alias};
use pt_integrator::packed::PackedScene;
use pt_integrator::sampler::Independent;
use pt_integrator::sampling::{cosine_pdf, sample_cosine, sample_triangle};
use pt_integrator::scene::{EnvironmentImage, Material, SceneData};

const SAMPLES: u32 = 400_000;

fn draws() -> impl Iterator<Item = Independent> {
    (0..SAMPLES).map(|i| Independent::new(i, 0xc0ff_ee00))
}

/// Cells of equal solid angle: z by azimuth.
const BANDS: usize = 20;
const SECTORS: usize = 40;

fn cell(direction: Vec3) -> usize {
    let band = ((direction.y * 0.5 + 0.5) * BANDS as f32) as usize;
    let sector = ((direction.z.atan2(direction.x) / (2.0 * PI) + 0.5) * SECTORS as f32) as usize;
    band.min(BANDS - 1) * SECTORS + sector.min(SECTORS - 1)
}

/// Integral of a density over each cell, by midpoints in the polar angle: densities may be as steep as 1/sine.
fn expected(density: impl Fn(Vec3) -> f32, fine: usize) -> Vec<f64> {
    let mut cells = vec![0.0; BANDS * SECTORS];
    let polar = |band: usize| (1.0 - 2.0 * band as f64 / BANDS as f64).acos();
    for band in 0..BANDS {
        let (top, bottom) = (polar(band), polar(band + 1));
        let step = (bottom - top) / fine as f64;
        for i in 0..fine {
            let theta = top + (i as f64 + 0.5) * step;
            let solid_angle = theta.sin() * step * std::f64::consts::TAU / (SECTORS * fine) as f64;
            for j in 0..SECTORS * fine {
                let phi = ((j as f32 + 0.5) / (SECTORS * fine) as f32 - 0.5) * 2.0 * PI;
                let (y, r) = (theta.cos() as f32, theta.sin() as f32);
                let direction = Vec3::new(r * phi.cos(), y, r * phi.sin());
                cells[cell(direction)] += f64::from(density(direction)) * solid_angle;
            }
        }
    }
    cells
}

#[test]
fn cosine() {
    let mut counts = vec![0; BANDS * SECTORS];
    for mut draw in draws() {
        let d = sample_cosine(draw.next_2d());
        assert!((d.length() - 1.0).abs() < 1e-5 && d.z > 0.0);
        counts[cell(Vec3::new(d.x, d.z, d.y))] += 1;
    }
    let expected: Vec<f64> = expected(|d| cosine_pdf(d.y), 16).iter().map(|p| p * f64::from(SAMPLES)).collect();
    chi2::check("cosine", &counts, &expected);
}

#[test]
fn triangle_by_area() {
    const N: usize = 16;
    let mut counts = vec![0; N * N];
    for mut draw in draws() {
        let b = sample_triangle(draw.next_2d());
        assert!(b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0);
        counts[(b.x * N as f32) as usize * N + (b.y * N as f32) as usize] += 1;
    }
    // Cells of the unit square that the diagonal cuts hold half.
    let share = |i: usize, j: usize| [1.0, 0.5, 0.0][((i + j + 1).cmp(&N) as i8 + 1) as usize];
    let expected: Vec<f64> =
        (0..N * N).map(|k| share(k / N, k % N) * 2.0 / (N * N) as f64 * f64::from(SAMPLES)).collect();
    chi2::check("triangle", &counts, &expected);
}

#[test]
fn alias_table() {
    for weights in [
        vec![1.0],
        vec![3.0, 0.0, 1.0, 1e-3, 7.0],
        vec![0.0, 0.0, 2.0],
        (0..1000).map(|i| f64::from(i % 17) * 1e-12).collect(),
    ] {
        let table = build_alias(&weights);
        let total: f64 = weights.iter().sum();
        let mut counts = vec![0; weights.len()];
        for mut draw in draws() {
            counts[pick_alias(&table, draw.next_2d()) as usize] += 1;
        }
        let expected: Vec<f64> = weights.iter().map(|w| w / total * f64::from(SAMPLES)).collect();
        chi2::check("alias table", &counts, &expected);
    }
}

fn image(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> EnvironmentImage {
    let at = |i: u32| {
        let [r, g, b] = texel(i % width, i / width);
        [r, g, b, 0.0]
    };
    EnvironmentImage { width, height, texels: (0..width * height).map(at).collect() }
}

#[test]
fn environment_image() {
    let pictures = [
        image(1, 1, |_, _| [1.0; 3]),
        image(4, 2, |x, y| [x as f32, y as f32, 0.5]),
        image(16, 8, |x, y| if (x, y) == (3, 2) { [1000.0, 900.0, 500.0] } else { [0.0, 0.0, 0.1 * y as f32] }),
        image(5, 7, |x, y| [(x * 7 + y * 3) as f32 % 5.0, 0.0, 1e-6]),
        image(2, 1, |x, _| [1e12 * x as f32; 3]),
    ];
    for picture in &pictures {
        let tables = EnvironmentTables::new(picture).unwrap();
        let view = tables.view(picture);
        let mut counts = vec![0; BANDS * SECTORS];
        for mut draw in draws() {
            let Some(sample) = view.sample(draw.next_2d(), 1.0) else { continue };
            counts[cell(sample.direction)] += 1;
            let seen = view.evaluate(sample.direction);
            let tolerance = 1e-3 * sample.pdf + 1e-4;
            assert!(
                (seen.pdf - sample.pdf).abs() < tolerance || sample.direction.y.abs() > 0.999,
                "{seen:?} {sample:?}"
            );
        }
        let density = expected(|d| view.evaluate(d).pdf, 24);
        let total: f64 = density.iter().sum();
        assert!((total - 1.0).abs() < 2e-3, "the density integrates to {total}");
        let expected: Vec<f64> = density.iter().map(|p| p / total * f64::from(SAMPLES)).collect();
        chi2::check("environment", &counts, &expected);
    }
}

/// Light is found wherever there is light: a direction with radiance has a density.
#[test]
fn environment_density_is_positive_where_there_is_light() {
    let picture = image(8, 4, |x, y| if (x, y) == (0, 0) { [0.0, 0.0, 1.0] } else { [0.0; 3] });
    let tables = EnvironmentTables::new(&picture).unwrap();
    let view = tables.view(&picture);
    for mut draw in draws().take(50_000) {
        let d = sample_cosine(draw.next_2d());
        for d in [d, -d] {
            let seen = view.evaluate(d);
            assert_eq!(seen.pdf > 0.0, luminance(seen.radiance) > 0.0);
        }
    }
    assert!(EnvironmentTables::new(&image(8, 4, |_, _| [0.0; 3])).is_none());
}

/// Points on a lamp of two triangles are uniform, and their density by solid angle is that of the whole lamp.
#[test]
fn triangle_lights() {
    const N: usize = 16;
    let mut scene = SceneData::default();
    let from = Vec3::new(0.2, -0.3, 0.1);
    let lamp = quad(Vec3::new(-0.5, 1.0, -0.5), Vec3::X, Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.5; 3], [2.0, 1.0, 0.5]));
    let packed = PackedScene::new(&scene).unwrap();
    let view = packed.view();
    let mut counts = vec![0; N * N];
    for mut draw in draws() {
        let light = view.lights[pick_alias(view.alias, draw.next_2d()) as usize];
        let sample = light.sample(from, draw.next_2d()).expect("the lamp faces the point");
        let distance = (1.0 - from.y) / sample.direction.y;
        let density = distance * distance / sample.direction.y;
        assert!((sample.pdf / density - 1.0).abs() < 1e-4, "one square metre: density by area is 1");
        let at = from + sample.direction * distance + 0.5;
        counts[((at.x * N as f32) as usize).min(N - 1) * N + ((at.z * N as f32) as usize).min(N - 1)] += 1;
        assert_eq!(light.sample(from + 2.0 * Vec3::Y, draw.next_2d()), None, "seen from behind");
    }
    chi2::check("lamp", &counts, &[f64::from(SAMPLES) / (N * N) as f64; N * N]);
}

/// A guide's entries are the first ones above its buckets' starts, so that a search from there finds what a search
/// through the whole table finds.
#[test]
fn environment_guides_begin_before_every_answer() {
    for (width, height) in [(1, 1), (3, 2), (4, 5), (37, 9), (64, 3)] {
        let dark = |x: u32, y: u32| (x * 7).is_multiple_of(5) || y == 1;
        let texel = |i: u32| if dark(i % width, i / width) { [0.0; 4] } else { [(i * i % 97) as f32; 4] };
        let texels = (0..width * height).map(texel).chain([[1.0; 4]]).skip(1).collect();
        let image = EnvironmentImage { width, height, texels };
        let tables = EnvironmentTables::new(&image).expect("its last texel shines");
        let buckets = guide_buckets(width as usize);
        assert_eq!(tables.guides.len(), (height as usize + 2) * buckets);
        let searched = tables.columns.chunks(width as usize).chain([&tables.rows[..]]);
        for (table, guides) in searched.zip(tables.guides.chunks(buckets)) {
            for (bucket, &first) in guides.iter().enumerate() {
                let start = bucket as f32 / buckets as f32;
                assert_eq!(Some(first as usize), table.iter().position(|&x| x > start));
            }
        }
    }
}
