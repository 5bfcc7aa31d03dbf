//! Light bent by glass.

use std::f64::consts::TAU;

use glam::DVec3;
use pt_integrator::scene::{Environment, Material};

use super::Builtin;
use super::materials::glass;
use super::shapes::{lathe, parallelogram, sphere};
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "caustic-glass",
    description: "a clear ball and an amber ring of glass, and the light that they gather on a floor; 512x384",
    parameter: None,
    build: |builder, _| build(builder),
    view,
    size: [512, 384],
};

/// A clear ball and an amber ring of glass on a white floor, under a lamp of half a metre. What is bright on the floor
/// and on the wall behind has come through glass: no straight line to the lamp finds it.
fn build(builder: &mut Builder) {
    const WHITE: u32 = 0;
    const LAMP: u32 = 1;
    const CLEAR: u32 = 2;
    const AMBER: u32 = 3;
    builder.data.materials = vec![
        Material::lambert([0.75; 3]),
        Material::emissive([0.0; 3], [120.0, 114.0, 102.0]),
        glass([0.0; 3]),
        glass([0.3, 1.6, 7.0]),
    ];
    builder.data.environment = Some(Environment::Constant([0.02, 0.025, 0.03]));
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    parallelogram(builder, [DVec3::new(-3.0, 0.0, -1.5), z * 4.5, x * 6.0], [0.0; 2], WHITE);
    parallelogram(builder, [DVec3::new(-3.0, 0.0, -1.5), x * 6.0, y * 3.0], [0.0; 2], WHITE);
    // Above and to the left, facing down.
    parallelogram(builder, [DVec3::new(-1.75, 3.2, 0.75), x * 0.5, z * 0.5], [0.0; 2], LAMP);
    sphere(builder, DVec3::new(-0.55, 0.601, 0.0), 0.6, [96, 48], CLEAR);
    lathe(builder, DVec3::new(0.85, 0.171, 0.55), [96, 48], AMBER, |v| {
        // The circle's last point is its first again, to the bit.
        let (up, out) = (TAU * v.rem_euclid(1.0)).sin_cos();
        [0.42 + 0.17 * out, 0.17 * up]
    });
    builder.finish_world_mesh();
}

fn view() -> Result<View, &'static str> {
    let (position, target) = (DVec3::new(0.6, 1.9, 4.6), DVec3::new(0.15, 0.45, 0.0));
    View::look_at("camera".into(), position, target, DVec3::Y, 38_f64.to_radians())
}
