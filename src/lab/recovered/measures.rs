//! How far a recovery is from the truth.

use serde::{Deserialize, Serialize};

use crate::metrics::{correlation, light_and_dark, mtf_normalized, mtf_raw, rmse};

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

impl Measures {
    /// Of recovered values against the true ones.
    pub(in crate::lab) fn of(found: &[f64], truth: &[f64]) -> Self {
        Self {
            mtf_raw: mtf_raw(found, truth),
            light_plus_dark: light_and_dark(found, truth).map(|(light, dark)| light + dark),
            mtf_normalized: mtf_normalized(found, truth),
            correlation: correlation(found, truth),
            rmse: rmse(found, truth),
        }
    }

    /// All of them, in their order.
    pub(in crate::lab) fn all(&self) -> [Option<f64>; 5] {
        [
            self.mtf_raw,
            self.light_plus_dark,
            self.mtf_normalized,
            self.correlation,
            self.rmse,
        ]
    }
}

/// From all of them, in their order.
impl From<[Option<f64>; 5]> for Measures {
    fn from(
        [mtf_raw, light_plus_dark, mtf_normalized, correlation, rmse]: [Option<f64>; 5],
    ) -> Self {
        Self {
            mtf_raw,
            light_plus_dark,
            mtf_normalized,
            correlation,
            rmse,
        }
    }
}
