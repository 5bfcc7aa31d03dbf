//! The built-in scenes are what they say.
#![expect(clippy::float_cmp, reason = "values that are copied or exact come out exactly")]

use pt_integrator::scene::{Environment, Lobes, Material};
use scene::glam::{DVec3, Vec3};
use scene::{LoadOptions, Loaded};

fn load(name: &str) -> Loaded {
    scene::load(name, &LoadOptions::default()).unwrap()
}

/// Centre and front of a triangle.
fn side(loaded: &Loaded, triangle: usize) -> (Vec3, Vec3) {
    let [a, b, c] = loaded.data.indices[triangle].map(|i| Vec3::from(loaded.data.positions[i as usize]));
    ((a + b + c) / 3.0, (b - a).cross(c - a).normalize())
}

#[test]
fn all_are_listed_and_load() {
    for builtin in scene::builtins() {
        let loaded = load(&format!("builtin:{}", builtin.name));
        assert!(builtin.description.lines().count() == 1 && !builtin.description.is_empty());
        assert!(loaded.size.is_some() && loaded.warnings.is_empty() && loaded.view(None).is_ok());
        assert_eq!(loaded.data.validate(), Ok(()));
        assert_eq!(loaded.info.degenerate, 0);
    }
}

#[test]
fn cornell_is_the_published_box() {
    let loaded = load("builtin:cornell");
    assert_eq!((loaded.info.triangles, loaded.info.emissive_triangles, loaded.size), (36, 2, Some([512, 512])));
    let room = 12;
    for i in 0..room {
        let (centre, front) = side(&loaded, i);
        // The light faces down, the walls face inwards.
        assert!(front.dot(-centre) > 0.5, "triangle {i}: {centre} {front}");
    }
    for i in 0..2 {
        let (centre, front) = side(&loaded, i);
        assert!(loaded.data.emits(i));
        assert!((centre.y - 0.99).abs() < 1e-6 && front.abs_diff_eq(Vec3::NEG_Y, 1e-6));
    }
    // Both blocks are closed and face outwards: the volume by the divergence theorem.
    let volume = |range: std::ops::Range<usize>| {
        let six: f32 = range
            .map(|i| {
                let [a, b, c] = loaded.data.indices[i].map(|v| Vec3::from(loaded.data.positions[v as usize]));
                a.dot(b.cross(c))
            })
            .sum();
        six / 6.0
    };
    assert!((volume(12..24) - 0.6_f32.powi(3)).abs() < 1e-5);
    assert!((volume(24..36) - 0.6 * 1.22 * 0.6).abs() < 1e-5);
    let lows = [12..24, 24..36].map(|r| r.map(|i| side(&loaded, i).0.y).fold(f32::INFINITY, f32::min));
    assert!((lows[0] + 1.0).abs() < 1e-6 && (lows[1] + 1.01).abs() < 1e-6, "{lows:?}");
    let colour = |x: f32| {
        let i = (0..room).find(|&i| (side(&loaded, i).0.x - x).abs() < 1e-6).unwrap();
        loaded.data.materials[loaded.data.triangle_shading[i].material as usize].base_color[0]
    };
    assert_eq!([colour(-1.0), colour(1.0)], [0.570_068, 0.105_421], "red is on the left");
    let view = loaded.view(None).unwrap();
    assert_eq!((view.position, view.forward, view.right), (DVec3::new(0.0, 0.0, 3.9), DVec3::NEG_Z, DVec3::X));
    assert!((view.fov_y.to_degrees() - 39.3077).abs() < 1e-9);
}

#[test]
fn the_furnace_is_closed_and_glows_inwards() {
    let loaded = load("builtin:furnace");
    assert_eq!((loaded.info.triangles, loaded.info.emissive_triangles), (12, 12));
    for i in 0..12 {
        let (centre, front) = side(&loaded, i);
        assert!(front.dot(-centre) > 0.9, "{centre} {front}");
        assert!(loaded.data.emits(i));
    }
    let material = loaded.data.materials[0];
    assert_eq!((material.base_color[..3].to_vec(), material.emission[..3].to_vec()), (vec![0.5; 3], vec![1.0; 3]));
    let view = loaded.view(None).unwrap();
    assert!(view.position.abs().max_element() < 1.0);
}

/// Area and centre of what emits, and the direction it shines to (up, down, …).
fn lamps(loaded: &Loaded) -> Vec<(f32, Vec3, Vec3)> {
    let emits = |i: &usize| loaded.data.emits(*i);
    let lamp = |i: usize| {
        let [a, b, c] = loaded.data.indices[i].map(|v| Vec3::from(loaded.data.positions[v as usize]));
        ((b - a).cross(c - a).length() * 0.5, (a + b + c) / 3.0, side(loaded, i).1)
    };
    (0..loaded.data.indices.len()).filter(emits).map(lamp).collect()
}

#[test]
fn a_number_is_taken_where_it_means_something() {
    for name in ["thin-wall", "thin-wall:0.02", "thin-wall:2e-2"] {
        let loaded = load(&format!("builtin:{name}"));
        assert_eq!(loaded.name, format!("builtin:{name}"));
        assert_eq!(loaded.data, load("builtin:thin-wall").data, "{name}");
    }
    for name in [
        "thin-wall:",
        "thin-wall:x\n",
        "thin-wall:NaN",
        "thin-wall:inf",
        "thin-wall:0",
        "thin-wall:1.1",
        "thin-wall:-1",
    ] {
        let error = scene::load(&format!("builtin:{name}"), &LoadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("metres from 1e-6 to 1") && error.lines().count() == 1, "{error}");
    }
    for name in ["cornell:1", "interior:", ":0.02", "thin-wal:0.02"] {
        let error = scene::load(&format!("builtin:{name}"), &LoadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("no such built-in scene") && error.contains("builtin:thin-wall"), "{error}");
    }
    for builtin in scene::builtins() {
        assert_eq!(builtin.parameter.is_some(), builtin.name == "thin-wall");
    }
}

#[test]
fn the_thin_wall_has_its_thickness_and_parts_the_rooms() {
    for (name, thickness) in [("thin-wall", 0.02), ("thin-wall:1e-6", 1e-6), ("thin-wall:1", 1.0)] {
        let loaded = load(&format!("builtin:{name}"));
        assert_eq!((loaded.info.triangles, loaded.info.emissive_triangles), (10 + 12 + 2, 2));
        assert_eq!(loaded.info.extent, [[-2.0, 0.0, -2.0], [2.0, 2.0, 0.0]]);
        // The wall's twelve triangles follow on the five sides of the box.
        let wall = loaded.data.indices[10..22].iter().flatten().map(|&i| Vec3::from(loaded.data.positions[i as usize]));
        let (low, high) = wall.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        assert!((high - low - Vec3::new(thickness, 2.0, 2.0)).abs().max_element() < 1e-6 * thickness + 1e-9);
        assert_eq!((low.y, low.z, high.z), (0.0, -2.0, 0.0));
        for i in 0..10 {
            let (centre, front) = side(&loaded, i);
            assert!(front.dot(Vec3::new(0.0, 1.0, -1.0) - centre) > 0.1, "side {i} faces outwards");
        }
        for (_, centre, front) in lamps(&loaded) {
            assert!(centre.x < -0.5 && centre.z < 0.0 && front.abs_diff_eq(Vec3::NEG_Z, 1e-6));
        }
    }
}

#[test]
fn the_room_is_closed_and_its_lamps_shine_upwards() {
    let loaded = load("builtin:interior");
    assert!((3000..20_000).contains(&loaded.info.triangles), "{}", loaded.info.triangles);
    assert_eq!((loaded.info.textures, loaded.info.meshes), (2, 1));
    let [low, high] = loaded.info.extent;
    assert_eq!((low, high[0]), ([0.0; 3], 6.0));
    let lamps = lamps(&loaded);
    assert_eq!(lamps.len(), 4);
    for (area, centre, front) in lamps {
        assert!(area < 0.3 && centre.y > 1.7 && front.abs_diff_eq(Vec3::Y, 1e-6));
        // From the camera the front does not show: what emits lies above the eye.
        assert!(f64::from(centre.y) > loaded.view(None).unwrap().position.y);
    }
    // The six sides face inwards and close the room: by the divergence theorem they hold its volume.
    let six: f32 = (0..12)
        .map(|i| {
            let [a, b, c] = loaded.data.indices[i].map(|v| Vec3::from(loaded.data.positions[v as usize]));
            -a.dot(b.cross(c))
        })
        .sum();
    assert!((six / 6.0 - 6.0 * 2.8 * 4.5).abs() < 1e-3);
    let inside = |p: &[f32; 3]| Vec3::from(*p).clamp(Vec3::ZERO, Vec3::new(6.0, 2.8, 4.5)) == Vec3::from(*p);
    assert!(loaded.data.positions.iter().all(inside));
}

/// Six times the volume that the triangles of a material enclose, positive when they face outwards, and whether each edge
/// is met once in each direction.
fn enclosed(loaded: &Loaded, material: u32) -> (f32, bool) {
    let data = &loaded.data;
    let point = |i: u32| Vec3::from(data.positions[i as usize]);
    let mut edges = std::collections::HashMap::new();
    let mut six = 0.0;
    for (triangle, _) in data.indices.iter().zip(&data.triangle_shading).filter(|(_, s)| s.material == material) {
        let [a, b, c] = triangle.map(point);
        six += a.dot(b.cross(c));
        for (from, to) in [(a, b), (b, c), (c, a)].map(|(a, b)| (a.to_array(), b.to_array())) {
            let bits = |p: [f32; 3]| p.map(|x| (x + 0.0).to_bits());
            *edges.entry((bits(from), bits(to))).or_insert(0) += 1;
            *edges.entry((bits(to), bits(from))).or_insert(0) -= 1;
        }
    }
    (six, edges.values().all(|&n| n == 0))
}

#[test]
fn glass_is_closed_and_faces_outwards() {
    use std::f32::consts::PI;
    let caustic = load("builtin:caustic-glass");
    let interior = load("builtin:interior");
    let ring = 2.0 * PI * PI * 0.42 * 0.17 * 0.17;
    for (loaded, volumes) in
        [(&caustic, vec![4.0 / 3.0 * PI * 0.6_f32.powi(3), ring]), (&interior, vec![4.0 / 3.0 * PI * 0.12_f32.powi(3)])]
    {
        let solids: Vec<u32> = (0..loaded.data.materials.len() as u32)
            .filter(|&i| loaded.data.materials[i as usize].flags & Material::VOLUME != 0)
            .collect();
        assert_eq!(solids.len(), volumes.len());
        for (material, volume) in solids.into_iter().zip(volumes) {
            let (six, closed) = enclosed(loaded, material);
            assert!(closed, "{}: material {material} has open edges", loaded.name);
            // Flat triangles cut a little off.
            let ratio = six / 6.0 / volume;
            assert!((0.97..1.0).contains(&ratio), "{}: material {material}: {ratio}", loaded.name);
        }
    }
    let light = lamps(&caustic);
    assert_eq!(light.len(), 2);
    assert!(light.iter().all(|l| l.2.abs_diff_eq(Vec3::NEG_Y, 1e-6)));
}

#[test]
fn the_room_has_a_polished_floor_a_mirror_and_glass() {
    let loaded = load("builtin:interior");
    let area_of = |material: usize| -> f32 {
        let of_material = |i: &usize| loaded.data.triangle_shading[*i].material == material as u32;
        let area = |i: usize| {
            let [a, b, c] = loaded.data.indices[i].map(|v| Vec3::from(loaded.data.positions[v as usize]));
            (b - a).cross(c - a).length() * 0.5
        };
        (0..loaded.data.indices.len()).filter(of_material).map(area).sum()
    };
    let with = |lobes: Lobes| -> Vec<usize> {
        (0..loaded.data.materials.len()).filter(|&i| loaded.data.materials[i].lobes() == lobes).collect()
    };
    let (floor, mirror) = (with(Lobes::DIFFUSE | Lobes::REFLECTION), with(Lobes::REFLECTION));
    let glass = with(Lobes::REFLECTION | Lobes::TRANSMISSION);
    assert_eq!((floor.len(), mirror.len(), glass.len()), (1, 1, 2));
    assert!((area_of(floor[0]) - 27.0).abs() < 1e-3 && (area_of(mirror[0]) - 1.08).abs() < 1e-3);
    assert!((area_of(glass[0]) - 1.1 * 1.83).abs() < 1e-3);
    let roughness = |m: usize| loaded.data.materials[m].surface[1];
    assert!(roughness(floor[0]) > 0.0 && roughness(mirror[0]) == 0.0 && roughness(glass[1]) == 0.0);
}

#[test]
fn instances_are_many_and_stored_once() {
    let loaded = load("builtin:instances");
    assert!(loaded.info.triangles >= 1_000_000, "{}", loaded.info.triangles);
    assert!(loaded.info.stored_triangles < 20_000, "{}", loaded.info.stored_triangles);
    assert_eq!((loaded.info.meshes, loaded.info.instances), (4, 257));
    assert!(matches!(loaded.data.environment, Some(Environment::Constant(_))));
    assert_eq!(lamps(&loaded).len(), 2);
    let [low, high] = loaded.info.extent;
    assert!(low[1] == -0.5 && high[1] > 20.0 && high[0] < 25.0 && low[0] > -25.0, "{low:?} {high:?}");
    // Shrubs stand on the floor, upright, of all three kinds.
    for instance in &loaded.data.instances[1..] {
        assert_eq!(instance.point(Vec3::ZERO).y, 0.0);
        assert!(instance.point(Vec3::Y).y > 0.6);
    }
    for kind in 1..4 {
        assert!(loaded.data.instances.iter().filter(|i| i.mesh == kind).count() > 50);
    }
}

#[test]
fn smooth_normals_lean_to_their_faces() {
    for name in ["interior", "instances", "caustic-glass"] {
        let loaded = load(&format!("builtin:{name}"));
        let mut smooth = 0;
        for (i, shading) in loaded.data.triangle_shading.iter().enumerate().filter(|(_, s)| !s.is_flat()) {
            let front = side(&loaded, i).1;
            for normal in shading.normals.map(hashcache_core::pack::octahedral_decode) {
                assert!(normal.dot(front) > 0.3, "{name}: triangle {i}: {normal} {front}");
            }
            smooth += 1;
        }
        assert!(smooth > 1000, "{name}: {smooth}");
    }
}
