//! The built-in scenes are what they say.
#![expect(clippy::float_cmp, reason = "values that are copied or exact come out exactly")]

use pt_integrator::scene::NONE;
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
        assert_eq!(loaded.data.triangle_shading[i].emitter, i as u32);
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
        assert_ne!(loaded.data.triangle_shading[i].emitter, NONE);
    }
    let material = loaded.data.materials[0];
    assert_eq!((material.base_color[..3].to_vec(), material.emission[..3].to_vec()), (vec![0.5; 3], vec![1.0; 3]));
    let view = loaded.view(None).unwrap();
    assert!(view.position.abs().max_element() < 1.0);
}
