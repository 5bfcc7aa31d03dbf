//! The Cornell box.

use glam::{DMat4, DVec3};
use pt_integrator::scene::Material;

use super::Builtin;
use super::shapes::{cube, rectangle};
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "cornell",
    description: "the Cornell box in RGB: one area light, two blocks, coloured walls; 512x512",
    parameter: None,
    build: |builder, _| build(builder),
    view,
    size: [512, 512],
};

/// The Cornell box as Mitsuba 3 has it built in (`mitsuba.cornell_box()`): walls at ±1, radiance and reflectance in
/// linear RGB. Like there, the large block reaches 0.01 below the floor and the light hangs 0.01 below the ceiling.
fn build(builder: &mut Builder) {
    const WHITE: [f32; 3] = [0.885_809, 0.698_859, 0.666_422];
    const GREEN: [f32; 3] = [0.105_421, 0.377_98, 0.076_425];
    const RED: [f32; 3] = [0.570_068, 0.043_013_5, 0.044_370_6];
    const LIGHT: [f32; 3] = [18.387, 13.987_3, 6.753_57];
    let (x, y) = (DVec3::X, DVec3::Y);
    let turn = |axis: DVec3, degrees: f64| DMat4::from_axis_angle(axis, degrees.to_radians());
    let shift = |x, y, z| DMat4::from_translation(DVec3::new(x, y, z));
    let scale = |x, y, z| DMat4::from_scale(DVec3::new(x, y, z));
    builder.data.materials = vec![
        Material::lambert(WHITE),
        Material::lambert(GREEN),
        Material::lambert(RED),
        Material::emissive(WHITE, LIGHT),
    ];
    let (white, green, red, light) = (0, 1, 2, 3);
    rectangle(builder, shift(0.0, 0.99, 0.01) * turn(x, 90.0) * scale(0.23, 0.19, 0.19), light);
    rectangle(builder, shift(0.0, -1.0, 0.0) * turn(x, -90.0), white);
    rectangle(builder, shift(0.0, 1.0, 0.0) * turn(x, 90.0), white);
    rectangle(builder, shift(0.0, 0.0, -1.0), white);
    rectangle(builder, shift(1.0, 0.0, 0.0) * turn(y, -90.0), green);
    rectangle(builder, shift(-1.0, 0.0, 0.0) * turn(y, 90.0), red);
    cube(builder, shift(0.335, -0.7, 0.38) * turn(y, -17.0) * scale(0.3, 0.3, 0.3), white);
    cube(builder, shift(-0.33, -0.4, -0.28) * turn(y, 18.25) * scale(0.3, 0.61, 0.3), white);
    builder.finish_world_mesh();
}

fn view() -> Result<View, &'static str> {
    let position = DVec3::new(0.0, 0.0, 3.9);
    View::look_at("camera".into(), position, DVec3::ZERO, DVec3::Y, 39.3077_f64.to_radians())
}
