//! Pictures in files: EXR and HDR hold linear radiance, PNG is sRGB-encoded.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use image::codecs::hdr::HdrEncoder;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageReader, Rgb};

use crate::tone::{ToneMapping, srgb_decode};

/// A picture of linear radiance (Rec. 709 primaries), rows from top to bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

/// The kinds of files that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `OpenEXR`, 32-bit floats.
    Exr,
    /// Radiance HDR, shared exponent.
    Hdr,
    /// PNG, 8 bits, sRGB-encoded; see [`ToneMapping`].
    Png,
}

/// What can go wrong with an image file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The ending of the name is not one of those known.
    #[error("{}: the ending names no image format; use .exr, .hdr or .png", .0.display())]
    UnknownFormat(PathBuf),
    /// The file cannot be written.
    #[error("{}: cannot be written ({reason}); name a file in a folder that exists and is writable", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's or encoder's words.
        reason: String,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read as an image ({reason})", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's or decoder's words.
        reason: String,
    },
}

/// The format that a file name's ending stands for.
///
/// # Errors
/// [`ImageError::UnknownFormat`].
pub fn format_of(path: &Path) -> Result<Format, ImageError> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "exr" => Ok(Format::Exr),
        "hdr" => Ok(Format::Hdr),
        "png" => Ok(Format::Png),
        _ => Err(ImageError::UnknownFormat(path.to_owned())),
    }
}

/// Writes a picture in the format of the file's ending, whole or not at all: the bytes go to a temporary file beside
/// it, which then takes its name.
///
/// # Errors
/// [`ImageError::UnknownFormat`], [`ImageError::Write`].
pub fn write(path: &Path, image: &Image) -> Result<(), ImageError> {
    write_toned(path, image, ToneMapping::default())
}

/// The same with exposure and curve of the caller's for a PNG. EXR and HDR hold radiance as it is.
///
/// # Errors
/// As [`write()`].
pub fn write_toned(path: &Path, image: &Image, tone: ToneMapping) -> Result<(), ImageError> {
    let format = format_of(path)?;
    write_whole(path, |out| {
        let mut encoded = |bytes: &[u8], color| -> image::ImageResult<()> {
            match format {
                Format::Exr => {
                    // The encoder seeks, so it needs the bytes in memory first.
                    let mut buffer = std::io::Cursor::new(Vec::new());
                    OpenExrEncoder::new(&mut buffer).write_image(bytes, image.width, image.height, color)?;
                    out.write_all(buffer.get_ref()).map_err(image::ImageError::IoError)
                }
                _ => PngEncoder::new(&mut *out).write_image(bytes, image.width, image.height, color),
            }
        };
        match format {
            Format::Exr => encoded(bytemuck::cast_slice(&image.pixels), ExtendedColorType::Rgb32F),
            Format::Png => {
                let bytes: Vec<u8> = image.pixels.iter().flatten().map(|&x| tone.byte(x)).collect();
                encoded(&bytes, ExtendedColorType::Rgb8)
            }
            Format::Hdr => {
                let pixels: Vec<Rgb<f32>> = image.pixels.iter().map(|&p| Rgb(p)).collect();
                HdrEncoder::new(&mut *out).encode(&pixels, image.width as usize, image.height as usize)
            }
        }
        .map_err(|error| error.to_string())
    })
}

/// Writes a file whole or not at all: `fill` writes to a temporary file in the same folder, which then takes the name.
///
/// # Errors
/// [`ImageError::Write`].
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<(), String>) -> Result<(), ImageError> {
    let failed = |reason: String| ImageError::Write { path: path.to_owned(), reason };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hashcache-");
    // Temporary files are private by default; a result is as readable as other programs' files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    let temporary = builder.tempfile_in(folder).map_err(|error| failed(error.to_string()))?;
    let mut out = BufWriter::new(temporary);
    fill(&mut out).map_err(failed)?;
    let temporary = out.into_inner().map_err(|error| failed(error.to_string()))?;
    temporary.persist(path).map_err(|error| failed(error.error.to_string()))?;
    Ok(())
}

/// Reads a picture; PNG is decoded to linear.
///
/// # Errors
/// [`ImageError::Read`].
pub fn read(path: &Path) -> Result<Image, ImageError> {
    let failed = |reason: String| ImageError::Read { path: path.to_owned(), reason };
    let reader = ImageReader::open(path).map_err(|error| failed(error.to_string()))?;
    let reader = reader.with_guessed_format().map_err(|error| failed(error.to_string()))?;
    let encoded = reader.format() == Some(image::ImageFormat::Png);
    let decoded = reader.decode().map_err(|error| failed(error.to_string()))?;
    let (width, height) = (decoded.width(), decoded.height());
    // Floats are taken as they are; a conversion between float layouts may clip them.
    let mut pixels: Vec<[f32; 3]> = match decoded {
        DynamicImage::ImageRgba32F(image) => image.pixels().map(|p| [p.0[0], p.0[1], p.0[2]]).collect(),
        other => other.into_rgb32f().pixels().map(|p| p.0).collect(),
    };
    if encoded {
        for value in pixels.iter_mut().flatten() {
            *value = srgb_decode(*value);
        }
    }
    Ok(Image { width, height, pixels })
}
