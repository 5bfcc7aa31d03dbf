//! Environment maps from files.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};
use pt_integrator::scene::EnvironmentImage;

use crate::LoadOptions;
use crate::error::{At, SceneError};
use crate::import::resource;
use crate::warning::{Warning, Warnings};

/// What infinite texels become, before scaling: the largest half float. Infinity in an environment is a sun that
/// overflowed a half float.
const LARGEST: f32 = 65504.0;

/// Bytes of decoder scratch allowed beside the image itself.
const DECODER_SCRATCH: u64 = 256 << 20;

/// Loads an equirectangular `OpenEXR` or Radiance HDR image as an environment; radiance = `scale` × texel, linear
/// Rec. 709.
///
/// Conventions are those of [`EnvironmentImage`]. Texels that are negative or NaN become 0, infinite ones 65504 before
/// scaling; each kind is counted in a warning.
///
/// # Errors
/// [`SceneError`]: unreadable, neither EXR nor HDR, broken, more texels than `options.max_texels`, a scale that is
/// negative or not finite, or a scaled radiance beyond f32.
pub fn load(path: &Path, scale: f32, options: &LoadOptions) -> Result<(EnvironmentImage, Vec<Warning>), SceneError> {
    if !(scale.is_finite() && scale >= 0.0) {
        let expected = "a finite number, at least 0";
        return Err(SceneError::OutOfRange { what: "environment scale", value: scale.to_string(), expected });
    }
    let name = path.to_string_lossy();
    let at = At { file: &name };
    let bytes = resource::read_file(path, options.max_bytes)?;
    let image = decode(at, &bytes, options)?;
    let (width, height) = (image.width(), image.height());
    let mut warnings = Warnings::default();
    let mut texels: Vec<[f32; 4]> = Vec::new();
    texels.reserve_exact(width as usize * height as usize);
    let mut clean = |value: f32, i: usize| {
        let place = || format!("texel {}, {}", i % width as usize, i / width as usize);
        if value.is_nan() || value < 0.0 {
            warnings.add("environment channels that are negative or NaN are read as 0", place);
            0.0
        } else if value.is_infinite() {
            warnings.add("environment channels that are infinite are read as 65504", place);
            LARGEST
        } else {
            value
        }
    };
    // Alpha means nothing here. Converting by `into_rgb32f` would clamp, so both layouts are read as they are.
    match image {
        DynamicImage::ImageRgb32F(image) => {
            let rgb = image.as_raw().chunks_exact(3).enumerate();
            texels.extend(
                rgb.map(|(i, c)| [clean(c[0], i) * scale, clean(c[1], i) * scale, clean(c[2], i) * scale, 0.0]),
            );
        }
        DynamicImage::ImageRgba32F(image) => {
            let rgb = image.as_raw().chunks_exact(4).enumerate();
            texels.extend(
                rgb.map(|(i, c)| [clean(c[0], i) * scale, clean(c[1], i) * scale, clean(c[2], i) * scale, 0.0]),
            );
        }
        _ => return Err(at.unsupported("the image", "its channels are no floats", "convert it to EXR or HDR")),
    }
    if !texels.as_flattened().iter().all(|x| x.is_finite()) {
        let expected = "a smaller scale: the scaled radiance overflows";
        return Err(SceneError::OutOfRange { what: "environment scale", value: scale.to_string(), expected });
    }
    Ok((EnvironmentImage { width, height, texels }, warnings.into_vec()))
}

fn decode(at: At, bytes: &[u8], options: &LoadOptions) -> Result<DynamicImage, SceneError> {
    let format = image::guess_format(bytes).ok().filter(|f| matches!(f, ImageFormat::OpenExr | ImageFormat::Hdr));
    let format = format
        .ok_or_else(|| at.unsupported("the first bytes", "neither OpenEXR nor Radiance HDR", "convert the image"))?;
    let broken = |e: image::ImageError| at.malformed("the image", e.to_string());
    let mut decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if count == 0 {
        return Err(at.malformed("the image", "it has no pixels"));
    }
    if count > u64::from(options.max_texels) {
        return Err(at.too_large("the image", format!("{count} texels"), options.max_texels.into(), "max_texels"));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(count * 16 + DECODER_SCRATCH);
    decoder.set_limits(limits).map_err(broken)?;
    DynamicImage::from_decoder(decoder).map_err(broken)
}
