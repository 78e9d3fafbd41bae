//! Parameters of a scene, and what each deviates by.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::picture::ElementLight;
use crate::matrix::Matrix;

/// A parameter of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// What may be off.
    pub name: String,
    /// Unit of its deviation.
    pub unit: String,
    /// The largest deviation that a scene can have, if there is one: what is fitted beyond is no
    /// cause.
    pub reach: Option<f64>,
    /// What else has the same derivative up to a factor: its name, and its deviation per deviation
    /// of this parameter, in the same unit.
    pub same: Vec<(String, f64)>,
    /// Its name for one spot, if every spot has its own such parameter, whose derivative is its
    /// column of this one's.
    pub each_spot: Option<String>,
}

/// A model's parameters and derivatives.
pub struct Derivatives<'a> {
    /// The parameters.
    pub parameters: &'a [Parameter],
    /// ∂Φ/∂θ of a parameter, pixels × spots, W per unit; `None` where the scene does not allow it.
    pub of: &'a (dyn Fn(usize) -> Option<Matrix> + Sync),
    /// Φ(θ) − Φ(0) and ∂Φ/∂θ at θ of a parameter, W and W per unit; `None` where only the
    /// derivative at 0 is known.
    pub moved: &'a (dyn Fn(usize, f64) -> Option<[Matrix; 2]> + Sync),
    /// Whether light bends where the scene moves: an albedo of the walls steps, and is met by the
    /// edges of pixels.
    pub bends: bool,
    /// Light of the elements, where the picture is not known.
    pub picture: Option<&'a (dyn Fn() -> Option<Arc<ElementLight>> + Sync)>,
    /// Whether causes are looked for, and what χ² each leaves: that takes many times as long as the
    /// test. Where not, χ² is NaN.
    pub are_named: bool,
}

/// A parameter fitted alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Deviation {
    /// What was fitted.
    pub name: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Scene less model.
    pub value: f64,
    /// Standard error of that.
    pub stderr: f64,
    /// What the model's own bound may add to or take off it.
    pub bias: f64,
    /// Standard normal deviate of value/stderr, the bias taken off.
    pub z: f64,
    /// Probability of one as large among its family (Šidák).
    pub p: f64,
    /// Smallest deviation that the score test rejects 95 times in 100, whatever its sign.
    pub detectable: f64,
    /// The largest that a scene can have, if there is one.
    #[serde(default)]
    pub reach: Option<f64>,
    /// χ²/dof that remains with it fitted.
    pub chi2_per_dof: f64,
    /// What cannot be told from it by any light, with its deviation for this one.
    pub same: Vec<(String, f64)>,
    /// The spot, of a parameter of one spot.
    pub spot: Option<usize>,
    /// Whether the value is where the bent model leaves the least, not its first step.
    #[serde(default)]
    pub is_followed: bool,
}

impl Deviation {
    /// Whether a scene can have it of this size.
    pub(in crate::lab) fn is_within_reach(&self, size: f64) -> bool {
        self.reach.is_none_or(|reach| size.abs() <= reach)
    }
}
