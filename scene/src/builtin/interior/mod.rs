//! A room without a lamp in sight.

mod furniture;

use glam::DVec3;
use hashcache_core::hash::{pcg2d, to_unit_f32};
use pt_integrator::scene::{Material, Texture, Wrap};

use super::Builtin;
use super::materials::{glass, mirror, pane, polished};
use super::shapes::{cuboid, lathe, parallelogram};
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "interior",
    description: "a furnished room whose lamps are hidden and shine at the ceiling, with a polished floor, a mirror and glass: nearly all light is indirect; 640x360",
    parameter: None,
    build: |builder, _| build(builder),
    view,
    size: [640, 360],
};

/// The room from (0, 0, 0) to here, in metres.
const ROOM: DVec3 = DVec3::new(6.0, 2.8, 4.5);

// Materials, in the order of the list.
const WALL: u32 = 0;
const FLOOR: u32 = 1;
const CLAY: u32 = 2;
const WOOD: u32 = 3;
const DARK: u32 = 4;
const CLOTH: u32 = 5;
const CUSHION: u32 = 6;
const RUG: u32 = 7;
const COVE_LIGHT: u32 = 8;
const BOWL_LIGHT: u32 = 9;
const MIRROR: u32 = 10;
const PANE: u32 = 11;
const BALL: u32 = 12;
/// The first of the books' colours.
const BOOKS: u32 = 13;
const BOOK_COLORS: [[f32; 3]; 5] =
    [[0.5, 0.1, 0.08], [0.08, 0.2, 0.4], [0.1, 0.3, 0.15], [0.6, 0.5, 0.3], [0.25, 0.2, 0.3]];

/// Of the tiles: reflections are sharp where things stand on them and blur with the distance.
const FLOOR_ROUGHNESS: f32 = 0.15;

/// A living room. One lamp lies in a trough below the ceiling, along the back wall; one in the bowl of a floor lamp. Both
/// shine upwards and nothing that a visitor looks at lies in their light but the ceiling and the tops of the walls. The
/// tiles are polished, a mirror hangs beside the picture, half of the shelf has a pane, and the ball is of glass.
fn build(builder: &mut Builder) {
    builder.data.materials = vec![
        Material::lambert([0.78, 0.76, 0.72]),
        polished(Material::lambert([1.0; 3]).textured(Material::BASE_COLOR, 0), FLOOR_ROUGHNESS),
        Material::lambert([0.7, 0.36, 0.24]),
        Material::lambert([0.45, 0.29, 0.16]),
        Material::lambert([0.12, 0.11, 0.1]),
        Material::lambert([0.22, 0.32, 0.38]),
        Material::lambert([0.7, 0.55, 0.2]),
        Material::lambert([1.0; 3]).textured(Material::BASE_COLOR, 1),
        Material::emissive([0.5; 3], [52.0, 44.0, 32.0]),
        Material::emissive([0.5; 3], [260.0, 200.0, 130.0]),
        mirror([0.92, 0.93, 0.92]),
        pane(),
        glass([1.2, 0.4, 0.9]),
    ];
    builder.data.materials.extend(BOOK_COLORS.map(Material::lambert));
    checker(builder, 2, [[178, 160, 138], [116, 92, 70]]);
    checker(builder, 6, [[168, 60, 48], [196, 180, 150]]);
    shell(builder);
    lamps(builder);
    furniture::build(builder);
    builder.finish_world_mesh();
}

fn view() -> Result<View, &'static str> {
    let (position, target) = (DVec3::new(5.5, 1.55, 4.2), DVec3::new(1.9, 0.95, 1.0));
    View::look_at("camera".into(), position, target, DVec3::Y, 55_f64.to_radians())
}

/// A square texture of `fields` × `fields` squares in two sRGB colours, with a grain of a few steps.
fn checker(builder: &mut Builder, fields: u32, colors: [[u32; 3]; 2]) {
    // Texels a field: edges are sharp at a few centimetres' distance.
    const FIELD: u32 = 48;
    const GRAIN: f32 = 14.0;
    let (side, first_texel) = (fields * FIELD, builder.data.texels.len() as u32);
    builder.data.texels.extend((0..side * side).map(|i| {
        let (x, y) = (i % side, i / side);
        let grain = (to_unit_f32(pcg2d([x / 2, y])[0]) * GRAIN) as u32;
        let [r, g, b] = colors[((x / FIELD + y / FIELD) % 2) as usize].map(|c| c + grain);
        r | g << 8 | b << 16 | 255 << 24
    }));
    builder.data.textures.push(Texture::new(first_texel, [side, side], [Wrap::Repeat; 2]));
}

/// Floor, ceiling and walls, facing inwards. The left wall is of clay.
fn shell(builder: &mut Builder) {
    let (x, y, z) = (DVec3::X * ROOM.x, DVec3::Y * ROOM.y, DVec3::Z * ROOM.z);
    // A metre holds two floor tiles.
    parallelogram(builder, [DVec3::ZERO, z, x], [ROOM.z as f32, ROOM.x as f32], FLOOR);
    parallelogram(builder, [y, x, z], [0.0; 2], WALL);
    parallelogram(builder, [DVec3::ZERO, x, y], [0.0; 2], WALL);
    parallelogram(builder, [z, y, x], [0.0; 2], WALL);
    parallelogram(builder, [DVec3::ZERO, y, z], [0.0; 2], CLAY);
    parallelogram(builder, [x, z, y], [0.0; 2], WALL);
}

fn lamps(builder: &mut Builder) {
    // The trough, its lip, and the light in it.
    cuboid(builder, [0.0, 2.19, 0.0], [ROOM.x, 2.22, 0.3], WALL);
    cuboid(builder, [0.0, 2.22, 0.28], [ROOM.x, 2.32, 0.3], WALL);
    parallelogram(builder, [DVec3::new(0.2, 2.23, 0.08), DVec3::Z * 0.1, DVec3::X * 5.6], [0.0; 2], COVE_LIGHT);
    // The floor lamp: foot, pole, bowl, and the light in it.
    let foot = DVec3::new(0.45, 0.0, 0.75);
    cuboid(builder, [foot.x - 0.16, 0.0, foot.z - 0.16], [foot.x + 0.16, 0.03, foot.z + 0.16], DARK);
    lathe(builder, foot, [12, 1], DARK, |v| [0.015, 0.03 + 1.67 * v]);
    lathe(builder, foot, [32, 8], CLOTH, |v| [0.02 + 0.2 * v.powf(0.6), 1.7 + 0.16 * v]);
    parallelogram(
        builder,
        [foot + DVec3::new(-0.07, 1.8, -0.07), DVec3::Z * 0.14, DVec3::X * 0.14],
        [0.0; 2],
        BOWL_LIGHT,
    );
}
