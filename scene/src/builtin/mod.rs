//! Scenes that need no file.

use glam::{DMat4, DVec3, Vec3};
use pt_integrator::scene::{Material, TriangleShading};

use crate::builder::Builder;
use crate::error::SceneError;
use crate::info::Info;
use crate::view::View;
use crate::{Loaded, SCHEME};

/// A scene that needs no file.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Builtin {
    /// Its name: it is loaded as `builtin:NAME`.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: &'static str,
    build: fn(&mut Builder),
    view: fn() -> Result<View, &'static str>,
    size: [u32; 2],
}

const BUILTINS: [Builtin; 2] = [
    Builtin {
        name: "cornell",
        description: "the Cornell box in RGB: one area light, two blocks, coloured walls; 512x512",
        build: cornell,
        view: cornell_view,
        size: [512, 512],
    },
    Builtin {
        name: "furnace",
        description: "inside a closed grey box that glows: with N bounces every pixel is exactly 2 - 1/2^N; 256x256",
        build: furnace,
        view: furnace_view,
        size: [256, 256],
    },
];

/// The built-in scenes.
///
/// ```
/// assert!(scene::builtins().iter().any(|b| b.name == "cornell"));
/// ```
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Builds the scene called `name`.
pub(crate) fn load(name: &str) -> Result<Loaded, SceneError> {
    let known = || BUILTINS.map(|b| format!("{SCHEME}{}", b.name)).join(", ");
    let Some(builtin) = BUILTINS.iter().find(|b| b.name == name) else {
        return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: known() });
    };
    let mut builder = Builder::default();
    (builtin.build)(&mut builder);
    builder.finish_world_mesh();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in &builder.data.positions {
        let p = Vec3::from_array(*p).as_dvec3();
        (low, high) = (low.min(p), high.max(p));
    }
    let info = Info { extent: [low.to_array(), high.to_array()], ..Info::default() };
    let view = (builtin.view)().map_err(|what| SceneError::OutOfRange {
        what: "built-in camera",
        value: what.to_owned(),
        expected: "a valid camera",
    })?;
    let name = format!("{SCHEME}{name}");
    let mut loaded = Loaded::new(name, builder, DVec3::ZERO, vec![view], Vec::new(), info)?;
    loaded.size = Some(builtin.size);
    Ok(loaded)
}

/// The Cornell box as Mitsuba 3 has it built in (`mitsuba.cornell_box()`): walls at ±1, radiance and reflectance in
/// linear RGB. Like there, the large block reaches 0.01 below the floor and the light hangs 0.01 below the ceiling.
fn cornell(builder: &mut Builder) {
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
}

fn cornell_view() -> Result<View, &'static str> {
    let position = DVec3::new(0.0, 0.0, 3.9);
    View::look_at("camera".into(), position, DVec3::ZERO, DVec3::Y, 39.3077_f64.to_radians())
}

/// A closed box from −1 to 1, seen from inside, whose walls reflect half and emit radiance 1 to the inside.
///
/// Every point sees the same radiance from everywhere, so each bounce adds half of what the one before did: radiance is
/// the sum of 2⁻ᵏ for k = 0…N, which is 2 − 2⁻ᴺ, after at most N bounces, and 2 without a limit.
fn furnace(builder: &mut Builder) {
    builder.data.materials = vec![Material::emissive([0.5; 3], [1.0; 3])];
    cube(builder, DMat4::from_scale(DVec3::NEG_ONE), 0);
}

fn furnace_view() -> Result<View, &'static str> {
    let (position, target) = (DVec3::new(0.3, 0.2, 0.7), DVec3::new(-0.4, -0.3, -1.0));
    View::look_at("camera".into(), position, target, DVec3::Y, 60_f64.to_radians())
}

/// The square from −1 to 1 in z = 0 with its front towards +z, transformed.
fn rectangle(builder: &mut Builder, to_scene: DMat4, material: u32) {
    let base = builder.data.positions.len() as u32;
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let p = to_scene.transform_point3(DVec3::new(x, y, 0.0));
        builder.data.positions.push(p.as_vec3().to_array());
    }
    let emits = builder.data.materials[material as usize].emits();
    for corners in [[0, 1, 2], [0, 2, 3]] {
        builder.triangle(corners.map(|v| base + v), TriangleShading::flat(material), emits);
    }
}

/// The cube from −1 to 1, its six squares facing outwards, transformed. The corners keep their order, so a mirroring
/// transform turns the fronts inwards.
fn cube(builder: &mut Builder, to_scene: DMat4, material: u32) {
    use std::f64::consts::{FRAC_PI_2, PI};
    let up = DMat4::from_translation(DVec3::Z);
    let sides = [
        DMat4::IDENTITY,
        DMat4::from_rotation_y(FRAC_PI_2),
        DMat4::from_rotation_y(PI),
        DMat4::from_rotation_y(-FRAC_PI_2),
        DMat4::from_rotation_x(FRAC_PI_2),
        DMat4::from_rotation_x(-FRAC_PI_2),
    ];
    for side in sides {
        rectangle(builder, to_scene * side * up, material);
    }
}
