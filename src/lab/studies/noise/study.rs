//! What the study finds.

use serde::Serialize;

use super::axis::NoiseAxis;
use super::best::Best;
use super::curve::NoiseCurve;
use super::picture::Picture;
use super::render::RenderNoise;

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseStudy {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Kernel of data and inversion.
    pub kernel: String,
    /// What was varied.
    #[serde(flatten)]
    pub axis: NoiseAxis,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// One for each object, elements and method.
    pub curves: Vec<NoiseCurve>,
    /// The best method for each object and elements.
    pub best: Vec<Best>,
    /// Which object and elements are the scene's own; none where it was not studied.
    #[serde(skip)]
    pub own: Option<(Picture, usize)>,
    /// Boards that were asked for, and have no place on any of the elements.
    #[serde(skip)]
    pub unplaced: Vec<usize>,
    /// Where the noise of renders lies on the axis, if it was measured.
    pub render_noise: Vec<RenderNoise>,
    /// Every trial as text.
    #[serde(skip)]
    pub ledger: String,
}
