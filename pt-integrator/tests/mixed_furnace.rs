//! Surfaces of every lobe where all light is known: nothing gains, and what loses nothing shows no difference.
#![allow(clippy::disallowed_methods, reason = "expectations come from the platform's functions and exact values")]

mod common;

use common::mixed::{Mean, coated, glass, mean_of_paths, metal, pane, paths, plastic};
use common::scenes::{add_sphere, add_triangles, inward_box};
use pt_integrator::glam::Vec3;
use pt_integrator::path::PathSettings;
use pt_integrator::ray::ray_towards;
use pt_integrator::scene::{Environment, EnvironmentImage, Material, SceneData};

const SETTINGS: PathSettings = PathSettings { max_bounces: 100, roulette_depth: PathSettings::NO_ROULETTE };

/// A ball of this material; `image`: the same even sky as a picture, found by next event too.
fn ball(material: Material, image: bool, smooth: bool) -> SceneData {
    let sky = Environment::Image(EnvironmentImage { width: 8, height: 4, texels: vec![[1.0; 4]; 32] });
    let sky = if image { sky } else { Environment::Constant([1.0; 3]) };
    let mut scene = SceneData { environment: Some(sky), ..SceneData::default() };
    add_sphere(&mut scene, Vec3::ZERO, 1.0, 12, smooth, material);
    scene
}

fn looks() -> [Vec3; 3] {
    // Through the middle, half-way out, and grazing.
    [0.03, 0.55, 0.9].map(|x| Vec3::new(x, 0.2 * x, 3.0))
}

#[test]
fn nothing_gains_light() {
    for (what, material) in [
        ("rough metal", metal([1.0; 3], 0.7)),
        ("metal", metal([1.0; 3], 0.3)),
        ("plastic", plastic([1.0; 3], 0.3)),
        ("rough plastic", plastic([1.0; 3], 1.0)),
        ("polished plastic", plastic([1.0; 3], 0.0)),
        ("rough glass", glass(1.5, 0.5, [0.0; 3])),
        ("frosted pane", pane([1.0; 3], 0.5)),
        ("coated metal", coated(metal([1.0; 3], 0.3), 1.0, 0.0)),
        ("coated plastic", coated(plastic([1.0; 3], 0.5), 1.0, 0.4)),
        ("coated glass", coated(glass(1.5, 0.0, [0.0; 3]), 1.0, 0.0)),
        ("all at once", coated(Material { surface: [0.3, 0.3, 0.5, 1.0], ..plastic([1.0; 3], 0.3) }, 0.5, 0.1)),
    ] {
        for from in looks() {
            let ray = ray_towards(from, Vec3::NEG_Z);
            let constant = mean_of_paths(&ball(material, false, true), &ray, &SETTINGS, 2000);
            for c in 0..3 {
                let most = 1.0 + 4.5 * constant.error[c] + 1e-4;
                assert!(constant.mean[c] <= most && constant.mean[c] > 0.3, "{what} from {from}: {}", constant.mean[c]);
            }
            // Next event and scattering share the light of a picture, and lose none of it.
            mean_of_paths(&ball(material, true, true), &ray, &SETTINGS, 2000).assert_is(&constant, what);
        }
    }
}

/// Smooth surfaces that absorb nothing are not seen in an even light, on no path.
#[test]
fn lossless_surfaces_vanish() {
    for (what, material) in
        [("mirror", metal([1.0; 3], 0.0)), ("glass", glass(1.5, 0.0, [0.0; 3])), ("pane", pane([1.0; 3], 0.0))]
    {
        for image in [false, true] {
            // Flat: a mirror whose smooth normals lean over its facets sends light into itself.
            let scene = ball(material, image, false);
            for from in looks() {
                let all = paths(&scene, &ray_towards(from, Vec3::NEG_Z), &SETTINGS, 256);
                for outcome in &all {
                    assert!(!outcome.has_vertex);
                }
                let dim = all.iter().filter(|o| (o.radiance() - 1.0).abs().max_element() > 1e-3).count();
                assert_eq!(dim, 0, "{what} from {from}");
            }
        }
    }
}

/// On the rims of a smooth-shaded solid normals point away from the viewer, reflected rays go in, and bent ones stay out.
/// Light is that of the side from which it comes all the same: clear glass is not seen on any path that leaves it,
/// other solids gain nothing, and next event finds what scattering finds.
#[test]
fn smooth_rims_gain_nothing() {
    let settings = PathSettings { max_bounces: 1000, ..SETTINGS };
    let half = Material { surface: [0.0, 0.0, 0.5, 1.0], ..glass(1.5, 0.0, [0.0; 3]) };
    // A third of a facet off the mesh's own directions, so that the rim is no edge.
    let (sine, cosine) = 0.09_f32.sin_cos();
    let past = |x: f32, y: f32| {
        let direction = Vec3::new(sine, 0.0, -cosine);
        ray_towards(Vec3::new(cosine, 0.0, sine) * x + Vec3::Y * y - direction * 3.0, direction)
    };
    for (what, material, clear) in [
        ("glass", glass(1.5, 0.0, [0.0; 3]), true),
        ("dense glass", glass(2.4, 0.0, [0.0; 3]), true),
        ("half glass", half, false),
        ("coated half glass", coated(half, 1.0, 0.3), false),
        ("rough glass", glass(1.5, 0.5, [0.0; 3]), false),
    ] {
        let [constant, image] = [false, true].map(|image| ball(material, image, true));
        if clear {
            let mut trapped = 0;
            for x in (0..128).map(|i| 0.872 + 0.001 * i as f32) {
                let ray = past(x, 0.3 * x);
                for outcome in paths(&constant, &ray, &settings, 16).iter().chain(&paths(&image, &ray, &settings, 16)) {
                    let radiance = outcome.radiance();
                    trapped += usize::from(radiance == Vec3::ZERO);
                    let vanishes = (radiance - 1.0).abs().max_element() < 1e-3;
                    assert!(vanishes || radiance == Vec3::ZERO, "{what} at {x}: {outcome:?}");
                }
            }
            // Mirrored into the solid, and there round and round.
            assert!(100 * trapped < 128 * 32, "{what}: {trapped} paths stay inside");
            continue;
        }
        for x in [0.03_f32, 0.8, 0.93, 0.97, 0.98, 0.99, 0.995] {
            let ray = past(x, 0.02);
            let scattered = mean_of_paths(&constant, &ray, &settings, 2000);
            let most = 1.0 + 4.5 * scattered.error[0] + 1e-4;
            assert!(scattered.mean[0] <= most && scattered.error[0] < 0.05, "{what} at {x}: {}", scattered.mean[0]);
            mean_of_paths(&image, &ray, &settings, 2000).assert_is(&scattered, &format!("{what} at {x}"));
        }
    }
}

/// In a closed box of white mirrors that also shine, each reflection adds 1 on every path.
#[test]
fn box_of_shining_mirrors() {
    let mut scene = SceneData::default();
    let mirror = Material { emission: [1.0, 1.0, 1.0, 0.0], ..metal([1.0; 3], 0.0) };
    add_triangles(&mut scene, &inward_box(Vec3::new(-1.0, -0.8, -1.2), Vec3::new(1.1, 0.9, 1.0)), mirror);
    let ray = ray_towards(Vec3::splat(0.1), Vec3::new(0.3, 0.5, 0.8).normalize());
    for max_bounces in [0, 1, 2, 9] {
        for outcome in paths(&scene, &ray, &PathSettings { max_bounces, ..SETTINGS }, 8) {
            assert!(!outcome.has_vertex);
            let error = (outcome.radiance() / (max_bounces + 1) as f32 - 1.0).abs().max_element();
            assert!(error < 1e-5, "{max_bounces}: {outcome:?}");
        }
    }
}

/// Roulette changes the noise, not the mean, whatever the lobes.
#[test]
fn roulette_keeps_the_mean() {
    let sky = Environment::Constant([1.0, 0.5, 2.0]);
    let scene = common::mixed::room(Some(sky));
    let ray = ray_towards(Vec3::new(-0.9, 0.1, 0.7), Vec3::new(1.0, -0.5, -0.5).normalize());
    let whole = mean_of_paths(&scene, &ray, &PathSettings { max_bounces: 20, ..SETTINGS }, 20_000);
    for roulette_depth in [1, 3] {
        let settings = PathSettings { max_bounces: 20, roulette_depth };
        mean_of_paths(&scene, &ray, &settings, 20_000).assert_is(&whole, "roulette");
    }
    assert!(whole.error[0] < 0.05 * whole.mean[0], "the test must be able to fail");
}

/// A closed room of shining chalk, mirrors and panes: the light is as even as it was of chalk alone, emission over
/// 1 − albedo.
#[test]
fn integrating_box_with_mirrors() {
    let mut scene = SceneData::default();
    let walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    add_triangles(&mut scene, &walls[..4], metal([1.0; 3], 0.0));
    // Shining to both sides: behind the panes, and before a larger box of mirrors, its back is seen.
    let chalk = Material { flags: Material::DOUBLE_SIDED, ..Material::emissive([0.5; 3], [1.0, 2.0, 3.0]) };
    add_triangles(&mut scene, &walls[4..8], chalk);
    add_triangles(&mut scene, &walls[8..], pane([1.0; 3], 0.0));
    add_triangles(&mut scene, &inward_box(Vec3::splat(-1.5), Vec3::splat(1.5)), metal([1.0; 3], 0.0));
    let ray = ray_towards(Vec3::splat(0.1), Vec3::new(0.3, 0.5, 0.8).normalize());
    let settings = PathSettings { max_bounces: 400, ..SETTINGS };
    mean_of_paths(&scene, &ray, &settings, 2000).assert_is(&Mean::exactly([2.0, 4.0, 6.0]), "chalk, mirrors, panes");
}
