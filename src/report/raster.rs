//! A drawing's SVG as PNG: the one door to the crates `resvg` (the renderer) and `dejavu` (its
//! type).
//!
//! The type is DejaVu Sans 2.37 (licence of Bitstream Vera, changes in the public domain): it has
//! every letter, sign and index that the figures write, and its widths are those of Verdana, which
//! the SVG names next, so that text takes the same room in a viewer that has the one or the other.
//! Neither the fonts nor the settings of the machine enter: the same SVG makes the same bytes.

use std::sync::{Arc, OnceLock};

use resvg::{tiny_skia, usvg};

use super::encode::{PictureError, checked, rgb};
use super::svg::DPI;

/// [`DPI`] in metres.
const PIXELS_PER_METRE: u32 = 11_811;

/// The two weights that figures use, as [`FAMILIES`](super::svg::FAMILIES) names them first.
fn fonts() -> Arc<usvg::fontdb::Database> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut fonts = usvg::fontdb::Database::new();
        for face in [dejavu::sans::regular(), dejavu::sans::bold()] {
            fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(face)));
        }
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    };
    Arc::clone(FONTS.get_or_init(load))
}

/// The drawing on white at [`DPI`] pixels for each inch of its stated width and height, as PNG
/// bytes.
///
/// # Errors
/// [`PictureError`].
pub(super) fn png(svg: &str) -> Result<Vec<u8>, PictureError> {
    let options = usvg::Options {
        dpi: DPI as f32,
        font_family: "DejaVu Sans".to_owned(),
        fontdb: fonts(),
        ..usvg::Options::default()
    };
    let tree =
        usvg::Tree::from_str(svg, &options).map_err(|e| PictureError::Drawing(e.to_string()))?;
    let stated = tree.size();
    let size = [stated.width(), stated.height()].map(|x| x.round().max(1.0) as usize);
    let [w, h] = checked(size)?;
    let Some(mut pixels) = tiny_skia::Pixmap::new(w, h) else {
        return Err(PictureError::TooLarge(size[0], size[1]));
    };
    pixels.fill(tiny_skia::Color::WHITE);
    let whole =
        tiny_skia::Transform::from_scale(w as f32 / stated.width(), h as f32 / stated.height());
    resvg::render(&tree, whole, &mut pixels.as_mut());
    // Opaque throughout, so colours are those stored.
    let colours: Vec<u8> = pixels
        .pixels()
        .iter()
        .flat_map(|p| [p.red(), p.green(), p.blue()])
        .collect();
    rgb(size, &colours, Some(PIXELS_PER_METRE))
}

#[cfg(test)]
mod tests {
    use super::super::encode::decoded;
    use super::super::svg::FAMILIES;
    use super::*;

    fn sheet(content: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"25.4mm\" height=\"12.7mm\" viewBox=\"0 0 100 50\" font-family=\"{FAMILIES}\">{content}</svg>"
        )
    }

    /// An inch by half an inch at 300 an inch; a rectangle covers the pixels that its coordinates
    /// say.
    #[test]
    fn millimetres_become_pixels() {
        let (w, h, pixels) = decoded(
            &png(&sheet(
                "<rect x=\"50\" width=\"50\" height=\"25\" fill=\"#0072b2\"/>",
            ))
            .unwrap(),
        );
        assert_eq!((w, h), (300, 150));
        for (i, pixel) in pixels.chunks(3).enumerate() {
            let inside = i % w >= 150 && i / w < 75;
            assert_eq!(
                pixel,
                if inside { [0x00, 0x72, 0xb2] } else { [255; 3] },
                "{i}"
            );
        }
    }

    /// Every sign of the figures has a glyph of its own: each leaves ink, and no two the same (a
    /// missing one would be a box).
    #[test]
    fn every_sign_has_its_own_glyph() {
        let signs = "µ×²⁻⁺¹‖Φρσ–—−→↑∓±≤≥∘·Σᵀ≈√∞⊘°…";
        let drawn: Vec<Vec<u8>> = signs
            .chars()
            .map(|c| {
                png(&sheet(&format!(
                    "<text x=\"20\" y=\"40\" font-size=\"40\">{c}</text>"
                )))
                .unwrap()
            })
            .collect();
        let empty = png(&sheet("")).unwrap();
        for (i, a) in drawn.iter().enumerate() {
            assert_ne!(*a, empty, "{:?}", signs.chars().nth(i));
            assert!(
                drawn[..i].iter().all(|b| a != b),
                "{:?}",
                signs.chars().nth(i)
            );
        }
    }

    #[test]
    fn the_same_drawing_makes_the_same_bytes_and_markup_that_is_none_an_error() {
        let text = sheet("<text x=\"5\" y=\"20\">Φ = 10</text>");
        assert_eq!(png(&text).unwrap(), png(&text).unwrap());
        assert!(matches!(png("<svg"), Err(PictureError::Drawing(_))));
    }
}
