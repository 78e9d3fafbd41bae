//! Floor 7: the report. Results in, bytes out: nothing here computes physics, prints or touches the file system.
//!
//! [`bench_svg`] draws a scene to scale; [`grey_png`] and [`colour_png`] turn matrices into pictures with a legend;
//! every PNG of a figure is its SVG, rendered with type of its own;
//! [`summary_json`], [`summary_table`] and their kin say in short what was found, and [`run_html`] and [`study_html`] show it on one
//! self-contained page each, below 10 MB: of Φcam lies in the page what fits, first with fewer bits, then with fewer spots, and the page says so;
//! `phicam serve` reads every entry from the files. A page is put together in `page`, whose script makes it answer. Pictures clip at the ends of their scale and say so; numbers are never clipped.

mod axis;
mod brdf;
mod budget;
mod chart;
mod colour;
mod convergence;
mod coverage;
mod drawing;
mod encode;
mod experiment;
mod exposure;
mod figure;
mod gallery;
mod hull;
mod indicator;
mod key;
mod label;
mod look;
mod mark;
mod mitsuba;
mod noise;
mod page;
mod picard;
mod picture;
mod plotted;
mod portrait;
mod power;
mod projection;
mod raster;
mod relief;
mod reproduce;
mod run;
#[cfg(test)]
mod sample;
mod shown;
mod study;
mod summary;
mod svg;
mod table;
mod target;
mod terminal;
mod tolerance;
mod verdict;

pub use brdf::{brdf_csv, brdf_svg, brdf_table};
pub use budget::{budget_csv, budget_svg, budget_table};
pub use colour::{Law, Map, Rgb, Scale};
pub use convergence::{convergence_svg, convergence_table};
pub use coverage::coverage_table;
pub use drawing::bench_svg;
pub use encode::PictureError;
pub use experiment::{experiment_csv, experiment_svg, experiment_table};
pub use exposure::{counts_png, exposure_table};
pub use indicator::{indicator_csv, indicator_noise_csv, indicator_svg, indicator_table};
pub use mitsuba::{MitsubaError, mitsuba_script};
pub use noise::{Measure, noise_csv, noise_svg, noise_table};
pub use picard::{picard_csv, picard_svg};
pub use picture::{Panel, ScaleBar, colour_png, grey_png};
pub use portrait::portrait_png;
pub use power::power_table;
pub use relief::{recovered_ply, texture_png};
pub use reproduce::{
    ItemSummary, ReproductionSettings, reproduction_files, reproduction_html,
    reproduction_markdown, reproduction_table,
};
pub use run::{run_html, served_html};
pub use shown::Shown;
pub use study::{
    Account, Asked, brdf_account, budget_account, convergence_account, coverage_account,
    experiment_account, indicator_account, noise_account, power_account, study_html,
    tolerance_account,
};
pub use summary::summary_json;
pub use table::{recovery_table, render_table, summary_table, verdict_table};
pub use target::target_png;
pub use terminal::{iterm, kitty};
pub use tolerance::{tolerance_csv, tolerance_svg, tolerance_table};
