//! The published study computed again, as files: table, figure, pictures and the page that puts them together.

mod page;
mod raster;
mod sheet;

use super::canvas::PictureError;
use super::colour::Scale;
use super::picture::{Panel, colour_png, grey_png};
use crate::study::reproduce::{Cell, Gallery, Reproduction, Shades};

pub use page::{ItemSummary, reproduction_html, reproduction_markdown, reproduction_table};

/// The files of an item: name and bytes. `ITEM.csv`; where it has plots `ITEM.svg` and `ITEM.png`; for its pictures `ITEM-images.png`, further ones numbered.
///
/// # Errors
/// [`PictureError`].
pub fn reproduction_files(r: &Reproduction) -> Result<Vec<(String, Vec<u8>)>, PictureError> {
    let name = r.item.name();
    let mut files = vec![(format!("{name}.csv"), csv(r).into_bytes())];
    if !r.plots.is_empty() {
        files.push((format!("{name}.svg"), sheet::svg(r).into_bytes()));
        files.push((format!("{name}.png"), raster::png(r)?));
    }
    for (i, gallery) in r.galleries.iter().enumerate() {
        let number = if i == 0 {
            String::new()
        } else {
            format!("-{}", i + 1)
        };
        files.push((format!("{name}-images{number}.png"), pictures(gallery)?));
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

fn pictures(gallery: &Gallery) -> Result<Vec<u8>, PictureError> {
    let panel = |p: &crate::study::reproduce::Picture| Panel {
        title: p.title.clone(),
        size: p.size,
        values: p.values.clone(),
        axes: p.axes.map(str::to_owned),
    };
    let panels: Vec<Panel> = gallery.pictures.iter().map(panel).collect();
    match gallery.shades {
        Shades::Reflectance => grey_png(&gallery.title, &panels),
        Shades::Values => {
            let scale = Scale::sequential(gallery.pictures.iter().flat_map(|p| &p.values));
            colour_png(&gallery.title, &panels, &scale, gallery.unit)
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
