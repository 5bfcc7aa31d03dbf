//! Many triangles, few stored.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};
use hashcache_core::geometry::Instance;
use hashcache_core::hash::{pcg, to_unit_f32};
use pt_integrator::scene::{Environment, Material};

use super::Builtin;
use super::shapes::{cuboid, lathe, parallelogram, surface};
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "instances",
    description: "a million triangles: three shrubs of five thousand, placed 256 times under a lamp and a sky; 640x360",
    parameter: None,
    build: |builder, _| build(builder),
    view,
    size: [640, 360],
};

/// Shrubs along a side of the field, and metres between them.
const SIDE: u32 = 16;
const SPACING: f64 = 2.5;

/// A field of shrubs, of which only three are stored, on a floor, under a lamp and a sky of even radiance.
fn build(builder: &mut Builder) {
    const FLOOR: u32 = 0;
    const LAMP: u32 = 1;
    const WOOD: u32 = 2;
    const LEAVES: [[f32; 3]; 3] = [[0.18, 0.42, 0.12], [0.45, 0.4, 0.1], [0.55, 0.18, 0.16]];
    builder.data.materials = vec![
        Material::lambert([0.45, 0.42, 0.38]),
        Material::emissive([0.0; 3], [90.0, 80.0, 62.0]),
        Material::lambert([0.3, 0.2, 0.12]),
    ];
    builder.data.materials.extend(LEAVES.map(Material::lambert));
    builder.data.environment = Some(Environment::Constant([0.35, 0.45, 0.6]));
    let half = 0.5 * SPACING * f64::from(SIDE) + 2.0;
    cuboid(builder, [-half, -0.5, -half], [half, 0.0, half], FLOOR);
    parallelogram(builder, [DVec3::new(-15.0, 24.0, 5.0), DVec3::X * 6.0, DVec3::Z * 6.0], [0.0; 2], LAMP);
    builder.finish_world_mesh();
    let shrubs = [0_u32, 1, 2].map(|kind| {
        shrub(builder, f64::from(kind), 3 + kind, WOOD);
        builder.finish_mesh()
    });
    for i in 0..SIDE * SIDE {
        let draw = |k: u32| f64::from(to_unit_f32(pcg(i * 8 + k)));
        let at = |i: u32, k: u32| (f64::from(i) + 0.5 + 0.3 * (draw(k) - 0.5)) * SPACING - half + 2.0;
        let place = DVec3::new(at(i % SIDE, 0), 0.0, at(i / SIDE, 1));
        let turn = DMat3::from_rotation_y(TAU * draw(2)) * (0.7 + 0.5 * draw(3));
        let kind = (draw(4) * 3.0) as usize;
        let Some(mesh) = shrubs[kind] else { continue };
        let row = |r: usize| [turn.row(r).x as f32, turn.row(r).y as f32, turn.row(r).z as f32, place[r] as f32];
        builder.data.instances.push(Instance {
            to_scene: [row(0), row(1), row(2)],
            mesh,
            mirrored: 0,
            reserved: [0; 2],
        });
    }
}

/// A bumpy crown on a stem, two metres high, about five thousand triangles.
fn shrub(builder: &mut Builder, kind: f64, leaves: u32, wood: u32) {
    lathe(builder, DVec3::ZERO, [12, 1], wood, |v| [0.08 - 0.02 * v, 0.7 * v]);
    surface(builder, [80, 32], leaves, |u, v| {
        let (around, up) = (TAU * u.rem_euclid(1.0), PI * v);
        let bumps = ((5.0 + kind) * around).sin() * (6.0 * up).sin()
            + 0.6 * (11.0 * around + 2.0 * kind).cos() * (9.0 * up).sin();
        let (sin, cos) = up.sin_cos();
        let ring = if sin < 1e-12 { 0.0 } else { (0.85 + 0.08 * bumps) * sin };
        DVec3::new(ring * around.sin(), 1.25 - (0.75 + 0.07 * bumps * sin) * cos, ring * around.cos())
    });
}

fn view() -> Result<View, &'static str> {
    let (position, target) = (DVec3::new(6.0, 7.0, 26.0), DVec3::new(-1.0, 0.0, 4.0));
    View::look_at("camera".into(), position, target, DVec3::Y, 45_f64.to_radians())
}
