//! Photographs as pictures of counts.

use super::encode::{PictureError, grey16};

/// A frame of counts as 16-bit grey PNG, row 0 on top as in the EXR file beside it; 65535 stands
/// for `white`. With `white` = 65535 the pixels are the counts, rounded.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
pub fn counts_png(
    [columns, rows]: [usize; 2],
    counts: &[f64],
    white: f64,
) -> Result<Vec<u8>, PictureError> {
    let scale = if white > 0.0 { 65535.0 / white } else { 0.0 };
    let pixels: Vec<u16> = counts.iter().map(|c| (c * scale).round() as u16).collect();
    grey16([columns, rows], &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of a PNG, read with the crate, are the counts.
    #[test]
    fn counts_are_stored_as_they_are() {
        let counts = [0.0, 1.0, 100.4, 65535.0, 256.0, 4095.0];
        let bytes = counts_png([3, 2], &counts, 65535.0).unwrap();
        let image = crate::image::decode("counts", &bytes).unwrap();
        assert_eq!(image.channels, [crate::image::Channel::Grey]);
        assert_eq!((image.width, image.height), (3, 2));
        let codes = image
            .values
            .iter()
            .map(|v| (65535.0 * f64::from(*v)).round() as u16);
        let values: Vec<u16> = codes.collect();
        assert_eq!(values, [0, 1, 100, 65535, 256, 4095]);
        // A scale for counts without end, and a black frame.
        assert!(counts_png([1, 1], &[3e9], 3e9).is_ok());
        assert!(counts_png([1, 1], &[0.0], 0.0).is_ok());
    }
}
