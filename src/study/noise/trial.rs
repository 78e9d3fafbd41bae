//! One recovery from one noisy Φcam, and the lines of text that it is kept as.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use crate::metrics::{correlation, light_and_dark, mtf_normalized, mtf_raw, rmse};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Problem, Uncertainty, recover};

use super::stage::Photographs;

/// What one method made of one draw of the noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Checks a side of the object.
    pub board: usize,
    /// Elements a side of the recovery.
    pub elements: usize,
    /// The method.
    pub method: Method,
    /// Level of the noise.
    pub level: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// The measures, or why the method gave nothing.
    pub outcome: Result<Measures, String>,
}

/// How far a recovery is from the truth; absent where a measure is not defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// (White − Black)/(White + Black) of the recovered values.
    pub mtf_raw: Option<f64>,
    /// White + Black, its denominator.
    pub light_plus_dark: Option<f64>,
    /// The same after the recovered values have been stretched to [0, 1].
    pub mtf_normalized: Option<f64>,
    /// Pearson's correlation with the truth.
    pub correlation: Option<f64>,
    /// Root mean square error.
    pub rmse: Option<f64>,
}

/// Recovers and measures.
pub(super) fn measure(
    model: &MatrixModel,
    photographs: &Photographs,
    method: Method,
) -> Result<Measures, String> {
    let Photographs { phi, stderr } = photographs;
    // The reflectances alone are measured.
    let options = Options {
        uncertainty: Uncertainty::StandardError,
        ..Options::default()
    };
    let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
    let found = Problem::new(phi, &model.camera_side, &model.laser_side, Some(stderr))
        .and_then(|problem| problem.with_grids(&grids))
        .and_then(|problem| recover(method, &problem, &options))
        .map_err(|e| e.to_string())?;
    Ok(measures(found.reflectance.as_slice(), &model.albedo))
}

/// How far recovered values are from the true ones.
pub(in super::super) fn measures(found: &[f64], truth: &[f64]) -> Measures {
    Measures {
        mtf_raw: mtf_raw(found, truth),
        light_plus_dark: light_and_dark(found, truth).map(|(light, dark)| light + dark),
        mtf_normalized: mtf_normalized(found, truth),
        correlation: correlation(found, truth),
        rmse: rmse(found, truth),
    }
}

impl Trial {
    /// By object, elements, method, level and seed.
    pub fn order(&self, other: &Self) -> Ordering {
        let place = |t: &Self| {
            (
                t.board,
                t.elements,
                Method::ALL.iter().position(|m| *m == t.method),
            )
        };
        place(self)
            .cmp(&place(other))
            .then(self.level.total_cmp(&other.level))
            .then(self.seed.cmp(&other.seed))
    }
}
