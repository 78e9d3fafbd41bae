//! A raster to draw on, and its PNG bytes: the one door to the crates `embedded-graphics` and `png`.

use std::convert::Infallible;

use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, iso_8859_1, iso_8859_7};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::{Circle, Line, PrimitiveStyle, Rectangle, Triangle};
use embedded_graphics::text::{Baseline, Text};

use super::colour::Rgb;

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
}

/// Pixels, row by row from the top, 8 bits sRGB.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

/// Sizes of type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    /// 7 × 13 px.
    Small,
    /// 10 × 20 px.
    Large,
}

impl Type {
    /// Width and height of a character, px.
    pub(super) fn character(self) -> [usize; 2] {
        match self {
            Self::Small => [7, 13],
            Self::Large => [10, 20],
        }
    }

    fn fonts(self) -> [&'static MonoFont<'static>; 2] {
        match self {
            Self::Small => [&iso_8859_1::FONT_7X13, &iso_8859_7::FONT_7X13],
            Self::Large => [&iso_8859_1::FONT_10X20, &iso_8859_7::FONT_10X20],
        }
    }
}

impl Canvas {
    /// A white canvas.
    ///
    /// # Errors
    /// [`PictureError::TooLarge`].
    pub(super) fn new(width: usize, height: usize) -> Result<Self, PictureError> {
        match width.checked_mul(height) {
            Some(n) if n <= 1 << 28 && width < 1 << 24 && height < 1 << 24 => Ok(Self {
                width,
                height,
                pixels: vec![255; 3 * n],
            }),
            _ => Err(PictureError::TooLarge(width, height)),
        }
    }

    /// Fills a rectangle.
    pub(super) fn fill(&mut self, [x, y]: [usize; 2], [w, h]: [usize; 2], [r, g, b]: Rgb) {
        let area = Rectangle::new(
            Point::new(x as i32, y as i32),
            Size::new(w as u32, h as u32),
        );
        let Ok(()) = self.fill_solid(&area, Rgb888::new(r, g, b));
    }

    /// A rectangle's outline, just outside it.
    pub(super) fn outline(&mut self, [x, y]: [usize; 2], [w, h]: [usize; 2]) {
        let area = Rectangle::new(
            Point::new(x as i32 - 1, y as i32 - 1),
            Size::new(w as u32 + 2, h as u32 + 2),
        );
        let style = PrimitiveStyle::with_stroke(Rgb888::new(90, 90, 90), 1);
        let Ok(()) = area.into_styled(style).draw(self);
    }

    /// Lines from point to point.
    pub(super) fn stroke(&mut self, points: &[[usize; 2]], width: u32, [r, g, b]: Rgb) {
        let style = PrimitiveStyle::with_stroke(Rgb888::new(r, g, b), width);
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|[x, y]| Point::new(x as i32, y as i32));
            let Ok(()) = Line::new(from, to).into_styled(style).draw(self);
        }
    }

    /// A filled disc around a point.
    pub(super) fn disc(&mut self, [x, y]: [usize; 2], radius: u32, [r, g, b]: Rgb) {
        let circle = Circle::with_center(Point::new(x as i32, y as i32), 2 * radius + 1);
        let style = PrimitiveStyle::with_fill(Rgb888::new(r, g, b));
        let Ok(()) = circle.into_styled(style).draw(self);
    }

    /// An arrow from `a` to `b`, along an axis.
    pub(super) fn arrow(&mut self, a: [usize; 2], b: [usize; 2]) {
        let [a, b] = [a, b].map(|[x, y]| Point::new(x as i32, y as i32));
        let ink = Rgb888::new(60, 60, 60);
        let Ok(()) = Line::new(a, b)
            .into_styled(PrimitiveStyle::with_stroke(ink, 1))
            .draw(self);
        let way = Point::new((b.x - a.x).signum(), (b.y - a.y).signum());
        let side = Point::new(way.y, way.x);
        let head = Triangle::new(b, b - way * 6 + side * 3, b - way * 6 - side * 3);
        let Ok(()) = head.into_styled(PrimitiveStyle::with_fill(ink)).draw(self);
    }

    /// Writes text with its upper left corner at (x, y). Latin and Greek letters are known, others become `?`.
    pub(super) fn text(&mut self, [x, y]: [usize; 2], size: Type, text: &str) {
        let ink = Rgb888::new(30, 30, 30);
        let mut buffer = [0u8; 4];
        for (i, c) in text.chars().enumerate() {
            let c = match c {
                '−' | '–' | '—' => '-',
                '’' => '\'',
                c if (' '..='~').contains(&c) || ('\u{a0}'..='\u{ff}').contains(&c) => c,
                c if ('\u{384}'..='\u{3ce}').contains(&c) => c,
                _ => '?',
            };
            let font = size.fonts()[usize::from(c > '\u{ff}')];
            let place = Point::new((x + i * size.character()[0]) as i32, y as i32);
            let style = MonoTextStyle::new(font, ink);
            let Ok(_) =
                Text::with_baseline(c.encode_utf8(&mut buffer), place, style, Baseline::Top)
                    .draw(self);
        }
    }

    /// PNG bytes.
    ///
    /// # Errors
    /// [`PictureError::Encoding`].
    pub(super) fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(bytes)
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(p, c) in pixels {
            if let (Ok(x), Ok(y)) = (usize::try_from(p.x), usize::try_from(p.y))
                && x < self.width
                && y < self.height
            {
                let i = 3 * (x + y * self.width);
                self.pixels[i..i + 3].copy_from_slice(&[c.r(), c.g(), c.b()]);
            }
        }
        Ok(())
    }
}

/// A 16-bit grey picture as PNG bytes, `pixels` row by row from the top.
///
/// # Errors
/// [`PictureError`].
pub(super) fn grey16([width, height]: [usize; 2], pixels: &[u16]) -> Result<Vec<u8>, PictureError> {
    let [w, h] = [width, height].map(u32::try_from);
    let (Ok(w), Ok(h)) = (w, h) else {
        return Err(PictureError::TooLarge(width, height));
    };
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
    fn what_is_drawn_is_what_is_decoded() {
        let mut canvas = Canvas::new(40, 30).unwrap();
        canvas.fill([3, 4], [5, 6], [10, 20, 30]);
        canvas.fill([38, 28], [10, 10], [1, 2, 3]);
        canvas.text([0, 12], Type::Small, "Φü−漢");
        let (w, h, pixels) = decoded(&canvas.png().unwrap());
        assert_eq!((w, h), (40, 30));
        let at = |x: usize, y: usize| &pixels[3 * (x + y * w)..][..3];
        assert_eq!(at(3, 4), [10, 20, 30]);
        assert_eq!(at(7, 9), [10, 20, 30]);
        assert_eq!(at(8, 9), [255; 3]);
        assert_eq!(at(39, 29), [1, 2, 3]);
        // Each of the four characters leaves ink in its own cell.
        for i in 0..4 {
            let cell = (0..7).flat_map(|x| (12..25).map(move |y| (7 * i + x, y)));
            assert!(
                cell.into_iter().any(|(x, y)| at(x, y) == [30; 3]),
                "character {i}"
            );
        }
    }

    #[test]
    fn absurd_sizes_are_refused() {
        assert!(Canvas::new(1 << 20, 1 << 20).is_err());
        assert!(Canvas::new(usize::MAX, 2).is_err());
    }
}
