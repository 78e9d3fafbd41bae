//! Photographs from the bytes of their files, as they are stored.

use super::exr::{envelope, is_whole};
use super::orientation::Orientation;
use super::png::png_gamma;
use super::samples::{MOST_SAMPLED, MOST_SAMPLES, Samples, TOO_MANY, unknown_turn, upright};
use super::tiff::read_tiff;
use super::{Encoding, ImageError, damaged, decode_within, unsupported};

/// The frames of a PNG, JPEG, OpenEXR or TIFF file by its first bytes, upright: an orientation that
/// the camera noted (EXIF) is applied. `name` is only for messages.
///
/// PNG and TIFF: grey or colour of 8, 16 or (TIFF) 32 bits, floating point of 32 or 64 bits (TIFF);
/// JPEG: 8 bits; OpenEXR: R, G and B, or Y. Each page of a TIFF is a frame. Takes at most 24 bytes
/// of memory for each sample, which are at most [`MOST_SAMPLES`] and at most what the file can
/// hold.
///
/// # Errors
/// [`ImageError`] for another format, a palette, fewer bits, transparency, samples that are not
/// finite, damage, and sizes beyond [`MOST_SAMPLED`].
pub fn samples(name: &str, bytes: &[u8]) -> Result<Vec<Samples>, ImageError> {
    let frames = match bytes {
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => read_tiff(name, bytes)?,
        _ => vec![of_image(name, bytes)?],
    };
    if frames
        .iter()
        .any(|f| f.values.iter().any(|x| !x.is_finite()))
    {
        return Err(damaged(name, "it has samples that are no finite numbers"));
    }
    Ok(frames)
}

/// A picture of the formats that scenes name too.
fn of_image(name: &str, bytes: &[u8]) -> Result<Samples, ImageError> {
    let full_scale = match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(png_full_scale(name, bytes)?),
        [0xff, 0xd8, 0xff, ..] => Some(255.0),
        _ => None,
    };
    if full_scale.is_none() && envelope::check_list(bytes).is_ok() && !is_whole(bytes) {
        let reason = "its data window is not its display window: no light was measured outside it; save the frame whole, or crop its display window";
        return Err(unsupported(name, reason));
    }
    let image = decode_within(name, bytes, MOST_SAMPLED)?;
    if image.values.len() > MOST_SAMPLES {
        return Err(unsupported(name, TOO_MANY));
    }
    // Both ways f32 is exact: it tells integers of 16 bits apart.
    let stored = |x: &f32| match full_scale {
        Some(most) => (f64::from(*x) * most).round(),
        None => f64::from(*x),
    };
    let values = image.values.iter().map(stored).collect();
    let frame = Samples {
        width: image.width,
        height: image.height,
        channels: image.channels,
        values,
        full_scale,
        is_lossy: matches!(bytes, [0xff, 0xd8, ..]),
        gamma: png_gamma(bytes),
    };
    let opaque = match image.encoding {
        Encoding::Integer => full_scale.unwrap_or(1.0),
        Encoding::Float => 1.0,
    };
    let orientation = Orientation::of_file(bytes).map_err(|code| unknown_turn(name, code))?;
    Ok(upright(frame.opaque(name, opaque)?, orientation))
}

/// 255 or 65535, from the header of a PNG: its width, height (u32 each), bits and colour type
/// follow the signature and the head of the first chunk.
fn png_full_scale(name: &str, bytes: &[u8]) -> Result<f64, ImageError> {
    match bytes.get(24..26) {
        Some([_, 3]) => Err(unsupported(
            name,
            "it has a palette, whose numbers are no light; save it as grey or colour of 8 or 16 bits",
        )),
        Some([8, _]) => Ok(255.0),
        Some([16, _]) => Ok(65535.0),
        Some([bits, _]) => Err(unsupported(
            name,
            format!("it has {bits} bits a sample; save it with 8 or 16"),
        )),
        _ => Err(damaged(name, "its header is cut short")),
    }
}
