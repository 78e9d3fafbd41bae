//! Floor 7: the report. Results in, bytes out: nothing here computes physics, prints or touches the
//! file system.
//!
//! [`bench_svg`] draws a scene to scale; [`grey_png`] and [`colour_png`] turn matrices into
//! pictures with a legend; every PNG of a figure is its SVG, rendered with type of its own;
//! [`finding_text`], [`finding_csv`], [`figure_svg`] and [`finding_html`] lay out what was found,
//! and [`run_html`] shows a run on one self-contained page each, below 10 MB: of Φcam lies in the
//! page what fits, first with fewer bits, then with fewer spots, and the page says so;
//! `phicam serve` reads every entry from the files. A page is put together in `page`, whose script
//! makes it answer. Pictures clip at the ends of their scale and say so; numbers are never clipped.

mod axis;
mod cells;
mod colour;
mod csv;
mod drawing;
mod encode;
mod exposure;
mod figure;
mod files;
mod gallery;
mod gallery_svg;
mod harmless;
mod html;
mod hull;
mod invocation;
mod key;
mod label;
mod legend;
mod look;
mod mark;
mod mitsuba;
mod page;
mod panel;
mod photograph;
mod picture;
mod plot;
mod plotted;
mod preview;
mod projection;
mod raster;
mod relief;
mod reproduce;
mod run;
mod shown;
mod summary;
mod svg;
mod target;
mod terminal;
mod text;

pub use colour::{Law, Map, Rgb, Scale};
pub use csv::finding_csv;
pub use drawing::bench_svg;
pub use encode::PictureError;
pub use exposure::counts_png;
pub use files::finding_files;
pub use gallery_svg::gallery_svg;
pub use harmless::{harmless, harmless_json};
pub use html::finding_html;
pub use invocation::Invocation;
pub use mitsuba::{MitsubaError, mitsuba_script};
pub use panel::{Panel, ScaleBar};
pub use photograph::{Marked, photograph_png};
pub use picture::{colour_png, grey_png};
pub use plot::figure_svg;
pub use preview::preview_png;
pub use relief::{recovered_ply, texture_png};
pub use reproduce::{
    ReproductionSettings, reproduction_files, reproduction_html, reproduction_markdown,
};
pub use run::{run_html, served_html};
pub use shown::Shown;
pub use summary::summary_json;
pub use target::target_png;
pub use terminal::{iterm, kitty};
pub use text::finding_text;
