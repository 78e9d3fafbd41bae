//! How the study of wall BRDFs is done, and what it finds.

use serde::{Deserialize, Serialize};

use crate::lab::comparison::agreement::Agreement;
use crate::lab::ensemble::Spread;
use crate::recovery::Method;

/// How the study is done.
#[derive(Clone, Debug)]
pub struct BrdfPlan {
    /// Points between the walls, of each of the two renders.
    pub samples: u64,
    /// Seed of the tracer and first one of the noise.
    pub seed: u64,
    /// Probability of rejecting a right model.
    pub significance: f64,
    /// Standard deviations of the entries of Φcam, relative to each.
    pub noise: Vec<f64>,
    /// Recovery methods.
    pub methods: Vec<Method>,
    /// Draws of the noise.
    pub draws: u64,
}

/// How good a recovery is, over draws of the noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Method.
    pub method: String,
    /// Relative noise.
    pub noise: f64,
    /// Raw MTF, where there is black and white.
    pub mtf_raw: Option<Spread>,
    /// Correlation with the truth, where both vary.
    pub correlation: Option<Spread>,
    /// Root mean square error of the reflectances.
    pub rmse: Option<Spread>,
    /// Draws from which the method gave nothing.
    pub failed: usize,
    /// What it said to the last of them.
    pub reason: Option<String>,
}

/// What becomes of one assumption about the wall.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Assumption {
    /// What is assumed, in words.
    pub name: String,
    /// Factor of the whole model: 1 but where the best single one is fitted.
    pub scale: f64,
    /// The model's integral against the traced light.
    pub agreement: Agreement,
    /// Recoveries by the model's matrices: methods, then levels of noise.
    pub qualities: Vec<Quality>,
}

/// Recovery with the known BRDF over recovery of the Lambertian case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Method.
    pub method: String,
    /// Relative noise.
    pub noise: f64,
    /// Of the mean raw MTFs.
    pub mtf_raw: Option<f64>,
    /// Of the mean correlations.
    pub correlation: Option<f64>,
    /// Of the mean RMSEs; below 1 the known BRDF does better.
    pub rmse: Option<f64>,
    /// Whether raw MTF and correlation reach 90 % of the Lambertian case's, and the RMSE exceeds it
    /// by 10 % at most; absent where the Lambertian case itself correlates with the truth by less
    /// than 0.5.
    pub reaches: Option<bool>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct BrdfStudy {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Estimator of the traced light.
    pub estimator: String,
    /// Paths per pixel, or points.
    pub samples: u64,
    /// Seed.
    pub seed: u64,
    /// Draws of the noise.
    pub draws: u64,
    /// White-sky albedo of each relay surface at the mean of its texture: what a Lambertian wall of
    /// equal albedo has.
    pub relay_albedo: Vec<f64>,
    /// The wall's own BRDF first.
    pub assumptions: Vec<Assumption>,
    /// The Lambertian case: its own light, its own model.
    pub lambertian_case: Assumption,
    /// The first assumption over the Lambertian case.
    pub ratios: Vec<Ratio>,
}

impl BrdfStudy {
    /// The assumption that is true: the wall's own BRDF.
    pub fn known(&self) -> &Assumption {
        &self.assumptions[0]
    }

    /// Every assumption, the Lambertian case last.
    pub(super) fn rows(&self) -> impl Iterator<Item = &Assumption> {
        self.assumptions.iter().chain([&self.lambertian_case])
    }
}
