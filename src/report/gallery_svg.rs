//! Pictures of a finding on one sheet.

use super::axis::step;
use super::colour::Scale;
use super::encode::PictureError;
use super::panel::{Panel, ScaleBar};
use super::picture::pictures_svg;
use crate::lab::finding::{Gallery, Picture, Shades};

/// A gallery as SVG, its pictures on one scale of shades.
///
/// # Errors
/// [`PictureError`].
pub fn gallery_svg(gallery: &Gallery) -> Result<String, PictureError> {
    let panel = |p: &Picture| Panel {
        title: p.title.clone(),
        size: p.size,
        values: p.values.clone(),
        axes: p.axes.clone(),
        scale_bar: Some(scale_bar(p.width)),
    };
    let panels: Vec<Panel> = gallery.pictures.iter().map(panel).collect();
    let (scale, unit) = match gallery.shades {
        Shades::Reflectance => (Scale::reflectance(), "reflectance, stretched"),
        Shades::Values => (
            Scale::sequential(gallery.pictures.iter().flat_map(|p| &p.values)),
            gallery.unit.as_str(),
        ),
    };
    pictures_svg(&gallery.title, &panels, &scale, unit)
}

/// A quarter of the width, or what is round below it.
fn scale_bar(width: f64) -> ScaleBar {
    let length = step(width, 4).map_or(width, |next| {
        if next > 0.35 * width {
            0.5 * next
        } else {
            next
        }
    });
    ScaleBar {
        share: length / width,
        text: format!("{length} in."),
    }
}
