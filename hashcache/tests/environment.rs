//! The environment as settings turn it.

use std::fs;
use std::path::Path;

use hashcache::image_file::{self, Image};
use hashcache::{Preview, Settings};

/// Mean radiance of a picture towards −x, where the environment shines from −z alone before it is turned.
fn towards_minus_x(folder: &Path, degrees: &str) -> f32 {
    let mut settings = Settings::default();
    let (sky, camera) = (folder.join("sky.exr"), folder.join("camera.json"));
    for (key, value) in [
        ("size", "8x8"),
        ("max_bounces", "0"),
        ("cache", "none"),
        ("filter", "none"),
        ("env", sky.to_str().unwrap()),
        ("camera", camera.to_str().unwrap()),
        ("env.rotation", degrees),
    ] {
        settings.set(key, value).unwrap();
    }
    let preview = Preview::open("builtin:cornell", &settings).unwrap();
    let image = preview.render(&mut |_| ()).unwrap().image;
    image.pixels.iter().map(|p| p[0]).sum::<f32>() / image.pixels.len() as f32
}

#[test]
fn the_environment_turns_counter_clockwise_seen_from_above() {
    let folder = tempfile::tempdir().unwrap();
    // Columns 12 to 19 of 32 around the middle, which is −z.
    let pixels = (0..32 * 16).map(|i| if (12..20).contains(&(i % 32)) { [1.0; 3] } else { [0.0; 3] }).collect();
    image_file::write(&folder.path().join("sky.exr"), &Image { width: 32, height: 16, pixels }).unwrap();
    // Far behind the box, with nothing but sky in view.
    let camera = r#"{"position":[0,0,90],"target":[-1,0,90],"up":[0,1,0],"fov_y_deg":20}"#;
    fs::write(folder.path().join("camera.json"), camera).unwrap();
    let seen = |degrees| towards_minus_x(folder.path(), degrees);
    assert!((seen("90") - 1.0).abs() < 1e-3);
    assert!((seen("-270") - 1.0).abs() < 1e-3);
    assert!(["0", "-90", "180", "360"].iter().all(|&degrees| seen(degrees) <= 0.0));
}

#[test]
fn what_cannot_be_turned_is_refused() {
    let mut settings = Settings::default();
    settings.set("env.rotation", "1").unwrap();
    let error = Preview::open("builtin:cornell", &settings).unwrap_err().to_string();
    assert!(error.contains("env.rotation") && error.contains("--env"), "{error}");
    for value in ["NaN", "inf", "3601", "-1e9", "", "90deg"] {
        assert!(settings.set("env.rotation", value).is_err(), "{value}");
    }
}

#[test]
fn a_preview_follows_when_the_setting_changes() {
    let mut settings = Settings::default();
    let preview = Preview::open("builtin:cornell", &settings).unwrap();
    settings.set("env.rotation", "1").unwrap();
    assert!(preview.with_settings(&settings).is_err(), "there is nothing to turn");
}
