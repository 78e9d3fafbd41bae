//! One recovery from one noisy Φcam.

use std::cmp::Ordering;

use super::picture::Picture;
use crate::lab::ensemble::Photographs;
use crate::lab::recovered::measures::Measures;
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Uncertainty};

/// What one method made of one draw of the noise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trial {
    /// The object.
    pub picture: Picture,
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

/// Recovers and measures.
pub(super) fn measure(
    model: &MatrixModel,
    photographs: &Photographs,
    method: Method,
) -> Result<Measures, String> {
    // The reflectances alone are measured.
    let options = Options {
        uncertainty: Uncertainty::StandardError,
        spreads: false,
        ..Options::default()
    };
    let found = photographs
        .recover(model, method, &options)
        .map_err(|e| e.to_string())?;
    Ok(Measures::of(found.reflectance.as_slice(), &model.albedo))
}

impl Trial {
    /// By object, elements, method, level and seed.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let place = |t: &Self| {
            (
                t.picture,
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
