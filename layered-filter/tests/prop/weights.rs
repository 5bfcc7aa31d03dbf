//! Weights against the paper's formulas in f64.

use hashcache_core::glam::DVec3;
use layered_filter::{GuideRecord, GuideScale, LuminanceWeight, PreparedGuide, WeightSettings, Weights};
use proptest::prelude::*;

use super::{any_float, settings};

/// A guide as plain numbers: position, normal, lengths in radii, L*a*b*, shininess.
struct Model {
    position: DVec3,
    normal: DVec3,
    path: f64,
    segment: f64,
    lab: DVec3,
    shininess: f64,
}

impl Model {
    fn new(record: &GuideRecord, radius: f64) -> Self {
        let wide = |v: [f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
        Self {
            position: wide(record.position_path) / radius,
            normal: wide(record.normal_segment),
            path: f64::from(record.position_path[3]) / radius,
            segment: f64::from(record.normal_segment[3]) / radius,
            lab: lab(wide(record.albedo_shininess)),
            shininess: record.albedo_shininess[3].into(),
        }
    }
}

/// CIE 15:2018, with Rec. 709's matrix and D65.
fn lab(rgb: DVec3) -> DVec3 {
    let x = (0.412_390_8 * rgb.x + 0.357_584_34 * rgb.y + 0.180_480_79 * rgb.z) / 0.950_455_93;
    let y = 0.212_639_01 * rgb.x + 0.715_168_68 * rgb.y + 0.072_192_32 * rgb.z;
    let z = (0.019_330_82 * rgb.x + 0.119_194_78 * rgb.y + 0.950_532_15 * rgb.z) / 1.089_057_75;
    let f = |t: f64| {
        if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t / (3.0 * (6.0_f64 / 29.0).powi(2)) + 4.0 / 29.0 }
    };
    DVec3::new(116.0 * f(y) - 16.0, 500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z)))
}

fn bell(x: f64) -> f64 {
    (1.0 - x / 8.0).max(0.0).powi(8)
}

/// Equations 2 to 5 and the two further guides.
fn model(s: &WeightSettings, p: &Model, q: &Model) -> f64 {
    let w = |v: f32| f64::from(v);
    let normal = w(s.normal_scale) * p.normal.dot(q.normal).clamp(0.0, 1.0).powi(1 << s.normal_squarings);
    let path = (1.0 - w(s.path_scale) * (p.path - q.path).abs()).max(0.0);
    let segment = (1.0 - w(s.segment_scale) * (p.segment - q.segment).abs()).max(0.0);
    let plane = bell((w(s.plane_scale) * p.normal.dot(q.position - p.position) / p.path).powi(2));
    let position = bell((w(s.position_scale) * (q.position - p.position).length()).powi(2));
    let kappa = w(s.color_kappa);
    let difference = (1.0 + kappa * (p.lab - q.lab).length()).ln() / kappa;
    let scale = w(if p.shininess > 0.0 { s.color_glossy } else { s.color_diffuse });
    let color = (1.0 - scale * difference / (difference + 1.0)).max(0.0);
    normal * path * segment * plane * position * color
}

fn record() -> impl Strategy<Value = GuideRecord> {
    let place = (prop::array::uniform3(-0.01_f32..0.01), prop::array::uniform3(-0.2_f32..0.2));
    let lengths = (4.99_f32..5.01, 1.99_f32..2.01);
    (place, lengths, prop::array::uniform3(0.40_f32..0.45), prop::bool::ANY).prop_map(
        |(([x, y, z], [nx, ny, nz]), (path, segment), [r, g, b], glossy)| GuideRecord {
            position_path: [x, y, z, path],
            normal_segment: DVec3::new(nx.into(), 1.0 + f64::from(ny), nz.into())
                .normalize()
                .as_vec3()
                .extend(segment)
                .to_array(),
            albedo_shininess: [r, g, b, if glossy { 10.0 } else { 0.0 }],
            throughput: [1.0; 4],
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Near in all guides, so that most weights are above 0. The bound: lengths of 1/2 radius have rounding of 3·10⁻⁸,
    /// times a scale of 400; L* a* b* of 50 have a rounding of 4·10⁻⁶, and Δc is steep there, times 3.
    #[test]
    fn weights_are_the_papers(p in record(), q in record(), radius in 1.0_f32..20.0) {
        let scale = GuideScale::new(radius).unwrap();
        let (a, b) = (PreparedGuide::new(&scale, &p), PreparedGuide::new(&scale, &q));
        let (p, q) = (Model::new(&p, radius.into()), Model::new(&q, radius.into()));
        for settings in settings() {
            let found = f64::from(Weights::new(&settings).unwrap().guides(&a, &b));
            let expected = model(&settings, &p, &q);
            prop_assert!((found - expected).abs() < 2e-4, "{settings:?}: {found} for {expected}");
        }
    }

    #[test]
    fn luminance_weights_are_the_papers(p in 0.0_f32..10.0, q in 0.0_f32..10.0, scale in 0.0_f32..5.0, k in -3_i32..3) {
        let kappa = 2.0_f32.powi(k);
        let luminance = LuminanceWeight::Difference { scale, kappa };
        let weights = Weights::new(&WeightSettings { luminance, ..WeightSettings::PAPER }).unwrap();
        let found = f64::from(weights.luminance_of(Some(p), 0.0).weight(q, 0.0));
        let difference = f64::from(kappa) * (f64::from(p) - f64::from(q)).abs();
        let expected = (1.0 - (1.0 + f64::from(scale) * difference / (difference + 1.0)).ln()).max(0.0);
        prop_assert!((found - expected).abs() < 1e-5, "{found} for {expected}");
    }

    /// exp(−Δ/(s·σ)) within what `falloff` promises, whatever the exposure.
    #[test]
    fn deviations_do_not_know_exposure(d in 0.0_f32..10.0, sigma in 0.01_f32..1.0, e in -38_i32..38) {
        let unit = 2.0_f32.powi(e);
        let luminance = LuminanceWeight::Deviation { scale: 2.0 };
        let weights = Weights::new(&WeightSettings { luminance, ..WeightSettings::PAPER }).unwrap();
        let around = weights.luminance_of(Some(3.0 * unit), (sigma * unit) * (sigma * unit));
        let found = f64::from(around.weight((3.0 + d) * unit, 0.0));
        let expected = (-f64::from(d) / (2.0 * f64::from(sigma))).exp();
        prop_assert!((found - expected).abs() < 0.037, "{found} for {expected}");
    }

    /// exp(−Δ²/(s²·(σ_p² + σ_q²))) within what `falloff` promises, whatever the exposure, and the same from both sides.
    #[test]
    fn significance_is_mutual(d in 0.0_f32..10.0, a in 0.01_f32..1.0, b in 0.01_f32..1.0, e in -38_i32..38) {
        let unit = 2.0_f32.powi(e);
        let luminance = LuminanceWeight::Significance { scale: 2.0 };
        let weights = Weights::new(&WeightSettings { luminance, ..WeightSettings::PAPER }).unwrap();
        let (p, q) = (3.0 * unit, (3.0 + d) * unit);
        let (v, w) = ((a * unit) * (a * unit), (b * unit) * (b * unit));
        let found = f64::from(weights.luminance_of(Some(p), v).weight(q, w));
        let back = f64::from(weights.luminance_of(Some(q), w).weight(p, v));
        let [d, a, b] = [d, a, b].map(f64::from);
        let expected = (-d * d / (4.0 * (a * a + b * b))).exp();
        prop_assert!((found - expected).abs() < 0.037, "{found} for {expected}");
        prop_assert!((found - back).abs() < 1e-3, "{found}, {back}");
        prop_assert_eq!(weights.luminance_of(Some(p), v).weight(q, f32::INFINITY), 1.0);
        prop_assert_eq!(weights.luminance_of(Some(p), 0.0).weight(p, 0.0), 1.0);
    }

    /// Any bits at all: a weight is a number from 0 on, and 0 where nothing is known.
    #[test]
    fn hostile_guides_weigh_nothing_or_something(
        p in prop::array::uniform16(any_float()), q in prop::array::uniform16(any_float()),
        l in prop::array::uniform3(any_float()),
    ) {
        let p: PreparedGuide = bytemuck::cast(p);
        let q: PreparedGuide = bytemuck::cast(q);
        for settings in settings() {
            let weights = Weights::new(&settings).unwrap();
            for (p, q) in [(&p, &q), (&p, &PreparedGuide::NONE), (&PreparedGuide::NONE, &q)] {
                let weight = weights.guides(p, q);
                prop_assert!((0.0..=settings.normal_scale).contains(&weight), "{weight}");
            }
            prop_assert_eq!(weights.guides(&PreparedGuide::NONE, &q), 0.0);
            let weight = weights.luminance_of(Some(l[0]), l[1]).weight(l[2], l[1]);
            prop_assert!(weight.is_nan() || (0.0..=1.0).contains(&weight), "{weight}");
        }
    }
}

#[test]
fn lengths_count_in_scene_radii() {
    let record = |factor: f32| GuideRecord {
        position_path: [0.1 * factor, 0.0, 0.2 * factor, 1.001 * factor],
        normal_segment: [0.0, 1.0, 0.0, 0.9995 * factor],
        albedo_shininess: [0.5, 0.5, 0.5, 0.0],
        ..GuideRecord::NONE
    };
    let near = |factor: f32| GuideRecord {
        position_path: [0.11 * factor, 0.0, 0.2 * factor, factor],
        normal_segment: [0.0, 1.0, 0.0, factor],
        ..record(factor)
    };
    for settings in settings() {
        let weights = Weights::new(&settings).unwrap();
        let weight = |factor: f32| {
            let scale = GuideScale::new(2.0 * factor).unwrap();
            weights.guides(&PreparedGuide::new(&scale, &record(factor)), &PreparedGuide::new(&scale, &near(factor)))
        };
        for exponent in [-30, -13, 23, 60] {
            let (here, there) = (weight(1.0), weight(2.0_f32.powi(exponent)));
            assert!((here - there).abs() < 1e-6, "{settings:?}, 2^{exponent}: {here}, {there}");
        }
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let paper = WeightSettings::PAPER;
    for bad in [
        WeightSettings { normal_scale: f32::NAN, ..paper },
        WeightSettings { normal_squarings: 11, ..paper },
        WeightSettings { plane_scale: -1.0, ..paper },
        WeightSettings { color_kappa: 0.0, ..paper },
        WeightSettings { luminance: LuminanceWeight::Deviation { scale: 0.0 }, ..paper },
        WeightSettings { luminance: LuminanceWeight::Difference { scale: 1.0, kappa: 0.0 }, ..paper },
    ] {
        assert!(Weights::new(&bad).is_err(), "{bad:?}");
    }
}
