//! Pixels as PNG bytes, of a size that can be written; bytes as text.

use base64::prelude::{BASE64_STANDARD, Engine};

use crate::image::{EncodingError, grey16_png, rgb_png};

/// A picture that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// More than 2²⁸ pixels.
    #[error(
        "a picture of {0} × {1} pixels is too large; show fewer panels, or average the matrix first"
    )]
    TooLarge(usize, usize),
    /// The encoder's own report.
    #[error("{0}; show fewer panels, or average the matrix first")]
    Encoding(#[from] EncodingError),
    /// The renderer's own report.
    #[error(
        "the figure could not be drawn from its SVG ({0}); its numbers are in the files beside it"
    )]
    Drawing(String),
}

/// Most pixels of a picture.
const MOST: usize = 1 << 28;

/// Whether a picture of that size can be written.
///
/// # Errors
/// [`PictureError::TooLarge`].
pub(super) fn checked([width, height]: [usize; 2]) -> Result<[u32; 2], PictureError> {
    let error = || PictureError::TooLarge(width, height);
    let pixels = width.checked_mul(height).filter(|n| *n <= MOST);
    pixels.ok_or_else(error)?;
    let [w, h] = [width, height].map(u32::try_from);
    Ok([w.map_err(|_| error())?, h.map_err(|_| error())?])
}

/// [`rgb_png`] of a checked size.
///
/// # Errors
/// [`PictureError`].
pub(super) fn rgb(
    size: [usize; 2],
    pixels: &[u8],
    pixels_per_metre: Option<u32>,
) -> Result<Vec<u8>, PictureError> {
    Ok(rgb_png(checked(size)?, pixels, pixels_per_metre)?)
}

/// [`grey16_png`] of a checked size.
///
/// # Errors
/// [`PictureError`].
pub(super) fn grey16(size: [usize; 2], pixels: &[u16]) -> Result<Vec<u8>, PictureError> {
    Ok(grey16_png(checked(size)?, pixels)?)
}

/// Bytes as base64.
pub(super) fn base64(bytes: &[u8]) -> String {
    BASE64_STANDARD.encode(bytes)
}

/// Width, height and RGB pixels of a PNG.
#[cfg(test)]
pub(super) fn decoded(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    use crate::image::{Channel, decode};
    let image = decode("figure", bytes).unwrap();
    assert_eq!(
        image.channels,
        [Channel::Red, Channel::Green, Channel::Blue]
    );
    let codes = image.values.iter().map(|v| (255.0 * v).round() as u8);
    (image.width, image.height, codes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_sizes_are_refused() {
        assert!(checked([1 << 20, 1 << 20]).is_err());
        assert!(checked([usize::MAX, 2]).is_err());
    }
}
