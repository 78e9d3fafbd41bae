//! How the error budget is computed, and what it finds.

use serde::Serialize;

use crate::lab::ensemble::Estimate;

/// How the budget is computed.
#[derive(Clone, Copy, Debug)]
pub struct BudgetPlan {
    /// Seed of everything.
    pub seed: u64,
    /// Paths per pixel of the whole ensemble.
    pub ensemble_samples: u64,
    /// Paths per pixel and spot of the run.
    pub run_samples: u64,
}

/// One cause.
#[derive(Clone, Debug, Serialize)]
pub struct Term {
    /// What it is.
    pub name: String,
    /// ‖term‖/‖Φ‖, Φ the three-bounce integral.
    pub size: Estimate,
    /// The same after the best single scale of Φ is taken off: what no calibration removes.
    pub after_scale: Estimate,
    /// ‖term‖ over the object's signal ‖Φ − Φ of the mean albedo‖.
    pub of_signal: f64,
    /// Whether it is part of the sum. What is not would be added by a cruder model or is named for
    /// comparison.
    pub in_sum: bool,
}

/// Whether the parts add up to the total.
#[derive(Clone, Debug, Serialize)]
pub struct Closure {
    /// ‖total‖/‖Φ‖: what a run's frames differ by from the matrix model.
    pub total: Estimate,
    /// ‖sum of the parts‖/‖Φ‖, Monte Carlo noise left out.
    pub sum: Estimate,
    /// ‖total − sum‖/‖Φ‖: noise, if the sum closes.
    pub rest: f64,
    /// What the standard errors say that rest should be.
    pub expected: f64,
    /// (rest² − expected²) in its standard errors, from the scatter over pixels.
    pub z: f64,
    /// |z| ≤ 3.
    pub closes: bool,
}

/// The budget of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorBudget {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Seed.
    pub seed: u64,
    /// Paths per pixel of the ensemble, all members together.
    pub ensemble_samples: u64,
    /// Paths per pixel and spot of the run that is taken apart.
    pub run_samples: u64,
    /// The object's signal, ‖Φ − Φ of the mean albedo‖/‖Φ‖.
    pub signal: f64,
    /// The causes, in the order of the chain.
    pub terms: Vec<Term>,
    /// Whether they add up.
    pub closure: Closure,
}
