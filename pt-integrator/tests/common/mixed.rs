//! Materials of several lobes, means of paths among them, and the scenes that several tests share.
#![allow(clippy::trivially_copy_pass_by_ref, reason = "as the functions under test")]

use hashcache_core::geometry::Ray;
use pt_integrator::glam::Vec3;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathOutcome, PathSettings, RayCounts, trace_path};
use pt_integrator::sampler::Independent;
use pt_integrator::scene::{Environment, Material, SceneData};

use super::caster::BruteForce;
use super::scenes::{add_sphere, add_triangles, inward_box, quad};

/// Dielectric over a diffuse base.
pub fn plastic(color: [f32; 3], roughness: f32) -> Material {
    Material { specular: [1.0; 4], surface: [0.0, roughness, 0.0, 1.0], ..Material::lambert(color) }
}

pub fn metal(color: [f32; 3], roughness: f32) -> Material {
    Material { surface: [1.0, roughness, 0.0, 1.0], ..plastic(color, roughness) }
}

/// A solid that absorbs so much of each channel a metre.
pub fn glass(ior: f32, roughness: f32, absorption: [f32; 3]) -> Material {
    let [r, g, b] = absorption;
    Material {
        surface: [0.0, roughness, 1.0, 1.0],
        interior: [r, g, b, ior],
        flags: Material::VOLUME,
        ..plastic([1.0; 3], roughness)
    }
}

/// A sheet without thickness.
pub fn pane(color: [f32; 3], roughness: f32) -> Material {
    Material { surface: [0.0, roughness, 1.0, 1.0], ..plastic(color, roughness) }
}

pub fn coated(base: Material, strength: f32, roughness: f32) -> Material {
    Material { coat: [strength, roughness, 1.0, 0.0], ..base }
}

/// Mean by channel and its standard deviation.
pub struct Mean {
    pub mean: [f64; 3],
    pub error: [f64; 3],
}

impl Mean {
    pub fn of(values: impl Iterator<Item = Vec3>) -> Self {
        let (mut sum, mut squares, mut n) = ([0.0; 3], [0.0; 3], 0.0);
        for value in values {
            let value = value.to_array().map(f64::from);
            for c in 0..3 {
                sum[c] += value[c];
                squares[c] += value[c] * value[c];
            }
            n += 1.0;
        }
        let mean = sum.map(|s| s / n);
        let error = [0, 1, 2].map(|c| ((squares[c] / n - mean[c] * mean[c]).max(0.0) / n).sqrt());
        Self { mean, error }
    }

    /// Panics unless two means are one but for chance: 4.5 standard deviations, and rounding.
    pub fn assert_is(&self, other: &Self, what: &str) {
        for c in 0..3 {
            let bound = 4.5 * self.error[c].hypot(other.error[c]) + 2e-5 * other.mean[c].abs();
            let (a, b) = (self.mean[c], other.mean[c]);
            let errors = (self.error[c], other.error[c]);
            assert!((a - b).abs() <= bound, "{what}, channel {c}: {a}, not {b}; errors {errors:?}");
        }
    }

    /// A value that is known.
    pub fn exactly(value: [f64; 3]) -> Self {
        Self { mean: value, error: [0.0; 3] }
    }
}

/// Paths of one ray.
pub fn paths(scene: &SceneData, ray: &Ray, settings: &PathSettings, samples: u32) -> Vec<PathOutcome> {
    let packed = PackedScene::new(scene).unwrap();
    let (view, caster) = (packed.view(), BruteForce::new(scene));
    let mut counts = RayCounts::default();
    let trace = |i| trace_path(&view, &caster, &mut Independent::new(i, 5), ray, settings, &mut counts);
    let outcomes: Vec<PathOutcome> = (0..samples).map(trace).collect();
    assert_eq!(counts.non_finite, 0);
    outcomes
}

pub fn mean_of_paths(scene: &SceneData, ray: &Ray, settings: &PathSettings, samples: u32) -> Mean {
    Mean::of(paths(scene, ray, settings, samples).iter().map(PathOutcome::radiance))
}

/// A room with a lamp, perhaps without its ceiling under a sky, in which every kind of lobe shows: a floor of polished
/// plastic, a coated wall of metal, a mirror, a ball of coloured glass, a pane, a frosted block.
pub fn room(sky: Option<Environment>) -> SceneData {
    let open = sky.is_some();
    let mut scene = SceneData { environment: sky, ..SceneData::default() };
    let walls = inward_box(Vec3::splat(-1.0), Vec3::ONE);
    let plain = Material::lambert([0.6, 0.5, 0.4]);
    for (wall, material) in [
        metal([0.7, 0.6, 0.2], 0.0),
        plastic([0.5, 0.1, 0.1], 0.1),
        plain,
        coated(metal([0.5, 0.6, 0.7], 0.5), 1.0, 0.0),
        plain,
        coated(plastic([0.2, 0.5, 0.2], 0.6), 0.7, 0.3),
    ]
    .into_iter()
    .enumerate()
    {
        if !(open && wall == 4) {
            add_triangles(&mut scene, &walls[2 * wall..2 * wall + 2], material);
        }
    }
    let lamp = quad(Vec3::new(-0.4, 0.95, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    add_triangles(&mut scene, &lamp, Material::emissive([0.2; 3], [3.0, 2.0, 1.0]));
    add_sphere(&mut scene, Vec3::new(0.3, -0.5, 0.2), 0.3, 4, true, glass(1.5, 0.0, [1.0, 0.2, 3.0]));
    let block = inward_box(Vec3::new(-0.7, -0.6, -0.5), Vec3::new(-0.2, -0.9, -0.1));
    add_triangles(&mut scene, &block, glass(1.3, 0.4, [0.5, 0.0, 0.0]));
    add_triangles(
        &mut scene,
        &quad(Vec3::new(-0.5, -0.2, 0.3), 0.4 * Vec3::X, 0.5 * Vec3::Y),
        pane([0.9, 0.7, 0.8], 0.2),
    );
    scene
}
