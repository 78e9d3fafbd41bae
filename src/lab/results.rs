//! Plain results: what a run found, ready to be written in any form.

use serde::{Deserialize, Serialize};

use super::gallery::Gallery;
use crate::matrix::Matrix;
use crate::recovery::Picard;
use crate::scene::Scene;
use crate::transport::Plan;

/// One entry of Φcam, traced and modelled.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// Traced flux, W.
    pub traced: f64,
    /// Modelled flux, W.
    pub modelled: f64,
    /// Standard normal deviate of the difference.
    pub z: f64,
}

/// Traced against modelled Φcam.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Agreement {
    /// Whether both tests pass at the significance level.
    pub agrees: bool,
    /// `physical` or `published`.
    pub kernel: String,
    /// How the model integrates: `centres` or `quadrature`.
    pub integration: String,
    /// Family-wise error rate of the verdict.
    pub significance: f64,
    /// Entries compared.
    pub entries: usize,
    /// Mean of z² over the entries: 1 on average if the model is right.
    pub chi2_per_dof: f64,
    /// Independent degrees of freedom of that mean.
    pub dof: f64,
    /// Its upper tail probability.
    pub chi2_p: f64,
    /// Largest |z|.
    pub largest_z: f64,
    /// Largest |z| that the significance level allows for this many entries (Šidák).
    pub z_limit: f64,
    /// Probability of a |z| as large among all entries (Šidák).
    pub largest_p: f64,
    /// Relative Frobenius difference ‖traced − modelled‖/‖modelled‖.
    pub relative_difference: f64,
    /// What the traced standard error alone makes of that: ‖stderr‖/‖modelled‖.
    pub relative_noise: f64,
    /// Discretisation bound of the model, relative Frobenius norm.
    pub relative_discretisation: f64,
    /// Best single scale of the model: traced ≈ scale · modelled.
    pub best_scale: f64,
    /// The entries with the largest |z|.
    pub worst: Vec<Entry>,
}

/// A recovered hidden surface.
#[derive(Clone, Debug, Serialize)]
pub struct RecoveredObject {
    /// Name of the hidden surface.
    pub surface: String,
    /// Method.
    pub method: String,
    /// Elements along u and v.
    pub elements: [usize; 2],
    /// Recovered reflectance of element iu + iv·nu.
    pub reflectance: Vec<f64>,
    /// True albedo of the elements.
    pub truth: Vec<f64>,
    /// (White − Black)/(White + Black); absent if the truth has no contrast.
    pub mtf_raw: Option<f64>,
    /// The same after stretching the recovered values to [0, 1].
    pub mtf_normalized: Option<f64>,
    /// Pearson correlation with the truth.
    pub correlation: Option<f64>,
    /// Root mean square error against the truth.
    pub rmse: f64,
    /// Parameter used and why, in words.
    pub parameter: String,
    /// Bands around the reflectances, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<ObjectBands>,
    /// Standard error of each reflectance; absent without a noise model and under bounds.
    pub standard_error: Option<Vec<f64>>,
    /// What regularisation alone adds to the truth, (R − 1) ρ with ρ the scene's; absent under
    /// bounds and with a free scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<Vec<f64>>,
    /// Directions that the method resolves: trace of its resolution matrix.
    pub effective_rank: f64,
    /// Covariance of its elements (rows) with those of all hidden surfaces (columns, in file
    /// order).
    #[serde(skip)]
    pub covariance: Option<Matrix>,
    /// Its rows of the resolution matrix: what each of its elements shows of the elements of all
    /// hidden surfaces.
    #[serde(skip)]
    pub resolution: Option<Matrix>,
}

/// Intervals of the elements of a recovered surface.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectBands {
    /// Probability that each alone shall cover.
    pub confidence: f64,
    /// What they are: `gaussian`, `gaussian-around-mean` (the bias is left out) or `profile`.
    pub kind: String,
    /// Lower limits.
    pub lower: Vec<f64>,
    /// Upper limits.
    pub upper: Vec<f64>,
}

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
    pub gallery: Option<Gallery>,
    /// Wall time of each stage, s.
    pub times: Vec<(String, f64)>,
}
