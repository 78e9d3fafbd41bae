//! The published study computed again, as files: table, figure, pictures and the page that puts them together.

mod page;
mod sheet;

use super::axis::step;
use super::colour::Scale;
use super::encode::PictureError;
use super::picture::{Panel, ScaleBar, pictures_svg};
use super::raster;
use crate::study::reproduce::{Cell, Gallery, Picture, Reproduction, Shades};

pub use page::{
    ItemSummary, ReproductionSettings, reproduction_html, reproduction_markdown, reproduction_table,
};

/// The files of an item: name and bytes. `ITEM.csv`; where it has plots `ITEM.svg`; for its pictures `ITEM-images.svg`, further ones numbered. Beside each SVG
/// the PNG that is drawn from it, 300 pixels an inch at the width of one (90 mm) or two (180 mm) columns of a journal.
///
/// # Errors
/// [`PictureError`].
pub fn reproduction_files(r: &Reproduction) -> Result<Vec<(String, Vec<u8>)>, PictureError> {
    let name = r.item.name();
    let mut figures = Vec::new();
    if !r.plots.is_empty() {
        figures.push((name.to_owned(), sheet::svg(r)));
    }
    for (i, gallery) in r.galleries.iter().enumerate() {
        let number = if i == 0 {
            String::new()
        } else {
            format!("-{}", i + 1)
        };
        figures.push((format!("{name}-images{number}"), pictures(gallery)?));
    }
    let mut files = vec![(format!("{name}.csv"), csv(r).into_bytes())];
    for (name, svg) in figures {
        let png = raster::png(&svg)?;
        files.push((format!("{name}.svg"), svg.into_bytes()));
        files.push((format!("{name}.png"), png));
    }
    Ok(files)
}

/// The table as comma-separated values with a header line.
fn csv(r: &Reproduction) -> String {
    let cell = |c: &Cell| match c {
        Cell::Text(text) => format!("\"{}\"", text.replace('"', "'")),
        Cell::Count(n) => n.to_string(),
        Cell::Number(x) => x.map_or(String::new(), |x| format!("{x:e}")),
    };
    let line = |row: &Vec<Cell>| row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
    r.columns.join(",") + "\n" + &r.rows.iter().map(line).collect::<String>()
}

/// A gallery as SVG.
fn pictures(gallery: &Gallery) -> Result<String, PictureError> {
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

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
