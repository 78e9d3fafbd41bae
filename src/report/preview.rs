//! Previews as PNG.

use super::encode::{PictureError, rgb};
use crate::image::Transfer;
use crate::lab::Preview;

/// A preview as RGB PNG of eight bits: each colour clipped at 1 and encoded by the transfer of
/// sRGB. It is the only picture of the program that has a tone curve.
///
/// # Errors
/// [`PictureError`].
pub fn preview_png(preview: &Preview) -> Result<Vec<u8>, PictureError> {
    let code = |x: &f64| (255.0 * Transfer::Srgb.encode(x.clamp(0.0, 1.0))).round() as u8;
    let pixels: Vec<u8> = preview.colours.iter().flatten().map(code).collect();
    rgb(preview.size, &pixels, None)
}

#[cfg(test)]
mod tests {
    use super::super::encode::decoded;
    use super::*;

    /// Codes of IEC 61966-2-1: linear 0.5 is 188, 0.2158605 is 128; what is brighter than white is
    /// white.
    #[test]
    fn colours_are_stored_as_srgb() {
        let preview = Preview {
            size: [2, 1],
            colours: vec![[0.0, 0.5, 1.0], [0.215_860_5, 7.0, 1e-9]],
        };
        let (w, h, pixels) = decoded(&preview_png(&preview).unwrap());
        assert_eq!((w, h), (2, 1));
        assert_eq!(pixels, [0, 188, 255, 128, 255, 0]);
    }
}
