//! Plain results: what a run found, ready to be written in any form.

use crate::lab::comparison::agreement::Agreement;
use crate::lab::recovered::gallery::RunGallery;
use crate::lab::recovered::objects::RecoveredObject;
use crate::matrix::Matrix;
use crate::recovery::Picard;
use crate::scene::Scene;
use crate::transport::Plan;

/// Everything that `phicam run` found.
#[derive(Clone, Debug)]
pub struct RunResults {
    /// The scene.
    pub scene: Scene,
    /// Version of phicam.
    pub version: String,
    /// How it was rendered.
    pub plan: Plan,
    /// Traced Φcam, pixels × spots, W.
    pub phi: Matrix,
    /// Its standard error.
    pub stderr: Matrix,
    /// How far that is to be trusted: codes of [`tails`](crate::transport::tails).
    pub tails: Matrix,
    /// Light that met exactly n surfaces: (n, share of the total flux).
    pub bounces: Vec<(u32, f64)>,
    /// Modelled Φcam; absent where nothing is hidden.
    pub model: Option<Matrix>,
    /// z of every entry, the same shape.
    pub z: Option<Matrix>,
    /// The verdict.
    pub agreement: Option<Agreement>,
    /// Recovered objects, a method after the other.
    pub recovered: Vec<RecoveredObject>,
    /// Signal and noise in the singular directions of what was inverted.
    pub picards: Vec<Picard>,
    /// Recoveries over regularisation and noise; absent where nothing can be recovered.
    pub gallery: Option<RunGallery>,
    /// Wall time of each stage, s.
    pub times: Vec<(String, f64)>,
}
