//! TIFF bytes to samples: the one door to the crate `tiff`.
//!
//! Strips and tiles, uncompressed or by LZW, Deflate or PackBits; grey and RGB, chunky and planar;
//! but no planes in tiles that reach beyond the picture, by which the crate panics.

use std::io::{self, Cursor};

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::orientation::Orientation;
use super::samples::{MOST_SAMPLED, MOST_SAMPLES, Samples, TOO_MANY, unknown_turn, upright};
use super::{Channel, ImageError, checked_size, damaged, unsupported};

/// Most bytes that a byte of a file becomes: LZW's longest strings, 3837 codes of up to 12 bits for
/// 7.4 million bytes; Deflate and PackBits make fewer.
const RATIO: usize = 1400;
/// Most frames of a file.
const MOST_FRAMES: usize = 1 << 16;
/// PhotometricInterpretation of a picture whose zero is white.
const WHITE_IS_ZERO: u32 = 0;
/// PlanarConfiguration of channels that are stored one after the other.
const PLANAR: u32 = 2;
/// Compression by LZW.
const LZW: u32 = 5;

/// All pages of a file.
pub(super) fn read_tiff(name: &str, bytes: &[u8]) -> Result<Vec<Samples>, ImageError> {
    let fault = |e: TiffError| match e {
        TiffError::UnsupportedError(e) => unsupported(
            name,
            format!("{e}; save it uncompressed, or with LZW or Deflate, as grey or RGB"),
        ),
        other => damaged(name, other),
    };
    held_directory(bytes).ok_or_else(|| damaged(name, "its first directory is not whole"))?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = bytes.len().saturating_mul(RATIO).min(8 * MOST_SAMPLES);
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(fault)?;
    decoder = decoder.with_limits(limits);
    let mut frames = Vec::new();
    // What all pages hold together: they may share their bytes.
    let mut left = MOST_SAMPLES.min(bytes.len().saturating_mul(RATIO));
    loop {
        let size = decoder.dimensions().map_err(fault)?;
        let size = <[u32; 2]>::from(size).map(|n| n as usize);
        let (channels, bits) = kind(name, decoder.colortype().map_err(fault)?)?;
        let each = channels.len() * usize::from(bits);
        let held = bytes.len().saturating_mul(8 * RATIO) / each.max(1);
        checked_size(name, size, held, MOST_SAMPLED)?;
        let count = size[0] * size[1] * channels.len();
        left = left
            .checked_sub(count)
            .ok_or_else(|| unsupported(name, TOO_MANY))?;
        let mut number = |tag| decoder.find_tag_unsigned::<u32>(tag).map_err(fault);
        if number(Tag::PhotometricInterpretation)? == Some(WHITE_IS_ZERO) {
            let reason = "its zero is white; save it with zero as black";
            return Err(unsupported(name, reason));
        }
        let is_planar = channels.len() > 1 && number(Tag::PlanarConfiguration)? == Some(PLANAR);
        let tile = [number(Tag::TileWidth)?, number(Tag::TileLength)?];
        if is_planar && !is_filled(size, tile) {
            let reason = "its channels are apart, in tiles that reach beyond the picture; save it in strips, or with the channels of a pixel together";
            return Err(unsupported(name, reason));
        }
        let is_lzw = number(Tag::Compression)? == Some(LZW);
        let turn = number(Tag::Orientation)?.unwrap_or(1);
        let turn = u16::try_from(turn).unwrap_or(u16::MAX);
        let turn = Orientation::new(turn).ok_or_else(|| unknown_turn(name, turn))?;
        let mut found = DecodingResult::U8(Vec::new());
        decoder
            .read_image_to_buffer(&mut found)
            .map_err(|e| match e {
                TiffError::IoError(e) if is_lzw => of_lzw(name, &e),
                other => fault(other),
            })?;
        let (values, full_scale) = numbers(found);
        if values.len() != count {
            return Err(damaged(name, "it has fewer values than pixels"));
        }
        let frame = Samples {
            width: size[0],
            height: size[1],
            values: if is_planar {
                interleaved(&values, channels.len())
            } else {
                values
            },
            channels,
            full_scale,
            is_lossy: false,
            gamma: None,
        };
        frames.push(upright(frame, turn));
        if !decoder.more_images() {
            return Ok(frames);
        }
        if frames.len() == MOST_FRAMES {
            return Err(unsupported(
                name,
                "it has more than 65536 pages; save it in parts",
            ));
        }
        decoder.next_image().map_err(fault)?;
    }
}

/// The first directory, if its entries do not hold more values than the file has bytes: the decoder
/// reads it, 32 bytes a value, before it can be given limits.
///
/// TIFF 6.0, section 2: 2 bytes of order, 42, an offset of 4 bytes; there a count of 2 bytes and
/// entries of 12: tag, type, count of values. BigTIFF: 43, offset and count of 8, entries of 20.
fn held_directory(bytes: &[u8]) -> Option<()> {
    let is_little = bytes.starts_with(b"II");
    let number = |at: usize, length: usize| -> Option<usize> {
        let digits = bytes.get(at..at.checked_add(length)?)?;
        let joined = |n: u64, byte: &u8| n << 8 | u64::from(*byte);
        let number = if is_little {
            digits.iter().rev().fold(0, joined)
        } else {
            digits.iter().fold(0, joined)
        };
        usize::try_from(number).ok()
    };
    let (directory, width, entry, count) = match number(2, 2)? {
        43 => (number(8, 8)?, 8, 20, 8),
        _ => (number(4, 4)?, 2, 12, 4),
    };
    let first = directory.checked_add(width)?;
    let entries = number(directory, width)?;
    if entries > bytes.len() / entry {
        return None;
    }
    let is_held = |k| number(first + k * entry + 4, count).is_some_and(|n| n <= bytes.len());
    (0..entries).all(is_held).then_some(())
}

/// Whether tiles of a width and length, if there are any, end where the picture does.
fn is_filled(size: [usize; 2], tile: [Option<u32>; 2]) -> bool {
    let mut axes = size.into_iter().zip(tile);
    axes.all(|(n, tile)| tile.is_none_or(|tile| n.is_multiple_of(tile as usize)))
}

/// Why an LZW stream is refused: the crate takes some whole ones for cut off, and these are the
/// same when they are saved again.
fn of_lzw(name: &str, e: &io::Error) -> ImageError {
    let reason = format!(
        "its LZW stream cannot be read ({e}): it is damaged, or ends otherwise than expected; save it uncompressed or with Deflate"
    );
    unsupported(name, reason)
}

/// The channels and their bits, if they are light.
fn kind(name: &str, colour: ColorType) -> Result<(Vec<Channel>, u8), ImageError> {
    let (channels, bits) = match colour {
        ColorType::Gray(bits) => (vec![Channel::Grey], bits),
        ColorType::RGB(bits) => (vec![Channel::Red, Channel::Green, Channel::Blue], bits),
        other => {
            let reason = format!("its colours are {other:?}; save it as grey or RGB without alpha");
            return Err(unsupported(name, reason));
        }
    };
    if [8, 16, 32, 64].contains(&bits) {
        return Ok((channels, bits));
    }
    let reason = format!("it has {bits} bits a sample; save it with 8, 16 or 32");
    Err(unsupported(name, reason))
}

/// The numbers as f64, and the largest that integers of their type can be.
fn numbers(found: DecodingResult) -> (Vec<f64>, Option<f64>) {
    fn of<T: Copy + Into<f64>>(values: &[T]) -> Vec<f64> {
        values.iter().map(|x| (*x).into()).collect()
    }
    use DecodingResult as D;
    match found {
        D::U8(v) => (of(&v), Some(u8::MAX.into())),
        D::U16(v) => (of(&v), Some(u16::MAX.into())),
        D::U32(v) => (of(&v), Some(u32::MAX.into())),
        D::I8(v) => (of(&v), Some(i8::MAX.into())),
        D::I16(v) => (of(&v), Some(i16::MAX.into())),
        D::I32(v) => (of(&v), Some(i32::MAX.into())),
        D::F16(v) => (v.iter().map(|x| x.to_f64()).collect(), None),
        D::F32(v) => (of(&v), None),
        D::F64(v) => (v, None),
        D::U64(v) => (v.iter().map(|x| *x as f64).collect(), Some(u64::MAX as f64)),
        D::I64(v) => (v.iter().map(|x| *x as f64).collect(), Some(i64::MAX as f64)),
    }
}

/// Channel after channel to all channels of a pixel together.
fn interleaved(values: &[f64], channels: usize) -> Vec<f64> {
    let pixels = values.len() / channels;
    let pixel = |k: usize| (0..channels).map(move |c| values[k + c * pixels]);
    (0..pixels).flat_map(pixel).collect()
}
