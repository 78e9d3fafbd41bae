//! The samples of photographs as their files store them: integers stay integers, and no transfer
//! function is applied.

use super::orientation::Orientation;
use super::tiff::read_tiff;
use super::{Channel, Encoding, ImageError, damaged, decode_within, unsupported};

/// Most pixels of a photograph: 8192 × 8192.
pub const MOST_SAMPLED: usize = 1 << 26;
/// Most samples of a file, all its frames and channels together: 1 GiB as f64.
pub const MOST_SAMPLES: usize = 1 << 27;

/// One frame of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Grey, or red, green and blue.
    pub channels: Vec<Channel>,
    /// As stored: row by row from the top, each from the left, all channels of a pixel together.
    pub values: Vec<f64>,
    /// The largest value that the file's integers can have; `None` for floating-point numbers.
    pub full_scale: Option<f64>,
    /// Whether the file's compression changes samples (JPEG).
    pub is_lossy: bool,
}

impl Samples {
    /// The values of one channel, row by row from the top.
    pub fn channel(&self, channel: Channel) -> Option<Vec<f64>> {
        let at = self.channels.iter().position(|c| *c == channel)?;
        let values = self.values.iter().skip(at);
        Some(values.step_by(self.channels.len()).copied().collect())
    }

    /// Whether all channels of each pixel are equal: a grey photograph saved in colour.
    pub fn is_grey(&self) -> bool {
        let mut pixels = self.values.chunks_exact(self.channels.len().max(1));
        pixels.all(|pixel| pixel.iter().all(|x| *x == pixel[0]))
    }

    /// Without its alpha, which has to be opaque everywhere.
    fn opaque(self, name: &str, opaque: f64) -> Result<Self, ImageError> {
        let count = self.channels.len();
        if self.channels.last() != Some(&Channel::Alpha) {
            return Ok(self);
        }
        if self
            .values
            .chunks_exact(count)
            .any(|p| p[count - 1] != opaque)
        {
            let reason =
                "it has transparent pixels (alpha), which no camera stores; save it without alpha";
            return Err(unsupported(name, reason));
        }
        let values = self.values.chunks_exact(count);
        Ok(Self {
            values: values
                .flat_map(|p| p[..count - 1].iter().copied())
                .collect(),
            channels: self.channels[..count - 1].to_vec(),
            ..self
        })
    }
}

/// The frames of a PNG, JPEG, OpenEXR or TIFF file by its first bytes, upright: an orientation that
/// the camera noted (EXIF) is applied. `name` is only for messages.
///
/// PNG and TIFF: grey or colour of 8, 16 or (TIFF) 32 bits, floating point of 32 or 64 bits (TIFF);
/// JPEG: 8 bits; OpenEXR: R, G and B, or Y. Each page of a TIFF is a frame. Takes at most 24 bytes
/// of memory for each sample, which are at most [`MOST_SAMPLES`] and at most what the file can hold.
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
    };
    let opaque = match image.encoding {
        Encoding::Integer => full_scale.unwrap_or(1.0),
        Encoding::Float => 1.0,
    };
    let orientation = Orientation::of_file(bytes).map_err(|code| unknown_turn(name, code))?;
    Ok(upright(frame.opaque(name, opaque)?, orientation))
}

/// Why a file of too many samples is not read.
pub(super) const TOO_MANY: &str =
    "it has more than 2²⁷ samples (1 GiB of numbers); crop it, or save it in parts";

/// The frame as the camera's note says that it was held.
pub(super) fn upright(frame: Samples, orientation: Orientation) -> Samples {
    if orientation.is_upright() {
        return frame;
    }
    let size = [frame.width, frame.height];
    let ([width, height], values) = orientation.turned(size, frame.channels.len(), &frame.values);
    Samples {
        width,
        height,
        values,
        ..frame
    }
}

pub(super) fn unknown_turn(name: &str, code: u16) -> ImageError {
    let reason = format!(
        "it notes the orientation {code}, which EXIF does not define (1 to 8); remove the note, or save it upright"
    );
    unsupported(name, reason)
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
