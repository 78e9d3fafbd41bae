//! Where a hidden surface is found to be.

use serde::Serialize;

use super::mistaken::Mistaken;
use super::order::Order;
use crate::lab::geometry::light_left_out::LightLeftOut;
use crate::lab::geometry::resized::Resized;
use crate::lab::recovered::fit::Fit;

/// How likely one size is.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Likelihood {
    /// The size.
    pub size: f64,
    /// ln p(Φ) less that of the likeliest size tried.
    pub log_likelihood: f64,
    /// ‖what is not explained‖/‖what other light leaves‖, weighted.
    pub misfit: f64,
}

/// The middle of the bright part of a picture: of the elements above twice their standard error
/// those of at least half the largest reflectance, weighted by it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bright {
    /// Its place, in the scene's unit.
    pub middle: [f64; 3],
    /// Its standard error: by leaving frames out, and a side of an element over √12, within which
    /// it may lie anywhere; which elements are above their errors is given.
    pub stderr: Option<[f64; 3]>,
    /// The elements.
    pub elements: usize,
    /// Pieces that do not touch each other: the middle of several need not be bright.
    pub pieces: usize,
}

/// The reflectances of one surface, over the largest of all.
#[derive(Clone, Debug, Serialize)]
pub struct Grid {
    /// Its name.
    pub surface: String,
    /// Elements along u and v.
    pub count: [usize; 2],
    /// Element iu + iv·nu.
    pub values: Vec<f64>,
    /// Their standard errors, by leaving frames out.
    pub stderr: Vec<f64>,
}

/// The picture at the likeliest size tried, as smooth as it can be and still predict each frame
/// from the others as well as any.
#[derive(Clone, Debug, Serialize)]
pub struct Picture {
    /// The reflectances.
    pub grids: Vec<Grid>,
    /// Directions of them that are above what is not explained.
    pub directions: usize,
    /// ‖what is not explained‖/‖what other light leaves‖, weighted.
    pub misfit: f64,
    /// The same of each frame as the others predict it.
    pub predicted: f64,
    /// Its bright part.
    pub bright: Option<Bright>,
}

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Located {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// What was looked for.
    pub what: String,
    /// Unit of its sizes.
    pub unit: String,
    /// The likeliest size; none where that is at an end of the range.
    pub size: Option<f64>,
    /// σ_L.
    pub by_curvature: Option<f64>,
    /// σ_J; none of fewer than 3 frames, or where an end was reached without one of them.
    pub by_frames: Option<f64>,
    /// The middle of the first hidden surface at the likeliest size tried.
    pub middle: [f64; 3],
    /// Names of the hidden surfaces, which move as one body.
    pub hidden: Vec<String>,
    /// Sizes tried, growing.
    pub curve: Vec<Likelihood>,
    /// Peaks elsewhere that the photographs do not tell from the likeliest, at 1 %.
    pub elsewhere: Vec<Likelihood>,
    /// ln p(Φ) of the likeliest size tried, up to what is the same in every order of the
    /// photographs.
    pub log_likelihood: f64,
    /// Standard deviation of what is not explained, in units of the stated errors (of Φcam's, W,
    /// where none are stated).
    pub noise: f64,
    /// Elements.
    pub elements: usize,
    /// The picture there; none of fewer than 3 frames.
    pub picture: Option<Picture>,
    /// Whether the photographs belong to their spots.
    pub order: Option<Order>,
    /// An order that is easily mistaken for the right one and in which they are likelier.
    pub mistaken: Option<Mistaken>,
    /// Another size of the hidden surface by which they are much likelier.
    pub resized: Option<Resized>,
    /// Entries that count.
    pub entries: usize,
    /// Frames.
    pub frames: usize,
    /// Whether noise alone explains what is left over; none where no noise is stated.
    pub fit: Option<Fit>,
    /// Kinds of light that the model leaves out, by what is left over; none where errors of entries
    /// hang together, and beside a background.
    pub light_left_out: Vec<LightLeftOut>,
    /// Correlation of what is left of neighbouring pixels beside such light, where it is more than
    /// chance.
    pub neighbours: Option<f64>,
    /// Whether standard errors are stated.
    pub is_noise_known: bool,
    /// Which entries share their errors, where they do (no frame left out shows that), and what
    /// gives each its own.
    pub shared: Option<[&'static str; 2]>,
}

impl Located {
    /// The larger of both errors, if both are known.
    pub fn stderr(&self) -> Option<f64> {
        Some(self.by_curvature?.max(self.by_frames?))
    }
}
