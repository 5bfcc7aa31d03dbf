//! What stands in the room.

use std::f64::consts::TAU;

use glam::DVec3;
use hashcache_core::hash::{pcg, to_unit_f32};

use super::{BALL, BOOK_COLORS, BOOKS, CLAY, CLOTH, CUSHION, DARK, MIRROR, PANE, RUG, WALL, WOOD};
use crate::builder::Builder;
use crate::builtin::shapes::{cuboid, lathe, parallelogram, sphere, surface};

/// All of it.
pub(super) fn build(builder: &mut Builder) {
    sofa(builder);
    table(builder);
    shelf(builder);
    picture(builder);
    looking_glass(builder);
    curtain(builder);
    screen(builder);
    // A rug of two centimetres.
    let (corner, long, deep) = (DVec3::new(1.4, 0.02, 1.5), DVec3::X * 2.4, DVec3::Z * 1.8);
    cuboid(builder, [1.4, 0.0, 1.5], [3.8, 0.019, 3.3], CLAY);
    parallelogram(builder, [corner, deep, long], [0.75, 1.0], RUG);
}

/// Along the clay wall.
fn sofa(builder: &mut Builder) {
    cuboid(builder, [0.1, 0.12, 1.4], [0.95, 0.42, 3.4], CLOTH);
    cuboid(builder, [0.1, 0.42, 1.4], [0.32, 0.85, 3.4], CLOTH);
    for z in [1.25, 3.4] {
        cuboid(builder, [0.1, 0.12, z], [0.95, 0.6, z + 0.15], CLOTH);
    }
    for (x, z) in [(0.14, 1.3), (0.85, 1.3), (0.14, 3.44), (0.85, 3.44)] {
        cuboid(builder, [x, 0.0, z], [x + 0.06, 0.12, z + 0.06], DARK);
    }
    for z in [1.42, 2.42] {
        cuboid(builder, [0.33, 0.421, z], [0.97, 0.54, z + 0.96], CLOTH);
    }
    // Cushions: spheres, flattened towards the back.
    for (z, tilt) in [(1.75, 0.1), (3.0, -0.08)] {
        surface(builder, [24, 16], CUSHION, |u, v| {
            let (around, up) = (TAU * u.rem_euclid(1.0), 0.5 * TAU * v);
            let ring = if up.sin() < 1e-12 { 0.0 } else { up.sin() };
            let (x, y, w) = (0.11 * ring * around.sin(), -0.24 * up.cos(), 0.24 * ring * around.cos());
            DVec3::new(0.45 + x - 0.3 * y, 0.78 + y, z + w + tilt * y)
        });
    }
}

/// In the middle, with a bowl, a ball and a vase on it.
fn table(builder: &mut Builder) {
    cuboid(builder, [1.9, 0.4, 1.9], [3.2, 0.44, 2.7], WOOD);
    for (x, z) in [(1.93, 1.93), (3.11, 1.93), (1.93, 2.61), (3.11, 2.61)] {
        cuboid(builder, [x, 0.02, z], [x + 0.06, 0.4, z + 0.06], WOOD);
    }
    // A hair above the top, so that the glass is closed.
    sphere(builder, DVec3::new(2.85, 0.561, 2.2), 0.12, [48, 24], BALL);
    let vase = |v: f64| [0.05 + 0.05 * (TAU * (0.6 * v + 0.05)).sin().powi(2), 0.36 * v];
    lathe(builder, DVec3::new(2.15, 0.441, 2.15), [32, 20], WALL, vase);
    lathe(builder, DVec3::new(2.45, 0.441, 2.5), [32, 8], CLAY, |v| [0.02 + 0.13 * v.sqrt(), 0.09 * v]);
}

/// Against the back wall, full of books.
fn shelf(builder: &mut Builder) {
    const LEFT: f64 = 1.3;
    const RIGHT: f64 = 3.5;
    const DEPTH: f64 = 0.32;
    const BOARD: f64 = 0.03;
    const ROWS: u32 = 4;
    let height = |row: u32| 0.1 + 0.45 * f64::from(row);
    for row in 0..=ROWS {
        cuboid(builder, [LEFT, height(row), 0.01], [RIGHT, height(row) + BOARD, DEPTH], WOOD);
    }
    for x in [LEFT - BOARD, RIGHT] {
        cuboid(builder, [x, 0.0, 0.01], [x + BOARD, height(ROWS) + BOARD, DEPTH], WOOD);
    }
    // A sliding pane before the right half.
    let (corner, along, up) = (DVec3::new(2.4, 0.1, DEPTH + 0.01), DVec3::X * 1.1, DVec3::Y * 1.83);
    parallelogram(builder, [corner, along, up], [0.0; 2], PANE);
    let mut book = 0_u32;
    for row in 0..ROWS {
        let mut x = LEFT + 0.02;
        while x < RIGHT - 0.1 {
            let draw = |k: u32| f64::from(to_unit_f32(pcg(book * 4 + k)));
            let (width, tall, deep) = (0.03 + 0.04 * draw(0), 0.22 + 0.14 * draw(1), 0.16 + 0.1 * draw(2));
            // Some places stay free.
            if draw(3) > 0.2 {
                let bottom = height(row) + BOARD + 0.001;
                let color = BOOKS + pcg(book) % BOOK_COLORS.len() as u32;
                cuboid(builder, [x, bottom, 0.02], [x + width, bottom + tall, 0.02 + deep], color);
            }
            x += width + 0.004;
            book += 1;
        }
    }
}

/// On the clay wall, in a frame.
fn picture(builder: &mut Builder) {
    cuboid(builder, [0.0, 1.25, 1.8], [0.03, 2.05, 3.0], DARK);
    let (corner, up, along) = (DVec3::new(0.031, 1.3, 1.85), DVec3::Y * 0.7, DVec3::Z * 1.1);
    parallelogram(builder, [corner, up, along], [0.35, 0.55], RUG);
}

/// On the clay wall too, nearer to the camera.
fn looking_glass(builder: &mut Builder) {
    cuboid(builder, [0.0, 0.8, 3.2], [0.03, 2.1, 4.2], DARK);
    let (corner, up, along) = (DVec3::new(0.031, 0.85, 3.25), DVec3::Y * 1.2, DVec3::Z * 0.9);
    parallelogram(builder, [corner, up, along], [0.0; 2], MIRROR);
}

/// In folds, at the back wall's right.
fn curtain(builder: &mut Builder) {
    surface(builder, [120, 4], CUSHION, |u, v| {
        let fold = (11.0 * TAU * u).sin();
        DVec3::new(4.0 + 1.8 * u, 0.05 + 2.1 * v, 0.16 + 0.06 * fold * (1.2 - 0.4 * v))
    });
}

/// A folding screen, two centimetres thick, and the dark corner behind it.
fn screen(builder: &mut Builder) {
    for i in 0..3_u32 {
        let (x, z) = (4.62 + 0.45 * f64::from(i), 0.8);
        cuboid(builder, [x, 0.0, z], [x + 0.44, 1.25, z + 0.02], if i == 1 { WOOD } else { CLAY });
    }
}
