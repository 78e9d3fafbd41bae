//! JPEG bytes to pictures: the one door to the crate `zune_jpeg`.
//!
//! Baseline and progressive, grey or YCbCr; no vector instructions, whose roundings could differ
//! between machines. What is cut short is an error (but not what was cut short and closed again by
//! an end marker: such a file decodes). The orientation that a camera notes (EXIF) is not applied:
//! turn the picture itself.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::{Channel, Encoding, Image, ImageError, checked_size, damaged, unsupported};

/// No byte codes more pixels: each block of 8 × 8 takes at least one bit.
const PIXELS_PER_BYTE: usize = 8 * 64;

/// The two bytes that end a JPEG.
const END: [u8; 2] = [0xff, 0xd9];

/// Columns and rows.
pub(super) fn jpeg_size(bytes: &[u8]) -> Option<[usize; 2]> {
    let mut decoder = JpegDecoder::new(ZCursor::new(bytes));
    decoder.decode_headers().ok()?;
    decoder.dimensions().map(|(width, height)| [width, height])
}

pub(super) fn read_jpeg(name: &str, bytes: &[u8], most: usize) -> Result<Image, ImageError> {
    let fault = |e| damaged(name, e);
    let options = DecoderOptions::default()
        .set_use_unsafe(false)
        .set_strict_mode(true)
        .set_max_width(most)
        .set_max_height(most);
    if !bytes.windows(2).any(|pair| pair == END) {
        return Err(damaged(name, "its end is missing"));
    }
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(fault)?;
    let (width, height) = decoder
        .dimensions()
        .ok_or_else(|| damaged(name, "it has no size"))?;
    checked_size(
        name,
        [width, height],
        bytes.len().saturating_mul(PIXELS_PER_BYTE),
        most,
    )?;
    let (space, channels) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (ColorSpace::Luma, vec![Channel::Grey]),
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => (
            ColorSpace::RGB,
            vec![Channel::Red, Channel::Green, Channel::Blue],
        ),
        Some(other) => {
            let reason = format!(
                "its colours are {other:?}, which needs a profile to become red, green and blue; save it as RGB or grey"
            );
            return Err(unsupported(name, reason));
        }
        None => return Err(damaged(name, "it does not say its colours")),
    };
    decoder.set_options(options.jpeg_set_out_colorspace(space));
    let stored = decoder.decode().map_err(fault)?;
    if stored.len() != width * height * channels.len() {
        return Err(damaged(name, "it has fewer values than pixels"));
    }
    Ok(Image {
        width,
        height,
        channels,
        values: stored
            .iter()
            .map(|c| (f64::from(*c) / 255.0) as f32)
            .collect(),
        encoding: Encoding::Integer,
    })
}
