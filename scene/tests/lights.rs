//! Lights without extent.
#![expect(clippy::float_cmp, reason = "values that are copied or exact come out exactly")]

mod common;

use common::{Gltf, warned};
use hashcache_core::float;
use pt_integrator::scene::PunctualLight;
use serde_json::{Value, json};

/// A triangle and a light in a node of this transform.
fn with_light(light: &Value, node: &Value) -> Gltf {
    let mut file = Gltf::triangle();
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    let mut node = node.clone();
    node["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    file.node(node);
    file
}

#[test]
fn points_spots_and_suns() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // Turned by 90° about y: −z becomes −x. Scale means nothing to a light.
    let node = json!({"translation": [1, 2, 3], "rotation": [0, half, 0, half], "scale": [2, 3, 4]});
    let load = |light: Value| {
        let loaded = with_light(&light, &node).load().unwrap();
        assert_eq!(
            (loaded.warnings.len(), loaded.info.punctual_lights.iter().sum::<usize>()),
            (0, 1),
            "{:?}",
            loaded.warnings
        );
        (loaded.data.punctual_lights[0], loaded.origin)
    };
    let (point, origin) = load(json!({"type": "point", "color": [1, 0.5, 0], "intensity": 8, "range": 3}));
    assert_eq!(point.position[3], PunctualLight::POINT);
    assert_eq!(origin.to_array().map(|x| x as f32), [0.0; 3]);
    assert_eq!(
        (point.position[..3].to_vec(), point.intensity[..3].to_vec()),
        (vec![1.0, 2.0, 3.0], vec![8.0, 4.0, 0.0])
    );
    assert_eq!(point.range[0], 3.0);
    let (spot, _) = load(json!({"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}));
    assert_eq!(spot.position[3], PunctualLight::SPOT);
    assert_eq!((spot.intensity[..3].to_vec(), spot.range[0]), (vec![1.0; 3], 0.0));
    assert!((spot.direction[0] + 1.0).abs() < 1e-6 && spot.direction[1..3].iter().all(|x| x.abs() < 1e-6));
    assert!((spot.direction[3] - float::cos(0.25)).abs() < 1e-6 && (spot.intensity[3] - float::cos(0.5)).abs() < 1e-6);
    let (sun, _) = load(json!({"type": "directional", "intensity": 1000, "range": 5}));
    assert_eq!((sun.position[3], sun.intensity[0], sun.range[0]), (PunctualLight::DIRECTIONAL, 1000.0, 0.0));
    assert!((sun.direction[0] + 1.0).abs() < 1e-6);
}

#[test]
fn a_light_far_away_is_placed_relative_to_the_origin() {
    let mut file = with_light(&json!({"type": "point"}), &json!({"translation": [5_000_000.0, 1.0, 0.0]}));
    file.json["nodes"][0]["translation"] = json!([5_000_000.0, 0.0, 0.0]);
    let loaded = file.load().unwrap();
    let light = loaded.data.punctual_lights[0];
    let place = loaded.origin.x + f64::from(light.position[0]);
    assert!(place == 5e6 && light.position[0].abs() < 16.0, "{place} {light:?}");
}

#[test]
fn dark_lights_and_odd_cones() {
    let loaded = with_light(&json!({"type": "point", "intensity": 0}), &json!({})).load().unwrap();
    assert_eq!((loaded.data.punctual_lights.len(), loaded.warnings.len()), (0, 0));
    for spot in [
        json!({"innerConeAngle": 1, "outerConeAngle": 0.5}),
        json!({"innerConeAngle": -1, "outerConeAngle": 2}),
        json!({"outerConeAngle": -1}),
    ] {
        let loaded = with_light(&json!({"type": "spot", "spot": spot}), &json!({})).load().unwrap();
        assert!(warned(&loaded, "cone angles").is_some());
        let light = loaded.data.punctual_lights[0];
        let (inner, outer) = (light.direction[3], light.intensity[3]);
        assert!(inner >= outer && outer >= -1e-6 && inner <= 1.0, "{inner} {outer}");
    }
}

#[test]
fn lights_that_are_refused() {
    for (light, place) in [
        (json!({"type": "point", "intensity": -1}), "/extensions/KHR_lights_punctual/lights/0/intensity"),
        (json!({"type": "point", "color": [1e300, 0, 0]}), "/extensions/KHR_lights_punctual/lights/0/intensity"),
        (json!({"type": "point", "range": 0}), "/extensions/KHR_lights_punctual/lights/0/range"),
        (json!({"type": "spot"}), "/extensions/KHR_lights_punctual/lights/0/spot"),
        (json!({"type": "spot", "spot": {"outerConeAngle": 1e300}}), "/extensions/KHR_lights_punctual/lights/0/spot"),
        (json!({"type": "area"}), "/extensions/KHR_lights_punctual/lights/0/type"),
    ] {
        let error = with_light(&light, &json!({})).load().unwrap_err().to_string();
        assert!(error.contains(&format!("{place}:")) && error.lines().count() == 1, "{light}: {error}");
    }
    let flat = json!({"scale": [1, 1, 0]});
    let error = with_light(&json!({"type": "directional"}), &flat).load().unwrap_err().to_string();
    assert!(error.contains("does not span space"), "{error}");
    let mut file = with_light(&json!({"type": "point"}), &json!({}));
    file.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = json!(7);
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("/nodes/1/extensions") && error.contains("does not exist"), "{error}");
}
