//! Floor 1: pictures. PNG, JPEG, OpenEXR and TIFF bytes into numbers, numbers into PNG bytes; the
//! doors to the crates behind them.
//!
//! A decoded [`Image`] has the values that the file stores, without any transfer function: what
//! they mean is for the one who knows where the picture came from, and [`Transfer`] is how to say
//! it. Profiles and gamma chunks within a file are not read. Photographs are read by
//! [`fn@samples`], as the integers that they are.
//!
//! No claim of a file is trusted: width and height are read from its header and held against
//! [`MOST_PIXELS`] and against the file's length before memory is taken for pixels. Deflate (PNG,
//! most OpenEXR) makes at most 1032 bytes of one, and a JPEG takes at least a bit for a block of 8
//! × 8 pixels. So decoding takes at most [`PIXEL_BYTES`] for each of [`MOST_PIXELS`], whatever a
//! file claims.

pub(crate) mod exr;
mod jpeg;
mod orientation;
mod png;
mod samples;
mod stored;
mod tiff;
mod transfer;

pub use self::png::{EncodingError, grey16_png, rgb_png};
pub use samples::{MOST_SAMPLED, MOST_SAMPLES, Samples};
pub use stored::samples;
pub use transfer::Transfer;

use self::exr::{exr_size, read_exr};
use self::png::{png_size, read_png};
use jpeg::{jpeg_size, read_jpeg};

/// Most pixels of a picture that is decoded: 4096 × 4096.
pub const MOST_PIXELS: usize = 1 << 24;
/// Most bytes that decoding takes for each pixel.
pub const PIXEL_BYTES: usize = 48;

/// Deflate's best: no n bytes hold more than 1032·n (its longest match of 258 bytes for two bits).
pub const DEFLATE_RATIO_MAX: usize = 1032;

/// What a channel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The only colour.
    Grey,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Opacity.
    Alpha,
}

/// How values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Integers of so many bits, divided by their largest: values in \[0, 1\] whose transfer the
    /// file does not reliably say.
    Integer,
    /// Floating-point numbers, linear in light by the definition of OpenEXR, of any size.
    Float,
}

/// A decoded picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What the values of a pixel are, in order: grey, or red, green and blue; then alpha, if there
    /// is any.
    pub channels: Vec<Channel>,
    /// Row by row from the top, each from the left, all channels of a pixel together.
    pub values: Vec<f32>,
    /// How the file stored them.
    pub encoding: Encoding,
}

/// A picture that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// None of the known formats.
    #[error("`{0}` is no PNG, JPEG or OpenEXR picture by its first bytes; save it as one of them")]
    Unknown(String),
    /// More pixels than anybody needs here, or than the file can hold.
    #[error(
        "`{name}` claims {width} × {height} pixels: {reason}; scale the picture down, or save it again"
    )]
    Size {
        /// The picture.
        name: String,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// What is wrong with them.
        reason: &'static str,
    },
    /// A picture of a kind that is not read.
    #[error("`{name}`: {reason}")]
    Unsupported {
        /// The picture.
        name: String,
        /// What it is, and how to save it instead.
        reason: String,
    },
    /// Cut short or altered.
    #[error("`{name}` is damaged: {reason}; save it again")]
    Damaged {
        /// The picture.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// Decodes a picture by its first bytes; `name` is only for messages.
///
/// # Errors
/// [`ImageError`].
pub fn decode(name: &str, bytes: &[u8]) -> Result<Image, ImageError> {
    decode_within(name, bytes, MOST_PIXELS)
}

/// [`decode`] up to `most` pixels.
fn decode_within(name: &str, bytes: &[u8], most: usize) -> Result<Image, ImageError> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => read_png(name, bytes, most),
        [0xff, 0xd8, 0xff, ..] => read_jpeg(name, bytes, most),
        [0x76, 0x2f, 0x31, 0x01, ..] => read_exr(name, bytes, most),
        _ => Err(ImageError::Unknown(name.to_owned())),
    }
}

/// Columns and rows of a picture by its header, if that can be read.
pub fn size(bytes: &[u8]) -> Option<[usize; 2]> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => png_size(bytes),
        [0xff, 0xd8, 0xff, ..] => jpeg_size(bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr_size(bytes),
        _ => None,
    }
}

impl Image {
    /// The values of one channel, row by row from the top.
    pub fn channel(&self, channel: Channel) -> Option<impl Iterator<Item = f32> + '_> {
        let at = self.channels.iter().position(|c| *c == channel)?;
        let values = self.values.iter().skip(at);
        Some(values.step_by(self.channels.len()).copied())
    }
}

/// A picture's size, held against the `most` pixels that are read and against the most that its
/// file can hold.
fn checked_size(
    name: &str,
    [width, height]: [usize; 2],
    held: usize,
    most: usize,
) -> Result<(), ImageError> {
    let reason = match width.checked_mul(height) {
        Some(0) => "it has no pixels",
        Some(n) if n > held => "its file is too short for them",
        Some(n) if n <= most => return Ok(()),
        _ if most > MOST_PIXELS => "more than 8192 × 8192",
        _ => "more than 4096 × 4096",
    };
    let name = name.to_owned();
    Err(ImageError::Size {
        name,
        width,
        height,
        reason,
    })
}

fn damaged(name: &str, reason: impl ToString) -> ImageError {
    ImageError::Damaged {
        name: name.to_owned(),
        reason: reason.to_string(),
    }
}

fn unsupported(name: &str, reason: impl Into<String>) -> ImageError {
    ImageError::Unsupported {
        name: name.to_owned(),
        reason: reason.into(),
    }
}

#[cfg(test)]
pub(crate) mod tests;
