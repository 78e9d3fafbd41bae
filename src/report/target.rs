//! Target pictures as PNG.

use super::encode::{PictureError, grey16};
use crate::image::Transfer;
use crate::scene::target::Picture;

/// A target as 16-bit grey PNG: 65535 stands for white, and reflectance is stored by `transfer`,
/// rounded.
///
/// # Errors
/// [`PictureError`].
pub fn target_png(picture: &Picture, transfer: Transfer) -> Result<Vec<u8>, PictureError> {
    let code = |x: &f64| (65535.0 * transfer.encode(*x)).round() as u16;
    let pixels: Vec<u16> = picture.values.iter().map(code).collect();
    grey16(picture.size, &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::target::Target;

    /// Read back with the stated transfer, each value is that of the picture within half a code.
    #[test]
    fn a_target_survives_its_file_within_half_a_code() {
        for target in Target::ALL {
            let picture = target.picture(target.usual_size()).unwrap();
            for transfer in [Transfer::Srgb, Transfer::Linear] {
                let bytes = target_png(&picture, transfer).unwrap();
                let image = crate::image::decode("target", &bytes).unwrap();
                assert_eq!([image.width, image.height], picture.size);
                for (read, drawn) in image.values.iter().zip(&picture.values) {
                    let code = 65535.0 * transfer.encode(*drawn);
                    // The values of an image are f32: 2^−24 of 65535 codes beside the half.
                    assert!(
                        (65535.0 * f64::from(*read) - code).abs() <= 0.5 + 0.004,
                        "{target:?}: {read} {drawn}"
                    );
                    let linear = transfer.decode(f64::from(*read));
                    assert!(
                        (linear - drawn).abs() < 2e-5,
                        "{target:?}: {linear} {drawn}"
                    );
                }
            }
        }
    }
}
