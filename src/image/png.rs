//! PNG bytes to pictures and back: the one door to the crate `png`.

use std::io::Cursor;

use super::{Channel, DEFLATE_RATIO_MAX, Encoding, Image, ImageError, checked_size, damaged};

/// A γ that differs from 1 by no more is linear.
const LINEAR: f64 = 1e-3;

/// The encoder's own report.
#[derive(Debug, thiserror::Error)]
#[error("the picture could not be encoded as PNG: {0}")]
pub struct EncodingError(#[from] png::EncodingError);

/// A coloured picture as PNG bytes, three bytes a pixel, row by row from the top; with
/// `pixels_per_metre` it says how large it is on paper.
///
/// # Errors
/// [`EncodingError`].
pub fn rgb_png(
    [width, height]: [u32; 2],
    pixels: &[u8],
    pixels_per_metre: Option<u32>,
) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_pixel_dims(pixels_per_metre.map(|n| png::PixelDimensions {
        xppu: n,
        yppu: n,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// A 16-bit grey picture as PNG bytes, `pixels` row by row from the top.
///
/// # Errors
/// [`EncodingError`].
pub fn grey16_png([width, height]: [u32; 2], pixels: &[u16]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header()?;
    let data: Vec<u8> = pixels.iter().flat_map(|p| p.to_be_bytes()).collect();
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}

/// Columns and rows.
pub(super) fn png_size(bytes: &[u8]) -> Option<[usize; 2]> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    let header = decoder.read_header_info().ok()?;
    Some([header.width, header.height].map(|n| n as usize))
}

/// γ of light = (value/full scale)^γ by its sRGB or gAMA chunk; none of other files, of PNGs that
/// say nothing of it and of those that say that they are linear.
pub(super) fn png_gamma(bytes: &[u8]) -> Option<f64> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let reader = decoder.read_info().ok()?;
    let gamma = 1.0 / f64::from(reader.info().gamma()?.into_value());
    (gamma.is_finite() && (gamma - 1.0).abs() > LINEAR).then_some(gamma)
}

/// A PNG of any colour type and depth; palettes become colours, a transparent colour becomes alpha.
/// Of an animation the still picture.
pub(super) fn read_png(name: &str, bytes: &[u8], most: usize) -> Result<Image, ImageError> {
    let fault = |e: png::DecodingError| damaged(name, e);
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(fault)?;
    let [width, height] = [header.width, header.height].map(|n| n as usize);
    let bits = header.bits_per_pixel();
    let held = bytes.len().saturating_mul(8 * DEFLATE_RATIO_MAX) / bits.max(1);
    checked_size(name, [width, height], held, most)?;

    let mut reader = decoder.read_info().map_err(fault)?;
    let (colour, depth) = reader.output_color_type();
    let channels = match colour {
        png::ColorType::Grayscale => vec![Channel::Grey],
        png::ColorType::GrayscaleAlpha => vec![Channel::Grey, Channel::Alpha],
        png::ColorType::Rgb => vec![Channel::Red, Channel::Green, Channel::Blue],
        png::ColorType::Rgba => vec![Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha],
        png::ColorType::Indexed => return Err(damaged(name, "its palette is missing")),
    };
    let size = reader.output_buffer_size();
    let size = size.ok_or_else(|| damaged(name, "its size is beyond any memory"))?;
    let mut stored = vec![0; size];
    reader.next_frame(&mut stored).map_err(fault)?;
    reader.finish().map_err(fault)?;
    let values: Vec<f32> = match depth {
        png::BitDepth::Sixteen => {
            let codes = stored
                .chunks_exact(2)
                .map(|b| u16::from_be_bytes([b[0], b[1]]));
            codes.map(|c| (f64::from(c) / 65535.0) as f32).collect()
        }
        _ => stored
            .iter()
            .map(|c| (f64::from(*c) / 255.0) as f32)
            .collect(),
    };
    if values.len() != width * height * channels.len() {
        return Err(damaged(name, "it has fewer values than pixels"));
    }
    Ok(Image {
        width,
        height,
        channels,
        values,
        encoding: Encoding::Integer,
    })
}
