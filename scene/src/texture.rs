//! Base colour images as texels.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};

/// The size of an image and where its texels begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Texels {
    /// Index of the upper left texel.
    pub first: u32,
    /// Texels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The image had more than 8 bits a channel.
    pub deep: bool,
}

/// Why an image is no texture.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// Not a PNG or JPEG file, or a broken one.
    Broken(String),
    /// This many texels are more than are left.
    TooLarge(u64),
}

/// Bytes of decoder scratch allowed beside the image itself.
const DECODER_SCRATCH: u64 = 64 << 20;

/// Decodes a PNG or JPEG file and appends its texels: RGBA8 words, red in the lowest byte. At most `limit` texels may
/// be there afterwards; an image that announces more is refused before it is decoded.
pub(crate) fn append(bytes: &[u8], texels: &mut Vec<u32>, limit: u32) -> Result<Texels, Refusal> {
    let broken = |e: image::ImageError| Refusal::Broken(e.to_string());
    let format = image::guess_format(bytes).ok().filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg));
    let format = format.ok_or_else(|| Refusal::Broken("neither PNG nor JPEG".into()))?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODER_SCRATCH);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    let left = u64::from(limit).saturating_sub(texels.len() as u64);
    if count == 0 {
        return Err(Refusal::Broken("it has no pixels".into()));
    }
    if count > left {
        return Err(Refusal::TooLarge(count));
    }
    // The deepest pixel is four channels of 16 bits.
    limits.max_alloc = Some(count * 8 + DECODER_SCRATCH);
    decoder.set_limits(limits).map_err(broken)?;
    let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let first = texels.len() as u32;
    let deep = image.color().bytes_per_pixel() / image.color().channel_count() > 1;
    texels.reserve(count as usize);
    match image {
        DynamicImage::ImageRgb8(rgb) => {
            texels.extend(rgb.as_raw().chunks_exact(3).map(|c| u32::from_le_bytes([c[0], c[1], c[2], 255])));
        }
        other => {
            let rgba = other.into_rgba8();
            texels.extend(rgba.as_raw().chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])));
        }
    }
    Ok(Texels { first, width, height, deep })
}
