//! JPEG.

use jpeg_decoder::{Decoder, Error, PixelFormat};

use super::{Header, Kind, checked, opaque};

/// Pixels that a byte of JPEG can hold: at least one bit for a block of 64, taken twice to be safe.
const PIXELS_A_BYTE: u64 = 1024;

/// Size and depth.
pub(super) fn header(bytes: &[u8]) -> Result<Header, String> {
    let (_, info) = open(bytes)?;
    let size = [u32::from(info.width), u32::from(info.height)];
    checked(Kind::Jpeg, size, false, bytes.len() as u64, PIXELS_A_BYTE)
}

/// Decodes the whole file.
pub(super) fn decode(bytes: &[u8], out: &mut [u32]) -> Result<(), String> {
    let (mut decoder, info) = open(bytes)?;
    let channels = info.pixel_format.pixel_bytes();
    decoder.set_max_decoding_buffer_size(out.len().saturating_mul(channels));
    let pixels = decoder.decode().map_err(broken)?;
    if pixels.len() != out.len() * channels {
        return Err("it ends early".into());
    }
    match info.pixel_format {
        PixelFormat::L8 => out.iter_mut().zip(&pixels).for_each(|(out, &l)| *out = opaque(&[l; 3])),
        _ => out.iter_mut().zip(pixels.chunks_exact(3)).for_each(|(out, rgb)| *out = opaque(rgb)),
    }
    Ok(())
}

fn open(bytes: &[u8]) -> Result<(Decoder<&[u8]>, jpeg_decoder::ImageInfo), String> {
    let mut decoder = Decoder::new(bytes);
    decoder.read_info().map_err(broken)?;
    let info = decoder.info().ok_or("it has no frame")?;
    match info.pixel_format {
        PixelFormat::RGB24 | PixelFormat::L8 => Ok((decoder, info)),
        other => Err(format!("{other:?} pixels instead of RGB or grey")),
    }
}

#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives it away")]
fn broken(error: Error) -> String {
    error.to_string()
}
