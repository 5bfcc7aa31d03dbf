//! Environment maps.

use std::path::Path;

use scene::environment::load;
use scene::{LoadOptions, SceneError};

/// Writes an image of these texels.
fn write(path: &Path, width: u32, height: u32, texels: &[[f32; 3]]) {
    let image = image::Rgb32FImage::from_raw(width, height, texels.as_flattened().to_vec()).unwrap();
    image::DynamicImage::from(image).save(path).unwrap();
}

#[test]
fn exr_texels_come_through_scaled() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sky.exr");
    let texels = [[0.0, 0.5, 1.0], [1e-6, 4.0, 1e5], [2.0; 3], [3.0; 3]];
    write(&path, 2, 2, &texels);
    let (image, warnings) = load(&path, 2.0, &LoadOptions::default()).unwrap();
    assert_eq!((image.width, image.height), (2, 2));
    assert_eq!(warnings, []);
    for (found, expected) in image.texels.iter().zip(texels) {
        assert_eq!(found[..3], expected.map(|x| 2.0 * x));
    }
}

#[test]
fn hdr_texels_come_through() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sky.hdr");
    write(&path, 16, 8, &[[0.25, 0.5, 8.0]; 128]);
    let (image, _) = load(&path, 1.0, &LoadOptions::default()).unwrap();
    assert_eq!((image.width, image.height), (16, 8));
    // Radiance's shared exponent keeps 8 bits of the largest channel.
    for (found, expected) in image.texels[77].iter().zip([0.25, 0.5, 8.0]) {
        assert!((found - expected).abs() <= 8.0 / 128.0, "{found} {expected}");
    }
}

#[test]
fn texels_that_are_no_radiance_are_counted() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sky.exr");
    write(&path, 2, 1, &[[f32::NAN, -1.0, 1.0], [f32::INFINITY, f32::NEG_INFINITY, 0.0]]);
    let (image, warnings) = load(&path, 0.5, &LoadOptions::default()).unwrap();
    assert_eq!(image.texels, [[0.0, 0.0, 0.5, 0.0], [32752.0, 0.0, 0.0, 0.0]]);
    assert_eq!(warnings.iter().map(|w| w.count).collect::<Vec<_>>(), [3, 1]);
    assert!(warnings[0].to_string().contains("texel 0, 0"), "{}", warnings[0]);
}

#[test]
fn what_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sky.exr");
    write(&path, 2, 2, &[[1e30; 3]; 4]);
    let load = |path: &Path, scale: f32, max_texels: u32| {
        let mut options = LoadOptions::default();
        options.max_texels = max_texels;
        load(path, scale, &options).unwrap_err()
    };
    for scale in [-1.0, f32::NAN, f32::INFINITY, 1e30] {
        assert!(matches!(load(&path, scale, 100), SceneError::OutOfRange { .. }));
    }
    assert!(matches!(load(&path, 1.0, 3), SceneError::TooLarge { .. }));
    assert!(matches!(load(&dir.path().join("no.exr"), 1.0, 100), SceneError::Read { .. }));
    let whole = std::fs::read(&path).unwrap();
    let broken = dir.path().join("broken.exr");
    for length in [0, 3, 10, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&broken, &whole[..length]).unwrap();
        let error = load(&broken, 1.0, 100).to_string();
        assert!(error.contains("broken.exr") && error.lines().count() == 1, "{error}");
    }
    let png = dir.path().join("sky.png");
    image::RgbImage::new(2, 2).save(&png).unwrap();
    assert!(load(&png, 1.0, 100).to_string().contains("neither OpenEXR nor Radiance HDR"));
}
