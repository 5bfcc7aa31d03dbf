//! Image files as texels.

mod jpeg;
mod png;

use image::ImageFormat;

/// What an image file says about itself before its pixels are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Texels a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// The image has more than 8 bits a channel.
    pub deep: bool,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
}

impl Header {
    /// Number of texels.
    pub fn texels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Reads the head of a PNG or JPEG file. A size of 0, or one that these few bytes cannot hold, is refused.
///
/// # Errors
/// What is wrong with the file, in words.
pub(crate) fn header(bytes: &[u8]) -> Result<Header, String> {
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => png::header(bytes),
        Ok(ImageFormat::Jpeg) => jpeg::header(bytes),
        _ => Err(foreign(bytes)),
    }
}

/// Decodes a whole file into RGBA8 words, red in the lowest byte, rows from the top. `out` has [`Header::texels`] words.
///
/// # Errors
/// What is wrong with the file, in words; what `out` holds then has no meaning.
pub(crate) fn decode(bytes: &[u8], header: &Header, out: &mut [u32]) -> Result<(), String> {
    match header.kind {
        Kind::Png => png::decode(bytes, out),
        Kind::Jpeg => jpeg::decode(bytes, out),
    }
}

/// Names the format of a file that is neither PNG nor JPEG.
fn foreign(bytes: &[u8]) -> String {
    const KTX: &[u8] = b"\xabKTX 11\xbb\r\n\x1a\n";
    const KTX2: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";
    let riff = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
    let name = match bytes {
        _ if bytes.starts_with(KTX2) => "KTX2 (as KHR_texture_basisu has it)",
        _ if bytes.starts_with(KTX) => "KTX",
        _ if bytes.starts_with(b"DDS ") => "DDS (as MSFT_texture_dds has it)",
        _ if bytes.starts_with(b"sB") => "Basis Universal",
        _ if riff => "WebP (as EXT_texture_webp has it)",
        _ if bytes.get(4..12) == Some(b"ftypavif") => "AVIF (as EXT_texture_avif has it)",
        _ => return "neither PNG nor JPEG".into(),
    };
    format!("{name} is neither PNG nor JPEG")
}

/// Refuses a size that is 0 or that these few bytes cannot hold.
fn checked(
    kind: Kind,
    [width, height]: [u32; 2],
    deep: bool,
    bytes: u64,
    pixels_a_byte: u64,
) -> Result<Header, String> {
    let header = Header { width, height, deep, kind };
    if header.texels() == 0 {
        return Err("it has no pixels".into());
    }
    if header.texels() > bytes.saturating_mul(pixels_a_byte) {
        return Err(format!("{width}x{height} pixels cannot be in {bytes} bytes"));
    }
    Ok(header)
}

/// A texel without transparency.
fn opaque(rgb: &[u8]) -> u32 {
    u32::from_le_bytes([rgb[0], rgb[1], rgb[2], 255])
}
