//! Which deviation of the scene explains the difference? Rao's score test on the model's
//! derivatives, a parameter at a time.
//!
//! Each is fitted as a [`Residual`] says, and its θ̂ over its error tested.
//!
//! Where other light or the scale was fitted first ([`Eliminated`](super::eliminated::Eliminated)),
//! d is what that leaves of ∂model/∂θ.

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::evidence::{Evidence, Test};
use super::residual::{Residual, Weights};
use crate::matrix::Matrix;
use crate::num::statistics::{normal_two_sided, sidak_p, sidak_threshold};

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
    /// Smallest deviation that the score test rejects 95 times in 100.
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
}

impl Deviation {
    /// Whether a scene can have it of this size.
    pub(super) fn is_within_reach(&self, size: f64) -> bool {
        self.reach.is_none_or(|reach| size.abs() <= reach)
    }
}

/// All parameters, each fitted alone.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Score {
    /// |z| that the parameters of the scene may have, and those of single spots.
    pub limits: [f64; 2],
    /// Parameters of the scene.
    pub deviations: Vec<Deviation>,
    /// Parameters of single spots.
    pub spots: Vec<Deviation>,
    /// The most likely cause first: of the parameters beyond their limits, and within what a scene
    /// can have, the one that leaves the least χ². Then all that explain the difference as well,
    /// after whose fit the first is not missed at 1 %.
    pub likely: Vec<Deviation>,
    /// Parameters that change nothing or that the scene does not allow.
    pub untested: Vec<String>,
    /// Whether all were fitted as if shadows stayed where they are: those of spheres, meshes and on
    /// curved surfaces are not followed.
    #[serde(default)]
    pub shadows_stay: bool,
}

impl Score {
    /// Whether a parameter is beyond its limit.
    pub fn rejects(&self) -> bool {
        self.all().any(|d| self.is_beyond(d))
    }

    fn all(&self) -> impl Iterator<Item = &Deviation> {
        self.deviations.iter().chain(&self.spots)
    }

    fn is_beyond(&self, d: &Deviation) -> bool {
        d.z.abs() > self.limits[usize::from(d.spot.is_some())]
    }
}

/// Share of the significance level of each family: the scene's parameters, and the spots'.
const FAMILIES: f64 = 0.5;
/// Level at which a cause is told from the most likely one.
const TOLD_APART: f64 = 0.01;

/// χ²/dof of the entries after a deviation: of the model `model + θ·d` in the columns `columns`.
pub(super) type Remaining<'a> = &'a (dyn Fn(f64, &Matrix, &Range<usize>) -> f64 + Sync);

/// Fits every parameter, at `significance` for all together.
pub(super) fn score(
    evidence: Evidence<'_>,
    test: Test,
    significance: f64,
    derivatives: &Derivatives<'_>,
    remaining: Remaining<'_>,
) -> Score {
    let residual = Residual::new(evidence, test, Weights::Smoothed);
    let spots = evidence.model.ncols();
    let parameters = derivatives.parameters;
    let single = parameters.iter().filter(|p| p.each_spot.is_some()).count() * spots;
    let share = [FAMILIES, 1.0 - FAMILIES].map(|f| f * significance);
    let mut found = Score {
        limits: [
            sidak_threshold(share[0], parameters.len() as u64),
            sidak_threshold(share[1], single as u64),
        ],
        ..Score::default()
    };
    let of: Vec<Option<Matrix>> = (0..parameters.len()).map(|k| (derivatives.of)(k)).collect();
    for (parameter, d) in parameters.iter().zip(&of) {
        let fit = |spot: Option<usize>, limit: f64, family: usize, name: &str| {
            let (d, columns) = left_of(&evidence, d.as_ref()?, spot)?;
            let fit = residual.fit(&d, &columns)?;
            Some(Deviation {
                name: name.to_owned(),
                unit: parameter.unit.clone(),
                value: fit.value,
                stderr: fit.stderr,
                bias: fit.bias,
                z: fit.z(),
                p: sidak_p(normal_two_sided(fit.z()), family as u64),
                detectable: fit.detectable(limit),
                reach: parameter.reach,
                chi2_per_dof: remaining(fit.value, &d, &columns),
                same: parameter.same.clone(),
                spot,
            })
        };
        match fit(None, found.limits[0], parameters.len(), &parameter.name) {
            Some(deviation) => found.deviations.push(deviation),
            None => found.untested.push(parameter.name.clone()),
        }
        for (spot, name) in (0..spots).filter_map(|l| Some((l, parameter.each_spot.as_ref()?))) {
            let own = fit(Some(spot), found.limits[1], single, name);
            found.spots.extend(own);
        }
    }
    found.likely = likely(&found, &residual, parameters, &of);
    found
}

/// The most likely cause, of those beyond their limit the one that leaves the least χ², and those
/// that explain the difference as well.
fn likely(
    found: &Score,
    residual: &Residual<'_>,
    parameters: &[Parameter],
    derivatives: &[Option<Matrix>],
) -> Vec<Deviation> {
    let of = |d: &Deviation| {
        parameters.iter().position(|p| match d.spot {
            None => p.name == d.name,
            Some(_) => p.each_spot.as_ref() == Some(&d.name),
        })
    };
    let can_be = |d: &&Deviation| d.is_within_reach(d.value);
    let all = || found.all().filter(can_be);
    let beyond = |d: &&Deviation| found.is_beyond(d);
    let least = |a: &&Deviation, b: &&Deviation| a.chi2_per_dof.total_cmp(&b.chi2_per_dof);
    let Some(best) = all().filter(beyond).min_by(least) else {
        return Vec::new();
    };
    let derivative =
        |d: &Deviation| whole(&residual.evidence, derivatives[of(d)?].as_ref()?, d.spot);
    let Some(first) = derivative(best) else {
        return vec![best.clone()];
    };
    let limit = sidak_threshold(TOLD_APART, all().count() as u64);
    let as_good = |other: &&Deviation| {
        let same = other.name == best.name && other.spot == best.spot;
        let missed = |own: Matrix| residual.missed(&first, &own);
        !same && derivative(other).is_some_and(|own| missed(own).abs() <= limit)
    };
    let mut rest: Vec<&Deviation> = all().filter(as_good).collect();
    rest.sort_by(least);
    std::iter::once(best).chain(rest).cloned().collect()
}

/// What is fitted of a derivative, and the spots where it is not 0; none if what was fitted first
/// leaves nothing of it.
fn left_of<'a>(
    evidence: &Evidence<'_>,
    d: &'a Matrix,
    spot: Option<usize>,
) -> Option<(Cow<'a, Matrix>, Range<usize>)> {
    let all = 0..d.ncols();
    match evidence.eliminated {
        None => Some((Cow::Borrowed(d), spot.map_or(all, |l| l..l + 1))),
        Some(_) => Some((Cow::Owned(whole(evidence, d, spot)?), all)),
    }
}

/// The same with all spots.
fn whole(evidence: &Evidence<'_>, d: &Matrix, spot: Option<usize>) -> Option<Matrix> {
    let own = of_spot(d, spot);
    match evidence.eliminated {
        None => Some(own),
        Some(terms) => terms.left_of(&own),
    }
}

/// The derivative by a parameter of one spot.
fn of_spot(d: &Matrix, spot: Option<usize>) -> Matrix {
    match spot {
        None => d.clone(),
        Some(l) => {
            let mut own = Matrix::zeros(d.nrows(), d.ncols());
            own.set_column(l, &d.column(l));
            own
        }
    }
}
