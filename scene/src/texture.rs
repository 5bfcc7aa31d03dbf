//! Base colour images as texels.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder as _, ImageFormat, Limits};

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

/// Deflate packs at most so many bytes into one.
const DEFLATE_RATIO: u64 = 1032;

/// Pixels that a byte of JPEG can hold: at least one bit for a block of 64, taken twice to be safe.
const JPEG_PIXELS_A_BYTE: u64 = 1024;

/// Decodes a PNG or JPEG file and appends its texels: RGBA8 words, red in the lowest byte. At most `limit` texels may
/// be there afterwards; an image that announces more is refused before it is decoded.
pub(crate) fn append(bytes: &[u8], texels: &mut Vec<u32>, limit: u32) -> Result<Texels, Refusal> {
    let left = u64::from(limit).saturating_sub(texels.len() as u64);
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => png(bytes, texels, left),
        Ok(ImageFormat::Jpeg) => jpeg(bytes, texels, left),
        _ => Err(Refusal::Broken("neither PNG nor JPEG".into())),
    }
}

/// Refuses a size that is 0, that these few bytes cannot hold, or that is too large.
fn check_size(width: u32, height: u32, bytes: u64, pixels_a_byte: u64, left: u64) -> Result<u64, Refusal> {
    let count = u64::from(width) * u64::from(height);
    if count == 0 {
        return Err(Refusal::Broken("it has no pixels".into()));
    }
    if count > bytes.saturating_mul(pixels_a_byte) {
        return Err(Refusal::Broken(format!("{width}x{height} pixels cannot be in {bytes} bytes")));
    }
    if count > left {
        return Err(Refusal::TooLarge(count));
    }
    Ok(count)
}

fn png(bytes: &[u8], texels: &mut Vec<u32>, left: u64) -> Result<Texels, Refusal> {
    let broken = |e: image::ImageError| Refusal::Broken(e.to_string());
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODER_SCRATCH);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), limits.clone()).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let densest = DEFLATE_RATIO * 8 / u64::from(decoder.original_color_type().bits_per_pixel().max(1));
    let count = check_size(width, height, bytes.len() as u64, densest, left)?;
    // The deepest pixel is four channels of 16 bits.
    limits.max_alloc = Some(count * 8 + DECODER_SCRATCH);
    decoder.set_limits(limits).map_err(broken)?;
    let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let deep = image.color().bytes_per_pixel() / image.color().channel_count() > 1;
    let first = texels.len() as u32;
    texels.reserve_exact(count as usize);
    match image {
        DynamicImage::ImageRgb8(rgb) => texels.extend(rgb.as_raw().chunks_exact(3).map(opaque)),
        other => {
            let rgba = other.into_rgba8();
            texels.extend(rgba.as_raw().chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])));
        }
    }
    Ok(Texels { first, width, height, deep })
}

fn jpeg(bytes: &[u8], texels: &mut Vec<u32>, left: u64) -> Result<Texels, Refusal> {
    let broken = |e: jpeg_decoder::Error| Refusal::Broken(e.to_string());
    let mut decoder = jpeg_decoder::Decoder::new(bytes);
    decoder.read_info().map_err(broken)?;
    let info = decoder.info().ok_or_else(|| Refusal::Broken("it has no frame".into()))?;
    let (width, height) = (u32::from(info.width), u32::from(info.height));
    let count = check_size(width, height, bytes.len() as u64, JPEG_PIXELS_A_BYTE, left)?;
    decoder.set_max_decoding_buffer_size(count as usize * info.pixel_format.pixel_bytes());
    let pixels = decoder.decode().map_err(broken)?;
    let first = texels.len() as u32;
    texels.reserve_exact(count as usize);
    match info.pixel_format {
        jpeg_decoder::PixelFormat::RGB24 => texels.extend(pixels.chunks_exact(3).map(opaque)),
        jpeg_decoder::PixelFormat::L8 => texels.extend(pixels.iter().map(|&l| opaque(&[l, l, l]))),
        other => return Err(Refusal::Broken(format!("{other:?} pixels instead of RGB or grey"))),
    }
    if texels.len() as u64 != u64::from(first) + count {
        return Err(Refusal::Broken("it ends early".into()));
    }
    Ok(Texels { first, width, height, deep: false })
}

fn opaque(rgb: &[u8]) -> u32 {
    u32::from_le_bytes([rgb[0], rgb[1], rgb[2], 255])
}
