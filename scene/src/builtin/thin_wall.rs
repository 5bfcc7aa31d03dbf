//! Two rooms and a wall through which light must not pass.

use glam::DVec3;
use pt_integrator::scene::Material;

use super::shapes::{cuboid, parallelogram};
use super::{Builtin, Parameter};
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "thin-wall",
    description: "two rooms and a wall between them, 0.02 m or as thin as builtin:thin-wall:METRES says; the right one is black; 512x256",
    parameter: Some(THICKNESS),
    build,
    view,
    size: [512, 256],
};

/// The wall's thickness.
const THICKNESS: Parameter = Parameter {
    name: "thickness of builtin:thin-wall",
    default: 0.02,
    range: [1e-6, 1.0],
    expected: "metres from 1e-6 to 1, as in builtin:thin-wall:0.02",
};

/// A box from (−2, 0, −2) to (2, 2, 0), open towards the camera (+z), and a wall at x = 0 that reaches to the opening.
/// Everything reflects 0.7; only a lamp in the left room shines, away from the camera.
///
/// No straight line leads from one room to the other: it would leave the opening's plane and come back. So the right room
/// is black, and what a picture shows where the camera looks through the opening at x > thickness/2 has leaked.
fn build(builder: &mut Builder, thickness: f64) {
    builder.data.materials = vec![Material::lambert([0.7; 3]), Material::emissive([0.7; 3], [10.0; 3])];
    let (grey, light) = (0, 1);
    let low = DVec3::new(-2.0, 0.0, -2.0);
    let (x, y, z) = (DVec3::X * 4.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    // Floor, ceiling, back, left, right.
    for sides in [[low, z, x], [low + y, x, z], [low, x, y], [low, y, z], [low + x, z, y]] {
        parallelogram(builder, sides, [0.0; 2], grey);
    }
    cuboid(builder, [-0.5 * thickness, 0.0, -2.0], [0.5 * thickness, 2.0, 0.0], grey);
    // A strip above the opening, shining into the room.
    let strip = [DVec3::new(-1.8, 1.7, -0.15), DVec3::Y * 0.2, DVec3::X * 1.6];
    parallelogram(builder, strip, [0.0; 2], light);
    builder.finish_world_mesh();
}

/// From the right, so that the wall's dark side shows.
fn view() -> Result<View, &'static str> {
    let position = DVec3::new(0.5, 1.0, 4.0);
    View::look_at("camera".into(), position, position - DVec3::Z, DVec3::Y, 35_f64.to_radians())
}
