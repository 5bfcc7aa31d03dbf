//! Every lobe's samples against the density and the value that it states, and reciprocity.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions")]

#[path = "common/bsdfs.rs"]
mod bsdfs;
#[path = "common/chi2.rs"]
mod chi2;

use std::f32::consts::{PI, TAU};

use bsdfs::{NORMAL, at_cosine, coated, glass, glossy, metal, pane, seen};
use hashcache_core::traits::Sampler;
use pt_integrator::bsdf::{Bsdf, BsdfInputs, Lobe};
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::sampler::Independent;
use pt_integrator::sampling::Basis;

const SAMPLES: u32 = 40_000;
const BANDS: usize = 24;
const SECTORS: usize = 16;
/// Midpoints along each side of a cell.
const FINE: usize = 12;

/// Cells about an axis, finer towards it: bands are of equal size after the tangent of half the angle is divided by
/// `width` and bent into `[0, 1]`.
struct Cells {
    frame: Basis,
    width: f32,
}

impl Cells {
    fn of(&self, direction: Vec3) -> usize {
        let local = self.frame.to_local(direction);
        let half = local.truncate().length().atan2(local.z) * 0.5;
        let band = (half.tan() / self.width).atan() / (0.5 * PI) * BANDS as f32;
        let sector = (local.y.atan2(local.x) / TAU + 0.5) * SECTORS as f32;
        (band as usize).min(BANDS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)
    }

    fn expected(&self, density: impl Fn(Vec3) -> f32) -> Vec<f64> {
        let mut cells = vec![0.0; BANDS * SECTORS];
        let theta = |i: f64| 2.0 * (f64::from(self.width) * (i * std::f64::consts::FRAC_PI_2).tan()).atan();
        let rings = BANDS * FINE;
        for i in 0..rings {
            let (low, high) = (theta(i as f64 / rings as f64), theta((i + 1) as f64 / rings as f64));
            let (sine, cosine) = (0.5 * (low + high)).sin_cos();
            let solid_angle = sine * (high - low) * std::f64::consts::TAU / (SECTORS * FINE) as f64;
            for j in 0..SECTORS * FINE {
                let phi = ((j as f32 + 0.5) / (SECTORS * FINE) as f32 - 0.5) * TAU;
                let tangential = Vec2::new(phi.cos(), phi.sin()) * sine as f32;
                let direction = self.frame.to_scene(tangential, cosine as f32);
                cells[i / FINE * SECTORS + j / FINE] += f64::from(density(direction)) * solid_angle;
            }
        }
        cells
    }
}

/// Samples of a lobe fall where its density says, and as often; what a sample states about itself is what evaluation
/// states about its direction. Returns the share of samples that were lost.
fn check(what: &str, bsdf: &Bsdf, lobe: Lobe, axis: Vec3, width: f32) -> f64 {
    assert!(!bsdf.is_delta(lobe), "{what}");
    let cells = Cells { frame: Basis::new(axis.normalize()), width };
    let mut counts = vec![0; BANDS * SECTORS + 1];
    let (mut worst_pdf, mut worst_value) = (0.0_f32, 0.0_f32);
    for i in 0..SAMPLES {
        let Some(sample) = bsdf.sample(lobe, Independent::new(i, 0x00c0_ffee).next_2d()) else {
            counts[BANDS * SECTORS] += 1;
            continue;
        };
        assert!((sample.incoming.length() - 1.0).abs() < 1e-5, "{what}: {sample:?}");
        assert!(sample.pdf > 0.0 && sample.pdf.is_finite(), "{what}: {sample:?}");
        assert_eq!(sample.transmitted, lobe == Lobe::Transmission);
        // A direction within rounding of the horizon may fall below it.
        if NORMAL.dot(sample.incoming).abs() > 1e-3 {
            let (value, pdf) = bsdf.eval_pdf(lobe, sample.incoming);
            worst_pdf = worst_pdf.max((pdf / sample.pdf - 1.0).abs());
            let error = (value - sample.weight * sample.pdf).abs().max_element();
            // Near the critical angle what passes changes by much with the last digit of the angle.
            let scale = sample.weight.max_element().max(0.1 / (sample.eta * sample.eta));
            worst_value = worst_value.max(error / (scale * sample.pdf));
        }
        counts[cells.of(sample.incoming)] += 1;
    }
    // Half vectors hold 2⁻²⁴, α may be 2⁻¹⁰ and refraction magnifies by up to 2⁵.
    assert!(worst_pdf < 0.03 && worst_value < 0.03, "{what}: pdf {worst_pdf}, value {worst_value}");
    let mut expected = cells.expected(|d| bsdf.pdf(lobe, d));
    let lost = 1.0 - expected.iter().sum::<f64>();
    assert!(lost > -2e-3, "{what}: the density's integral is {}", 1.0 - lost);
    expected.push(lost.max(0.0));
    // No midpoint may lie where the horizon leaves but a sliver of a cell.
    let expected: Vec<f64> = expected.iter().map(|p| (p * f64::from(SAMPLES)).max(0.01)).collect();
    // The integral is no better than a thousandth, so a cell for lost samples is compared only when it counts.
    let is_sure = expected[BANDS * SECTORS] >= 500.0;
    assert!(is_sure || counts[BANDS * SECTORS] < 1000, "{what}: {} are lost", counts[BANDS * SECTORS]);
    let kept = BANDS * SECTORS + usize::from(is_sure);
    chi2::check(what, &counts[..kept], &expected[..kept]);
    counts[BANDS * SECTORS] as f64 / f64::from(SAMPLES)
}

const VIEWS: [f32; 3] = [1.0, 0.5, 0.05];
const ROUGHNESS: [f32; 4] = [0.032, 0.2, 0.5, 1.0];

fn mirror(cosine: f32) -> Vec3 {
    NORMAL * (2.0 * cosine) - at_cosine(cosine)
}

#[test]
fn diffuse() {
    for cosine in VIEWS {
        check(&format!("diffuse at {cosine}"), &seen(&glossy(0.5), cosine, true), Lobe::Diffuse, NORMAL, 0.6);
    }
}

#[test]
fn reflection() {
    for roughness in ROUGHNESS {
        for cosine in VIEWS {
            let what = format!("roughness {roughness} at {cosine}");
            let width = (roughness * roughness).min(0.6);
            let metal = seen(&metal(roughness), cosine, true);
            check(&what, &metal, Lobe::Reflection, mirror(cosine), width);
            let inside = seen(&glass(roughness, 1.5), cosine, false);
            check(&format!("inside, {what}"), &inside, Lobe::Reflection, mirror(cosine), width);
        }
    }
}

#[test]
fn thin_transmission() {
    for roughness in ROUGHNESS {
        for cosine in VIEWS {
            let what = format!("pane of roughness {roughness} at {cosine}");
            let width = (roughness * roughness).min(0.6);
            check(&what, &seen(&pane(roughness, 1.5), cosine, true), Lobe::Transmission, -at_cosine(cosine), width);
        }
    }
}

#[test]
fn refraction() {
    for (ior, entering) in [(1.5, true), (1.5, false), (3.0, true), (3.0, false), (1.02, false), (0.8, true)] {
        for roughness in ROUGHNESS {
            for cosine in VIEWS {
                let bsdf = seen(&glass(roughness, ior), cosine, entering);
                if bsdf.is_delta(Lobe::Transmission) {
                    // Nothing bends light there.
                    assert!(roughness < 0.11, "{roughness} {ior}");
                    continue;
                }
                let eta = if entering { ior } else { 1.0 / ior };
                let bent = eta * eta - 1.0 + cosine * cosine;
                let view = at_cosine(cosine);
                let axis = if bent > 0.0 {
                    (NORMAL * (cosine - bent.sqrt()) - view) / eta
                } else {
                    (NORMAL * cosine - view).normalize()
                };
                let width = (roughness * roughness * (1.0 - 1.0 / eta).abs()).clamp(1e-3, 0.6);
                let what = format!("ior {ior} entering {entering}, roughness {roughness} at {cosine}");
                let lost = check(&what, &bsdf, Lobe::Transmission, axis, width);
                assert!(eta < 1.0 || lost < 0.3, "{what}: {lost} lost");
            }
        }
    }
}

#[test]
fn coat() {
    let normal = (NORMAL + 0.2 * Vec3::X).normalize();
    for roughness in ROUGHNESS {
        for cosine in VIEWS {
            let inputs = BsdfInputs { coat_normal: normal, ..coated(metal(0.5), roughness) };
            let view = at_cosine(cosine);
            let bsdf = Bsdf::new(&inputs, NORMAL, view, true);
            if normal.dot(view) <= 0.0 {
                assert!(bsdf.sample(Lobe::Coat, Vec2::splat(0.3)).is_none());
                continue;
            }
            let axis = normal * (2.0 * normal.dot(view)) - view;
            let what = format!("coat of roughness {roughness} at {cosine}");
            check(&what, &bsdf, Lobe::Coat, axis, (roughness * roughness).min(0.6));
        }
    }
}

/// Numbers drawn.
const N: u32 = 1 << 16;

/// Which lobe is chosen how often.
#[test]
fn picks() {
    let mut inputs = coated(glossy(0.4), 0.1);
    (inputs.metallic, inputs.transmission) = (0.3, 0.5);
    let bsdf = seen(&inputs, 0.5, true);
    let lobes = bsdf.lobes();
    assert!(lobes.iter().all(|p| *p > 0.02) && (lobes.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{lobes:?}");
    let mut counts = vec![0; 4];
    for i in 0..N {
        let pick = bsdf.pick(Independent::new(i, 7).next_1d());
        assert!((pick.probability - lobes[pick.lobe as usize]).abs() < 1e-6, "{pick:?}");
        counts[pick.lobe as usize] += 1;
    }
    chi2::check("picks", &counts, &lobes.map(|share| f64::from(share) * f64::from(N)));
}

/// Light goes both ways alike. Through a solid's surface, but for the squared index that radiance carries.
#[test]
fn reciprocity() {
    let mut mixed = coated(glossy(0.35), 0.6);
    (mixed.metallic, mixed.specular, mixed.base_color) = (0.3, 0.6, Vec3::new(0.9, 0.5, 0.1));
    mixed.specular_color = Vec3::new(0.2, 1.0, 3.0);
    let sheet = BsdfInputs { transmission: 0.6, ..mixed };
    let solid = BsdfInputs { thin: false, ior: 1.4, ..sheet };
    let mut compared = [0; 4];
    for i in 0..4096 {
        let mut draw = Independent::new(i, 11);
        let direction = |u: Vec2| {
            let z = 1.0 - 2.0 * u.x;
            let (s, c) = (TAU * u.y).sin_cos();
            Vec3::new(c * (1.0 - z * z).sqrt(), s * (1.0 - z * z).sqrt(), z)
        };
        let [a, b] = [direction(draw.next_2d()), direction(draw.next_2d())];
        if NORMAL.dot(a).abs().min(NORMAL.dot(b).abs()) < 0.02 {
            continue;
        }
        for inputs in [mixed, sheet, solid] {
            // The front is where NORMAL points; the normal given is on the viewer's side.
            let f = |view: Vec3, light: Vec3, lobe: Lobe| {
                let side = 1.0_f32.copysign(NORMAL.dot(view));
                let inputs = BsdfInputs { coat_normal: NORMAL * side, ..inputs };
                let bsdf = Bsdf::new(&inputs, NORMAL * side, view, side > 0.0);
                let scale = if lobe == Lobe::Diffuse { bsdf.diffuse_throughput() } else { Vec3::ONE };
                scale * bsdf.eval(lobe, light) / NORMAL.dot(light).abs()
            };
            for lobe in Lobe::ALL {
                let (there, back) = (f(a, b, lobe), f(b, a, lobe));
                let index = if !inputs.thin && lobe == Lobe::Transmission {
                    if NORMAL.dot(a) > 0.0 { inputs.ior } else { 1.0 / inputs.ior }
                } else {
                    1.0
                };
                let there = there * index * index;
                let error = (there - back).abs().max_element();
                assert!(error <= 2e-4 * back.max_element() + 1e-7, "{lobe:?} {a} {b}: {there} {back}");
                compared[lobe as usize] += usize::from(back.max_element() > 0.0);
            }
        }
    }
    assert!(compared.iter().all(|n| *n > 500), "{compared:?}");
}
