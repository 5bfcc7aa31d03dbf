//! Laws of the ray caster, on hostile geometry, beside an intersector that tries every triangle in f64.

mod rays_model;

use backend_api::Error;
use backend_cpu::rays::CpuScene;
use glam::Vec3;
use hashcache_core::float::powf;
use hashcache_core::geometry::{Geometry, Instance, Mesh, Ray};
use hashcache_core::traits::RayCaster;
use proptest::prelude::*;

use rays_model::{Numbers, Soup, compare, interval_is_open, rays, soup};

#[test]
fn hits_are_those_of_the_model_at_every_scale() {
    for (seed, scale) in [(1, 1e-4), (2, 1.0), (3, 1e7)] {
        for (count, size) in [(1, 1.0), (7, 0.7), (60, 0.5), (400, 0.2), (3000, 0.05)] {
            let soup = soup(seed * 1_000_000, count, scale, size);
            let rays = rays(seed * 77_777, scale, 300);
            let clear = compare(&soup, &soup.scene(), &rays);
            assert!(clear > 150, "{count} triangles, scale {scale}: {clear} clear rays");
        }
    }
}

#[test]
fn placed_meshes_are_met_where_they_stand() {
    let mut soup = soup(5, 300, 1.0, 0.1);
    soup.instances.clear();
    let mut numbers = Numbers(99);
    // 300 triangles × 250 places are more than are copied: rays are brought into the mesh's space.
    for i in 0..250 {
        let mut rows = [[0.0; 4]; 3];
        for (axis, row) in rows.iter_mut().enumerate() {
            // Sheared, scaled unevenly, every other one mirrored.
            *row = [numbers.next() * 0.3, numbers.next() * 0.3, numbers.next() * 0.3, numbers.next() * 20.0];
            row[axis] += 1.0 + numbers.next() * 0.6;
        }
        if i % 2 == 0 {
            rows[0] = rows[0].map(|x| -x);
        }
        soup.instances.push(Instance { to_scene: rows, mesh: 0, mirrored: u32::from(i % 2 == 0), reserved: [0; 2] });
    }
    let scene = soup.scene();
    assert_eq!(scene.stats().references, 250);
    assert_eq!(scene.stats().triangles, 300);
    let clear = compare(&soup, &scene, &rays(7, 20.0, 300));
    assert!(clear > 150, "{clear}");
}

#[test]
fn copies_that_cannot_be_turned_round_are_met_too() {
    // Flat: the map loses an axis, so there is no way back; the mesh is a plane picture of itself.
    let mut soup = soup(6, 300, 1.0, 0.1);
    soup.instances = (0..250)
        .map(|i| Instance {
            to_scene: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, i as f32]],
            mesh: 0,
            mirrored: 0,
            reserved: [0; 2],
        })
        .collect();
    let scene = soup.scene();
    assert_eq!(scene.stats().references, 0);
    let clear = compare(&soup, &scene, &rays(8, 1.0, 60));
    assert!(clear > 10, "{clear}");
}

/// The surface of a cube of `n`³ cells from 0 to `n`.
fn cube(n: u32) -> Soup {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0.0, n as f32] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i as f32, j as f32))) {
                let point = |u: f32, v: f32| {
                    let mut p = [u; 3];
                    p[axis] = side;
                    p[(axis + 2) % 3] = v;
                    Vec3::from(p)
                };
                triangles.push([point(i, j), point(i + 1.0, j), point(i + 1.0, j + 1.0)]);
                triangles.push([point(i, j), point(i + 1.0, j + 1.0), point(i, j + 1.0)]);
            }
        }
    }
    Soup::new(&triangles)
}

/// Every point whose coordinates are among `values`.
fn triples(values: &[f32]) -> Vec<Vec3> {
    let mut points = Vec::new();
    for &x in values {
        for &y in values {
            points.extend(values.iter().map(|&z| Vec3::new(x, y, z)));
        }
    }
    points
}

#[test]
fn rays_along_axes_and_through_corners_do_not_pass() {
    let n = 6;
    let scene = cube(n).scene();
    let places: Vec<f32> = (1..2 * n).map(|i| i as f32 * 0.5).collect();
    let steps = [-2.0, -1.0, -0.0, 0.0, 0.5, 1.0];
    let mut count = 0;
    for origin in triples(&places) {
        for direction in triples(&steps) {
            let ray = Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY };
            if direction != Vec3::ZERO {
                let hit = scene.closest(&ray).unwrap_or_else(|| panic!("{ray:?} leaves the cube"));
                let end = origin + direction * hit.t;
                let reach = (end - 3.0).abs().max_element();
                assert!((reach - 3.0).abs() < 1e-5, "{ray:?} {hit:?} ends inside, at {end}");
                count += 1;
            }
        }
    }
    assert!(count > 200_000, "{count}");
}

#[test]
fn a_ray_in_the_plane_of_a_wall_meets_what_stands_on_it() {
    // The upright triangle touches the plane x = 1 with its edge; the ray runs within that plane.
    let wall = [Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 0.0, 9.0)];
    let upright = [Vec3::new(0.0, -1.0, 5.0), Vec3::new(1.0, -1.0, 5.0), Vec3::new(1.0, 1.0, 5.0)];
    let scene = Soup::new(&[wall, upright]).scene();
    let ray = Ray { origin: Vec3::X, t_min: 0.0, direction: Vec3::Z, t_max: f32::INFINITY };
    let hit = scene.closest(&ray).unwrap();
    assert_eq!((hit.triangle, hit.t), (1, 5.0));
}

#[test]
fn of_equal_triangles_the_first_is_met() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let scene = Soup::new(&[triangle; 200]).scene();
    let mut numbers = Numbers(3);
    for _ in 0..200 {
        let (u, v) = (0.25 + 0.2 * numbers.next(), 0.25 + 0.2 * numbers.next());
        let ray = Ray { origin: Vec3::new(u, v, 1.0), t_min: 0.0, direction: Vec3::NEG_Z, t_max: 2.0 };
        assert_eq!(scene.closest(&ray).unwrap().triangle, 0);
    }
}

#[test]
fn sizes_of_every_magnitude_fit_one_scene() {
    // Nested triangles from 1e-12 to 1e12: the binary hierarchy is a chain.
    let triangles: Vec<[Vec3; 3]> = (0..400)
        .map(|i| {
            let size = powf(10.0, i as f32 * 0.06 - 12.0);
            [Vec3::new(-size, -size, size), Vec3::new(size, -size, size), Vec3::new(0.0, size, size)]
        })
        .collect();
    let soup = Soup::new(&triangles);
    let scene = soup.scene();
    for (i, triangle) in (0..).zip(&triangles) {
        let (z, direction) = (triangle[0].z, Vec3::new(0.0, 0.01, 1.0));
        let ray = Ray { origin: Vec3::ZERO, t_min: z * 0.99, direction, t_max: f32::INFINITY };
        let hit = scene.closest(&ray).unwrap();
        assert_eq!(hit.triangle, i, "{hit:?}");
        assert!((hit.t - z).abs() <= 1e-5 * z);
    }
}

#[test]
fn what_is_not_a_number_meets_nothing_and_stops_nothing() {
    let wall = [Vec3::new(-9.0, -9.0, 1.0), Vec3::new(9.0, -9.0, 1.0), Vec3::new(0.0, 9.0, 1.0)];
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX];
    let mut triangles = vec![wall];
    for (corner, x) in (0..3).flat_map(|corner| bad.map(|x| (corner, x))) {
        let mut triangle = wall.map(|p| p * 0.5);
        triangle[corner][corner] = x;
        triangles.push(triangle);
    }
    triangles.push([Vec3::ONE; 3]);
    let scene = Soup::new(&triangles).scene();
    assert_eq!(scene.stats().skipped, 13);
    let good = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Z, t_max: f32::INFINITY };
    assert_eq!(scene.closest(&good).unwrap().triangle, 0);
    let mut rays = vec![
        Ray { direction: Vec3::ZERO, ..good },
        Ray { t_min: 2.0, t_max: 1.5, ..good },
        Ray { t_min: 1.0, t_max: 1.0, ..good },
        Ray { t_min: f32::NAN, ..good },
        Ray { t_max: f32::NAN, ..good },
    ];
    for (axis, &x) in (0..3).flat_map(|axis| bad[..3].iter().map(move |x| (axis, x))) {
        let mut ray = good;
        ray.origin[axis] = x;
        rays.push(ray);
        ray = good;
        ray.direction[axis] = x;
        rays.push(ray);
    }
    for ray in rays {
        assert_eq!(scene.closest(&ray), None, "{ray:?}");
        assert!(!scene.occluded(&ray), "{ray:?}");
    }
}

#[test]
fn nothing_to_meet_is_no_error() {
    let empty = Geometry::default();
    let hollow = Geometry {
        meshes: &[Mesh { first_triangle: 0, triangle_count: 0 }],
        instances: &[Instance::identity(0); 3],
        ..empty
    };
    let ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Z, t_max: f32::INFINITY };
    for geometry in [empty, hollow] {
        let scene = CpuScene::build(&geometry).unwrap();
        assert_eq!(scene.closest(&ray), None);
        assert!(!scene.occluded(&ray));
    }
}

#[test]
fn what_names_nothing_is_refused() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let whole = [Mesh { first_triangle: 0, triangle_count: 1 }];
    let good = Geometry {
        positions: &positions,
        indices: &[[0, 1, 2]],
        meshes: &whole,
        instances: &[Instance::identity(0)],
        ..Geometry::default()
    };
    assert!(CpuScene::build(&good).is_ok());
    let long = [Mesh { first_triangle: u32::MAX, triangle_count: u32::MAX }];
    for bad in [
        Geometry { indices: &[[0, 1, 3]], ..good },
        Geometry { instances: &[Instance::identity(1)], ..good },
        Geometry { meshes: &long, instances: &[], ..good },
    ] {
        assert!(matches!(CpuScene::build(&bad), Err(Error::BadRange { at: "geometry", .. })));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_interval_is_open(seed in any::<u32>(), count in 1usize..40, exponent in -4i32..8) {
        let scale = 10f32.powi(exponent);
        interval_is_open(&soup(seed, count, scale, 0.8).scene(), &rays(seed ^ 1, scale, 20));
    }

    #[test]
    fn a_longer_direction_gives_shorter_distances(seed in any::<u32>(), exponent in -100i32..100) {
        let factor = 2f32.powi(exponent);
        let scene = soup(seed, 30, 1.0, 0.8).scene();
        for mut ray in rays(seed ^ 2, 1.0, 20) {
            ray.direction = ray.direction.normalize();
            let long = Ray { direction: ray.direction * factor, ..ray };
            let (hit, other) = (scene.closest(&ray), scene.closest(&long));
            prop_assert_eq!(hit.map(|h| (h.triangle, h.u, h.v)), other.map(|h| (h.triangle, h.u, h.v)));
            if let (Some(hit), Some(other)) = (hit, other) {
                prop_assert_eq!(other.t.to_bits(), (hit.t / factor).to_bits());
            }
        }
    }

    #[test]
    fn any_ray_gets_an_answer(values in prop::array::uniform8(any::<f32>()), seed in any::<u32>()) {
        let scene = soup(seed, 20, 1.0, 0.8).scene();
        let [x, y, z, t_min, a, b, c, t_max] = values;
        let ray = Ray { origin: Vec3::new(x, y, z), t_min, direction: Vec3::new(a, b, c), t_max };
        let hit = scene.closest(&ray);
        prop_assert_eq!(scene.occluded(&ray), hit.is_some());
        if let Some(hit) = hit {
            prop_assert!(hit.t > t_min && hit.t < t_max && hit.u.is_finite() && hit.v.is_finite());
        }
    }
}
