//! White furnaces: what surfaces of every kind send back of light that comes evenly from everywhere.
//!
//! `cargo test -p hashcache-pt-integrator --test bsdf_energy -- --nocapture` prints tables.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions")]

#[path = "common/bsdfs.rs"]
mod bsdfs;

use bsdfs::{coated, glass, glossy, grid, metal, pane, seen};
use pt_integrator::bsdf::{Bsdf, BsdfInputs, Lobe};
use pt_integrator::glam::Vec3;

const VIEWS: [f32; 4] = [1.0, 0.6, 0.2, 0.01];
const ROUGHNESS: [f32; 7] = [0.0, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0];
const IORS: [f32; 7] = [0.7, 1.0, 1.1, 1.33, 1.5, 2.0, 3.0];

/// Energy by lobe: radiance through a solid's surface is counted without the squared index, as power is.
fn energies(bsdf: &Bsdf) -> [Vec3; 4] {
    const N: usize = 28;
    Lobe::ALL.map(|lobe| {
        let scale = if lobe == Lobe::Diffuse { bsdf.diffuse_throughput() } else { Vec3::ONE };
        // In f64: hundreds of thousandths added up in f32 are off by as much as a hundred-thousandth.
        let sum = grid(N)
            .filter_map(|u| bsdf.sample(lobe, u))
            .inspect(|s| assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{s:?}"))
            .map(|s| (s.weight * (s.eta * s.eta)).to_array())
            .fold([0.0_f64; 3], |sum, light| [0, 1, 2].map(|c| sum[c] + f64::from(light[c])));
        scale * Vec3::from_array(sum.map(|sum| (sum / (N * N) as f64) as f32))
    })
}

fn energy(inputs: &BsdfInputs, cosine: f32, entering: bool) -> f32 {
    let [a, b, c, d] = energies(&seen(inputs, cosine, entering));
    (a + b + c + d).max_element()
}

/// Midpoints leave this much of an integral, with f32's rounding.
const QUADRATURE: f32 = 1e-5;

#[test]
fn no_surface_creates_light() {
    let mut worst = (0.0, String::new());
    for ior in IORS.into_iter().chain([0.0]) {
        for roughness in ROUGHNESS {
            for cosine in VIEWS {
                let half = BsdfInputs { transmission: 0.5, specular: 0.5, metallic: 0.2, ..glass(roughness, ior) };
                let tinted = BsdfInputs { specular_color: Vec3::new(0.0, 1.0, 9.0), ..glossy(roughness) };
                let kinds = [
                    ("dielectric", BsdfInputs { ior, ..glossy(roughness) }),
                    ("tinted", BsdfInputs { ior, ..tinted }),
                    ("metal", metal(roughness)),
                    ("pane", pane(roughness, ior)),
                    ("glass", glass(roughness, ior)),
                    ("glass without specular", BsdfInputs { specular: 0.0, ..glass(roughness, ior) }),
                    ("half", half),
                    ("half a pane", BsdfInputs { thin: true, ..half }),
                    ("coated half", coated(half, 0.0)),
                    ("coated", coated(BsdfInputs { ior, ..glossy(1.0) }, roughness)),
                    ("coated Lambert", coated(BsdfInputs { specular: 0.0, ..glossy(1.0) }, roughness)),
                    ("coated mirror", coated(metal(0.0), roughness)),
                    ("coated metal", coated(metal(roughness), 0.3)),
                    ("coated glass", coated(glass(0.0, ior), roughness)),
                ];
                for (name, inputs) in kinds {
                    for entering in [true, false] {
                        let energy = energy(&inputs, cosine, entering);
                        let what =
                            format!("{name} of roughness {roughness}, ior {ior}, at {cosine}, entering {entering}");
                        assert!(energy <= 1.0 + QUADRATURE, "{what}: {energy}");
                        if energy > worst.0 {
                            worst = (energy, what);
                        }
                    }
                }
            }
        }
    }
    println!("most light comes back from {}: {}", worst.1, worst.0);
}

#[test]
fn smooth_surfaces_lose_none() {
    for ior in IORS {
        for cosine in VIEWS {
            for entering in [true, false] {
                for inputs in [
                    metal(0.0),
                    glass(0.0, ior),
                    pane(0.0, ior),
                    BsdfInputs { specular: 0.3, ..glass(0.0, ior) },
                    BsdfInputs { specular_color: Vec3::new(2.0, 1.0, 2.0), ..glass(0.0, ior) },
                    BsdfInputs { metallic: 0.4, ..glass(0.0, ior) },
                ] {
                    let energy = energy(&inputs, cosine, entering);
                    let what = format!("{inputs:?} at {cosine}, entering {entering}: {energy}");
                    assert!((0.999..1.000_1).contains(&energy), "{what}");
                }
            }
        }
        let lambert = energy(&BsdfInputs::lambert(Vec3::ONE), 0.5, true);
        assert!((lambert - 1.0).abs() < 1e-6, "{lambert}");
    }
}

/// By how much chances and expected albedos of lobes are off their energies at most, as measured: where all is smooth,
/// where something is rough, and inside of rough glass.
const EXPECTATIONS: [[f32; 2]; 3] = [[0.045, 0.008], [0.185, 0.19], [0.35, 0.48]];

/// The chances of lobes follow their energies.
#[test]
fn expected_albedos_are_near() {
    let mut mixed = coated(glossy(0.4), 0.2);
    (mixed.metallic, mixed.transmission) = (0.2, 0.4);
    let mut worst = [[0.0_f32; 2]; 3];
    for roughness in ROUGHNESS {
        for cosine in [1.0, 0.8, 0.5, 0.2, 0.05] {
            for (inputs, entering) in [
                (glossy(roughness), true),
                (BsdfInputs { base_color: Vec3::splat(0.3), ..metal(roughness) }, true),
                (glass(roughness, 1.5), true),
                (glass(roughness, 1.5), false),
                (pane(roughness, 1.5), true),
                (coated(glossy(1.0), roughness), true),
                (BsdfInputs { roughness, ..mixed }, true),
            ] {
                let bsdf = seen(&inputs, cosine, entering);
                let energies = energies(&bsdf);
                let all: Vec3 = energies.iter().sum();
                for lobe in Lobe::ALL {
                    let share = energies[lobe as usize].element_sum() / all.element_sum();
                    let chance = bsdf.lobes()[lobe as usize];
                    let what = format!("{lobe:?} of {inputs:?} at {cosine}: {chance} for {share}");
                    assert!((share == 0.0) == (chance == 0.0) || share < 1e-4, "{what}");
                    assert!(share <= 4.0 * chance + 1e-3, "{what}");
                }
                let specular = energies[1] + energies[2] + energies[3];
                let told = bsdf.specular_throughput();
                let class = if entering { usize::from(roughness > 0.0 || inputs.clearcoat_roughness > 0.0) } else { 2 };
                for lobe in Lobe::ALL {
                    let share = energies[lobe as usize].element_sum() / all.element_sum();
                    worst[class][0] = worst[class][0].max((bsdf.lobes()[lobe as usize] - share).abs());
                }
                worst[class][1] = worst[class][1].max((specular - told).abs().max_element());
            }
        }
    }
    println!("smooth, rough, inside: chances and albedos are off by {worst:?}");
    for (worst, bound) in worst.as_flattened().iter().zip(EXPECTATIONS.as_flattened()) {
        assert!(worst <= bound && *worst > 0.8 * bound, "{worst}, not {bound}");
    }
}

fn table(name: &str, inputs: impl Fn(f32, f32) -> (BsdfInputs, bool)) {
    println!("\n{name}: energy at n·v = 1 / 0.5 / 0.1");
    print!("{:>10}", "roughness");
    for ior in IORS {
        print!("{:>20}", format!("ior {ior}"));
    }
    println!();
    for roughness in ROUGHNESS {
        print!("{roughness:>10}");
        for ior in IORS {
            let (inputs, entering) = inputs(roughness, ior);
            let cells = [1.0, 0.5, 0.1].map(|cosine| format!("{:.3}", energy(&inputs, cosine, entering)));
            print!("{:>20}", cells.join("/"));
        }
        println!();
    }
}

#[test]
fn tables() {
    table("white dielectric", |roughness, ior| (BsdfInputs { ior, ..glossy(roughness) }, true));
    table("its reflection alone", |roughness, ior| {
        (BsdfInputs { ior, base_color: Vec3::ZERO, ..glossy(roughness) }, true)
    });
    table("white metal (any ior)", |roughness, _| (metal(roughness), true));
    table("pane", |roughness, ior| (pane(roughness, ior), true));
    table("glass, entering", |roughness, ior| (glass(roughness, ior), true));
    table("glass, leaving", |roughness, ior| (glass(roughness, ior), false));
    table("coat of this roughness over a white dielectric of roughness 1", |roughness, ior| {
        (coated(BsdfInputs { ior, ..glossy(1.0) }, roughness), true)
    });
    table("coat of this roughness over a white mirror (any ior)", |roughness, _| (coated(metal(0.0), roughness), true));
}
