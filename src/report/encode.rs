//! Pixels as PNG bytes: the one door to the crate `png`.

/// A picture that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// More than 2²⁸ pixels.
    #[error(
        "a picture of {0} × {1} pixels is too large; show fewer panels, or average the matrix first"
    )]
    TooLarge(usize, usize),
    /// The encoder's own report.
    #[error(
        "the picture could not be encoded as PNG ({0}); show fewer panels, or average the matrix first"
    )]
    Encoding(#[from] png::EncodingError),
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

/// A coloured picture as PNG bytes, three bytes a pixel, row by row from the top; with `pixels_per_metre` it says how large it is on paper.
///
/// # Errors
/// [`PictureError`].
pub(super) fn rgb(
    size: [usize; 2],
    pixels: &[u8],
    pixels_per_metre: Option<u32>,
) -> Result<Vec<u8>, PictureError> {
    let [w, h] = checked(size)?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, w, h);
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
/// [`PictureError`].
pub(super) fn grey16(size: [usize; 2], pixels: &[u16]) -> Result<Vec<u8>, PictureError> {
    let [w, h] = checked(size)?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, w, h);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header()?;
    let data: Vec<u8> = pixels.iter().flat_map(|p| p.to_be_bytes()).collect();
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}

/// Width, height and RGB pixels of a PNG.
#[cfg(test)]
pub(super) fn decoded(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(
        (info.color_type, info.bit_depth),
        (png::ColorType::Rgb, png::BitDepth::Eight)
    );
    (info.width as usize, info.height as usize, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_what_is_decoded() {
        let pixels: Vec<u8> = (0..18).collect();
        let bytes = rgb([3, 2], &pixels, Some(11_811)).unwrap();
        assert_eq!(decoded(&bytes), (3, 2, pixels));
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info();
        let dots = reader.unwrap().info().pixel_dims.unwrap();
        assert_eq!(
            (dots.xppu, dots.yppu, dots.unit),
            (11_811, 11_811, png::Unit::Meter)
        );
    }

    #[test]
    fn absurd_sizes_are_refused() {
        assert!(checked([1 << 20, 1 << 20]).is_err());
        assert!(checked([usize::MAX, 2]).is_err());
    }
}
