//! Materials, normals, directions and numbers of any kind: nothing is NaN, negative or brighter than white.
#![allow(clippy::float_cmp, reason = "exact values are meant")]

#[path = "common/bsdfs.rs"]
mod bsdfs;

use bsdfs::{NORMAL, at_cosine, coated, glass, glossy, metal, pane, seen};
use proptest::prelude::*;
use pt_integrator::bsdf::{Bsdf, BsdfInputs, Lobe, SMALLEST_ALPHA, fresnel_dielectric};
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::sampling::{cosine_pdf, sample_cosine};

/// Numbers that break formulas, and some that don't.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => 0.0_f32..1.0,
        1 => -2.0_f32..4.0,
        1 => prop::sample::select(vec![0.0, -0.0, 1e-30, 1e-6, 1e-3, 0.031_25, 0.999_999_9, 1.0, 1.5, 3.0, 1e30, -1.0,
            f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN]),
    ]
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(number()).prop_map(Vec3::from_array)
}

/// Unit vectors, mostly.
fn direction() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        4 => prop::array::uniform3(-1.0_f32..1.0).prop_map(|v| Vec3::from_array(v).normalize_or(Vec3::Y)),
        1 => prop::sample::select(vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Z, Vec3::ZERO]),
        1 => vector(),
    ]
}

prop_compose! {
    fn inputs()(
        colors in prop::array::uniform2(vector()), numbers in prop::array::uniform7(number()), coat_normal in direction(),
        thin: bool,
    ) -> BsdfInputs {
        let [metallic, roughness, ior, specular, transmission, clearcoat, clearcoat_roughness] = numbers;
        BsdfInputs {
            base_color: colors[0], metallic, roughness, ior, specular, specular_color: colors[1], transmission, thin,
            clearcoat, clearcoat_roughness, coat_normal,
        }
    }
}

fn is_share(v: Vec3, largest: f32) -> bool {
    v.min_element() >= 0.0 && v.max_element() <= largest * 1.000_1
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn nothing_is_nan(
        inputs in inputs(), normal in direction(), outgoing in direction(), incoming in direction(), entering: bool,
        u in prop::array::uniform3(0.0_f32..1.0), aligned: bool,
    ) {
        let outgoing = if aligned { normal } else { outgoing };
        let bsdf = Bsdf::new(&inputs, normal, outgoing, entering);
        let chances = bsdf.lobes();
        prop_assert!(chances.iter().all(|p| (0.0..=1.0).contains(p)), "{:?}", chances);
        let sum: f32 = chances.iter().sum();
        prop_assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-5, "{:?}", chances);
        let pick = bsdf.pick(u[2]);
        prop_assert!(pick.probability > 0.0 && pick.probability <= 1.0, "{:?}", pick);
        prop_assert!(is_share(bsdf.diffuse_throughput(), 1.0), "{}", bsdf.diffuse_throughput());
        prop_assert!(is_share(bsdf.specular_throughput(), 1.0), "{}", bsdf.specular_throughput());
        prop_assert!((0.0..=1.0).contains(&bsdf.diffuse_weight(incoming)));
        for lobe in Lobe::ALL {
            prop_assert!((0.0..=1.0).contains(&bsdf.roughness(lobe)));
            let (value, pdf) = bsdf.eval_pdf(lobe, incoming);
            if incoming.is_normalized() {
                prop_assert!(value.is_finite() && value.min_element() >= 0.0, "{:?} {}", lobe, value);
                prop_assert!(pdf.is_finite() && pdf >= 0.0, "{:?} {}", lobe, pdf);
            }
            prop_assert!(!bsdf.is_delta(lobe) || (value == Vec3::ZERO && pdf == 0.0));
            if let Some(sample) = bsdf.sample(lobe, Vec2::new(u[0], u[1])) {
                let largest = 1.0 / (sample.eta * sample.eta);
                prop_assert!(is_share(sample.weight, largest), "{:?} {:?}", lobe, sample);
                prop_assert!(sample.pdf > 0.0 && (sample.pdf.is_finite() || sample.is_delta), "{:?} {:?}", lobe, sample);
                prop_assert!((sample.incoming.length() - 1.0).abs() < 1e-3, "{:?} {:?}", lobe, sample);
                prop_assert_eq!(sample.is_delta, bsdf.is_delta(lobe));
                prop_assert!(chances[lobe as usize] > 0.0 || sample.weight.max_element() < 1e-30 || lobe == Lobe::Diffuse,
                    "{:?} {:?} {:?}", lobe, sample, chances);
            }
        }
    }

    /// The same bits as a Lambertian surface without any of this.
    #[test]
    fn lambert_is_exact(
        color in prop::array::uniform3(0.0_f32..=1.0), roughness in number(), ior in number(), coat_roughness in number(),
        normal in direction(), incoming in direction(), view in 1e-3_f32..1.0, u in prop::array::uniform3(0.0_f32..1.0),
        entering: bool, thin: bool,
    ) {
        let color = Vec3::from_array(color);
        let normal = normal.try_normalize().unwrap_or(Vec3::Y);
        let outgoing = (normal * view + normal.any_orthonormal_vector() * (1.0 - view * view).sqrt()).normalize();
        let inputs = BsdfInputs {
            roughness, ior, clearcoat_roughness: coat_roughness, thin, coat_normal: Vec3::NAN,
            ..BsdfInputs::lambert(color)
        };
        let bsdf = Bsdf::new(&inputs, normal, outgoing, entering);
        prop_assert_eq!(bsdf.diffuse_throughput(), color);
        prop_assert_eq!(bsdf.diffuse_weight(incoming), 1.0);
        prop_assert_eq!(bsdf.lobes(), [1.0, 0.0, 0.0, 0.0]);
        let pick = bsdf.pick(u[2]);
        prop_assert_eq!((pick.lobe, pick.probability), (Lobe::Diffuse, 1.0));
        let sample = bsdf.sample(Lobe::Diffuse, Vec2::new(u[0], u[1])).unwrap();
        let local = sample_cosine(Vec2::new(u[0], u[1]));
        let expected = pt_integrator::sampling::Basis::new(normal).to_scene(local.truncate(), local.z);
        prop_assert_eq!((sample.incoming, sample.weight, sample.pdf), (expected, Vec3::ONE, cosine_pdf(local.z)));
        let pdf = cosine_pdf(normal.dot(expected));
        prop_assert_eq!(bsdf.eval_pdf(Lobe::Diffuse, expected), (Vec3::splat(pdf), pdf));
    }
}

/// Roughness goes to the mirror without a jump: what a narrow lobe weighs is what the delta lobe weighs.
#[test]
fn smooth_is_the_limit() {
    let smallest = SMALLEST_ALPHA.sqrt();
    for cosine in [1.0, 0.6, 0.1] {
        for (inputs, lobes) in [
            (|r| metal(r), &[Lobe::Reflection][..]),
            (|r| glossy(r), &[Lobe::Reflection]),
            (|r| glass(r, 1.5), &[Lobe::Reflection, Lobe::Transmission]),
            (|r| pane(r, 1.5), &[Lobe::Reflection, Lobe::Transmission]),
            (|r| coated(glossy(1.0), r), &[Lobe::Coat]),
        ] as [(fn(f32) -> BsdfInputs, &[Lobe]); 5]
        {
            for &lobe in lobes {
                let [smooth, sharp] = [0.99, 1.01].map(|r| seen(&inputs(r * smallest), cosine, true));
                assert!(smooth.is_delta(lobe) && !sharp.is_delta(lobe), "{lobe:?}");
                assert_eq!((smooth.roughness(lobe), sharp.roughness(lobe) > 0.03), (0.0, true));
                let u = Vec2::new(0.3, 0.5);
                let (a, b) = (smooth.sample(lobe, u).unwrap(), sharp.sample(lobe, u).unwrap());
                assert!(a.incoming.distance(b.incoming) < 0.01, "{lobe:?} at {cosine}: {a:?} {b:?}");
                assert!((a.weight - b.weight).abs().max_element() < 0.02, "{lobe:?} at {cosine}: {a:?} {b:?}");
            }
        }
    }
}

/// Snell's law, and the way back.
#[test]
fn refraction_returns() {
    for ior in [0.8, 1.000_1, 1.33, 1.5, 3.0] {
        for cosine in [1.0, 0.9, 0.75, 0.3] {
            let bsdf = seen(&glass(0.0, ior), cosine, true);
            let Some(entered) = bsdf.sample(Lobe::Transmission, Vec2::ZERO) else {
                assert!(ior < 1.0, "only from inside of the denser side");
                continue;
            };
            let inside = -entered.incoming.dot(NORMAL);
            let sines = [cosine, inside].map(|c| (1.0 - c * c).max(0.0).sqrt());
            // Sines of nearly right cosines hold but half of the digits.
            assert!((sines[0] - ior * sines[1]).abs() < 1e-3, "{ior} {cosine}: {sines:?}");
            // The normal is on the viewer's side, now the inside.
            let back = Bsdf::new(&glass(0.0, ior), -NORMAL, entered.incoming, false);
            let left = back.sample(Lobe::Transmission, Vec2::ZERO).unwrap();
            assert!(left.incoming.distance(at_cosine(cosine)) < 1e-3, "{ior} {cosine}: {left:?}");
            assert!((left.eta * entered.eta - 1.0).abs() < 1e-6);
            let both = left.weight * entered.weight;
            let passed = 1.0 - fresnel_dielectric(cosine, ior);
            assert!((both - passed * passed).abs().max_element() < 1e-4, "{ior} {cosine}: {both} {passed}");
        }
    }
}

/// The shading normal may face away from the viewer: no light, and no other side's.
#[test]
fn views_from_below_see_nothing() {
    for cosine in [-1e-7, -0.3, -1.0] {
        for inputs in [glossy(0.3), metal(0.3), glass(0.0, 1.5), coated(metal(0.2), 0.1)] {
            let bsdf = seen(&inputs, cosine, true);
            assert!(Lobe::ALL[1..].iter().all(|lobe| bsdf.sample(*lobe, Vec2::splat(0.4)).is_none()), "{inputs:?}");
            assert!(Lobe::ALL[1..].iter().all(|lobe| bsdf.eval(*lobe, NORMAL) == Vec3::ZERO), "{inputs:?}");
            assert_eq!(bsdf.diffuse_throughput(), Vec3::ZERO);
            assert_eq!((bsdf.pick(0.7).lobe, bsdf.pick(0.7).probability), (Lobe::Diffuse, 1.0));
        }
    }
}
