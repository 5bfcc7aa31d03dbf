//! What built-in scenes are put together from.

use glam::{DMat4, DVec3};
use pt_integrator::scene::TriangleShading;

use crate::builder::{Builder, pack_normal};

/// The square from −1 to 1 in z = 0 with its front towards +z, transformed.
pub(super) fn rectangle(builder: &mut Builder, to_scene: DMat4, material: u32) {
    let base = builder.data.positions.len() as u32;
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let p = to_scene.transform_point3(DVec3::new(x, y, 0.0));
        builder.data.positions.push(p.as_vec3().to_array());
    }
    for corners in [[0, 1, 2], [0, 2, 3]] {
        builder.triangle(corners.map(|v| base + v), TriangleShading::flat(material));
    }
}

/// The cube from −1 to 1, its six squares facing outwards, transformed. The corners keep their order, so a mirroring
/// transform turns the fronts inwards.
pub(super) fn cube(builder: &mut Builder, to_scene: DMat4, material: u32) {
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

/// The parallelogram `corner + u·a + v·b`, its front towards a × b. Texture coordinates run along a and b, from 0 to
/// `repeats`.
pub(super) fn parallelogram(builder: &mut Builder, [corner, a, b]: [DVec3; 3], repeats: [f32; 2], material: u32) {
    let base = builder.data.positions.len() as u32;
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
    for (u, v) in corners {
        let p = corner + a * f64::from(u) + b * f64::from(v);
        builder.data.positions.push(p.as_vec3().to_array());
    }
    for triangle in [[0_u32, 1, 2], [0, 2, 3]] {
        let uv = triangle.map(|i| {
            let (u, v) = corners[i as usize];
            [u as f32 * repeats[0], v as f32 * repeats[1]]
        });
        let shading = TriangleShading { uv, ..TriangleShading::flat(material) };
        builder.triangle(triangle.map(|i| base + i), shading);
    }
}

/// The box between two corners, its sides facing outwards.
pub(super) fn cuboid(builder: &mut Builder, low: [f64; 3], high: [f64; 3], material: u32) {
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let size = high - low;
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    for (a, b) in [(x, z), (z, y), (y, x)] {
        parallelogram(builder, [low, b, a], [0.0; 2], material);
        parallelogram(builder, [low + size, -a, -b], [0.0; 2], material);
    }
}

/// A smooth surface over u, v ∈ [0, 1] in `steps` × `steps` parts: `point(u, v)`, its front towards ∂u × ∂v. Triangles
/// whose corners coincide, as at poles, are left out; where the surface has no normal its triangles' own are used.
pub(super) fn surface(builder: &mut Builder, steps: [u32; 2], material: u32, point: impl Fn(f64, f64) -> DVec3) {
    // Of a normal's differences: far above rounding, far below a part.
    const STEP: f64 = 1e-5;
    let base = builder.data.positions.len() as u32;
    let mut normals = Vec::new();
    for j in 0..=steps[1] {
        for i in 0..=steps[0] {
            let (u, v) = (f64::from(i) / f64::from(steps[0]), f64::from(j) / f64::from(steps[1]));
            builder.data.positions.push(point(u, v).as_vec3().to_array());
            // At a pole ∂u vanishes; a little inside it does not.
            let inside = v.clamp(STEP * 10.0, 1.0 - STEP * 10.0);
            let du = point(u + STEP, inside) - point(u - STEP, inside);
            let dv = point(u, inside + STEP) - point(u, inside - STEP);
            normals.push(pack_normal(du.normalize_or_zero().cross(dv.normalize_or_zero()).as_vec3()));
        }
    }
    let width = steps[0] + 1;
    for cell in 0..steps[0] * steps[1] {
        let a = cell / steps[0] * width + cell % steps[0];
        for corners in [[a, a + 1, a + width + 1], [a, a + width + 1, a + width]] {
            let position = |i: u32| builder.data.positions[(base + i) as usize];
            let [p, q, r] = corners.map(position);
            #[expect(clippy::float_cmp, reason = "points that coincide are computed alike; near ones make a triangle")]
            if p == q || q == r || r == p {
                continue;
            }
            let mut shading = TriangleShading::flat(material);
            if let [Some(n), Some(m), Some(o)] = corners.map(|i| normals[i as usize]) {
                shading.normals = [n, m, o];
            }
            builder.triangle(corners.map(|i| base + i), shading);
        }
    }
}

/// What a profile sweeps around the vertical axis through `centre`: `profile(v)` is [radius, height], v ∈ [0, 1]. The
/// front is outside where the height grows.
pub(super) fn lathe(
    builder: &mut Builder,
    centre: DVec3,
    steps: [u32; 2],
    material: u32,
    profile: impl Fn(f64) -> [f64; 2],
) {
    surface(builder, steps, material, |u, v| {
        // The last column is the first again, to the bit.
        let (sin, cos) = (std::f64::consts::TAU * u.rem_euclid(1.0)).sin_cos();
        let [radius, height] = profile(v);
        centre + DVec3::new(radius * sin, height, radius * cos)
    });
}

/// A sphere.
pub(super) fn sphere(builder: &mut Builder, centre: DVec3, radius: f64, steps: [u32; 2], material: u32) {
    lathe(builder, centre, steps, material, |v| {
        let (sin, cos) = (std::f64::consts::PI * v).sin_cos();
        // The sine of π is not 0, and a pole is one point.
        [if sin < 1e-12 { 0.0 } else { radius * sin }, -radius * cos]
    });
}
