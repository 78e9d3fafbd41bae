//! Floor 7: the report. Results in, bytes out: nothing here computes physics, prints or touches the
//! file system.
//!
//! [`bench_svg`] draws a scene to scale; [`grey_png`] and [`colour_png`] turn matrices into
//! pictures with a legend; every PNG of a figure is its SVG, rendered with type of its own;
//! [`finding_text`], [`finding_csv`], [`figure_svg`] and [`finding_html`] lay out what was found,
//! and [`run_html`] shows a run on one self-contained page each, below 10 MB: of Φcam lies in the
//! page what fits, first with fewer bits, then with fewer spots, and the page says so;
//! `phicam serve` reads every entry from the files. A page is put together in `page`, whose script
//! makes it answer. Pages and PNGs of figures belong to the feature `cli`. Pictures clip at the
//! ends of their scale and say so; numbers are never clipped.

// What pages alone use is dead without them.
#![cfg_attr(not(feature = "cli"), allow(dead_code))]

mod axis;
mod cells;
mod colour;
mod csv;
mod drawing;
mod encode;
mod exposure;
mod figure;
mod files;
#[cfg(feature = "cli")]
mod gallery;
mod gallery_svg;
#[cfg(feature = "cli")]
mod html;
mod hull;
#[cfg(feature = "cli")]
mod invocation;
mod key;
mod label;
mod legend;
mod look;
mod mark;
mod mitsuba;
#[cfg(feature = "cli")]
mod page;
mod panel;
mod photograph;
mod picture;
mod plot;
mod plotted;
mod preview;
mod projection;
#[cfg(feature = "cli")]
mod raster;
mod relief;
#[cfg(feature = "cli")]
mod reproduce;
#[cfg(feature = "cli")]
mod run;
#[cfg(feature = "cli")]
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
#[cfg(feature = "cli")]
pub use html::finding_html;
#[cfg(feature = "cli")]
pub use invocation::Invocation;
pub use mitsuba::{MitsubaError, mitsuba_script};
#[cfg(feature = "cli")]
pub use page::meaning;
pub use panel::{Panel, ScaleBar};
pub use photograph::{Marked, photograph_png};
#[cfg(feature = "cli")]
pub use picture::{colour_png, grey_png};
pub use plot::figure_svg;
pub use preview::preview_png;
pub use relief::{recovered_ply, texture_png};
#[cfg(feature = "cli")]
pub use reproduce::{
    ReproductionSettings, reproduction_files, reproduction_html, reproduction_markdown,
};
#[cfg(feature = "cli")]
pub use run::{run_html, served_html};
#[cfg(feature = "cli")]
pub use shown::Shown;
pub use summary::summary_json;
pub use target::target_png;
pub use terminal::{iterm, kitty};
pub use text::finding_text;
