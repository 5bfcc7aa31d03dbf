//! PNG, row by row into place.

use std::io::Cursor;

use png::{BitDepth, ColorType, DecodeOptions, Decoder, Limits, Reader, Transformations};

use super::{Header, Kind, checked};

/// Bytes that the decoder may take for itself beside the rows: its window, its tables, the chunks before the pixels.
const DECODER_SCRATCH: usize = 64 << 20;

/// Deflate packs at most so many bytes into one.
const DEFLATE_RATIO: u64 = 1032;

/// Size and depth.
pub(super) fn header(bytes: &[u8]) -> Result<Header, String> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: DECODER_SCRATCH });
    let info = decoder.read_header_info().map_err(|e| e.to_string())?;
    let bits = info.color_type.samples() as u64 * info.bit_depth as u64;
    let densest = DEFLATE_RATIO * 8 / bits.max(1);
    checked(Kind::Png, [info.width, info.height], info.bit_depth == BitDepth::Sixteen, bytes.len() as u64, densest)
}

/// Decodes the whole file.
pub(super) fn decode(bytes: &[u8], out: &mut [u32]) -> Result<(), String> {
    let broken = |e: png::DecodingError| e.to_string();
    // Texts and profiles mean nothing here, and may unpack to a lot.
    let mut options = DecodeOptions::default();
    options.set_ignore_text_chunk(true);
    options.set_ignore_iccp_chunk(true);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    decoder.set_transformations(Transformations::EXPAND | Transformations::ALPHA);
    decoder.set_limits(Limits { bytes: DECODER_SCRATCH });
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = reader.info().size();
    if u64::from(width) * u64::from(height) != out.len() as u64 {
        return Err("its size has changed".into());
    }
    let layout = reader.output_color_type();
    if reader.info().interlaced {
        return interlaced(&mut reader, layout, out);
    }
    for texels in out.chunks_exact_mut(width as usize) {
        let row = reader.next_row().map_err(broken)?.ok_or("it ends early")?;
        convert(layout, row.data(), texels)?;
    }
    Ok(())
}

/// An interlaced image is whole after its last pass only.
fn interlaced(
    reader: &mut Reader<Cursor<&[u8]>>,
    layout: (ColorType, BitDepth),
    out: &mut [u32],
) -> Result<(), String> {
    let bytes = reader.output_buffer_size().ok_or("it is too large for this machine")?;
    let mut whole = vec![0; bytes];
    reader.next_frame(&mut whole).map_err(|e| e.to_string())?;
    convert(layout, &whole, out)
}

/// Samples as words. 16 bits are rounded to 8.
fn convert(layout: (ColorType, BitDepth), samples: &[u8], out: &mut [u32]) -> Result<(), String> {
    let high = |be: &[u8]| ((u32::from(u16::from_be_bytes([be[0], be[1]])) + 128) / 257) as u8;
    let word = u32::from_le_bytes;
    match layout {
        (ColorType::Rgba, BitDepth::Eight) => fill(out, samples.chunks_exact(4), |c| word([c[0], c[1], c[2], c[3]])),
        (ColorType::GrayscaleAlpha, BitDepth::Eight) => {
            fill(out, samples.chunks_exact(2), |c| word([c[0], c[0], c[0], c[1]]));
        }
        (ColorType::Rgba, BitDepth::Sixteen) => {
            fill(out, samples.chunks_exact(8), |c| word([high(c), high(&c[2..]), high(&c[4..]), high(&c[6..])]));
        }
        (ColorType::GrayscaleAlpha, BitDepth::Sixteen) => {
            fill(out, samples.chunks_exact(4), |c| word([high(c), high(c), high(c), high(&c[2..])]));
        }
        (color, depth) => return Err(format!("{color:?} pixels of {depth:?} bits")),
    }
    Ok(())
}

fn fill<'a>(out: &mut [u32], samples: impl Iterator<Item = &'a [u8]>, texel: impl Fn(&[u8]) -> u32) {
    for (out, sample) in out.iter_mut().zip(samples) {
        *out = texel(sample);
    }
}
