//! What the study of layouts is to do.

use super::prior::Prior;
use super::unsure::Unsure;
use crate::lab::uncertainty::noise_law::NoiseLaw;

/// What is studied.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub count: usize,
    /// Along the longer side of the wall.
    pub candidates: usize,
    pub noise: NoiseLaw,
    pub level: f64,
    pub prior: Prior,
    pub margin: f64,
    pub apart: f64,
    pub refine: usize,
    pub boards: Vec<usize>,
    pub draws: u64,
    pub elements: Option<usize>,
    pub seed: u64,
    pub unsure: Vec<Unsure>,
    /// Whether there is a row with the whole wall in view.
    pub wall_in_view: bool,
}
