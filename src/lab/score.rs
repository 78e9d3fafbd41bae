//! Which deviation of the scene explains the difference? Rao's score test on the model's
//! derivatives, a parameter at a time.
//!
//! With r = traced − model, d = ∂model/∂θ and fixed weights w the fitted deviation and its variance
//! are
//!
//! > θ̂ = Σ w d r / G, G = Σ w d², Var θ̂ = Var(Σ w d r) / G².
//!
//! The weights are 1/σ² of a variance smoothed over pixels and spots (its logarithm a sum of a term
//! by pixel and one by spot), so that an entry that is noisy by chance does not set its own weight;
//! the variance of Σ w d r is then estimated from what each [`Errors`] leaves independent:
//!
//! * `Independent`: Σ (w d s)², s the stated standard errors;
//! * `WithinRows`: from the scatter of the pixels' sums around their fit, each divided by what it
//!   does not pull the fit by itself (the jackknife's sandwich); with fewer than 16 pixels of
//!   weight Σ_p (Σ_l |w d| s)², which no correlation exceeds; of a single spot as if independent,
//!   for it has one entry in each row;
//! * `Everywhere`: (Σ |w d| s)², which no correlation exceeds. This is conservative by as much as
//!   the errors are not all one.
//!
//! θ̂ over its error is Student-distributed with the degrees of freedom of that variance
//! (Satterthwaite). What the model itself may be off by, Σ |w d| b, is taken off |Σ w d r| first.
//!
//! Where other light or the scale was fitted first ([`Eliminated`](super::eliminated::Eliminated)),
//! d is what that leaves of ∂model/∂θ.

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::evidence::{Errors, Evidence, Test};
use crate::matrix::Matrix;
use crate::num::statistics::{
    normal_two_sided, sidak_p, sidak_threshold, student_threshold, student_to_normal,
};

/// A parameter of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// What may be off.
    pub name: String,
    /// Unit of its deviation.
    pub unit: String,
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
    /// χ²/dof that remains with it fitted.
    pub chi2_per_dof: f64,
    /// What cannot be told from it by any light, with its deviation for this one.
    pub same: Vec<(String, f64)>,
    /// The spot, of a parameter of one spot.
    pub spot: Option<usize>,
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
    /// The most likely cause first: of the parameters beyond their limits the one that leaves the
    /// least χ². Then all that explain the difference as well, after whose fit the first is not
    /// missed at 1 %.
    pub likely: Vec<Deviation>,
    /// Parameters that change nothing or that the scene does not allow.
    pub untested: Vec<String>,
}

impl Score {
    /// Whether a parameter is beyond its limit.
    pub fn rejects(&self) -> bool {
        !self.likely.is_empty()
    }
}

/// Share of the significance level of each family: the scene's parameters, and the spots'.
const FAMILIES: f64 = 0.5;
/// Level at which a cause is told from the most likely one.
const TOLD_APART: f64 = 0.01;
/// 95 % of a normal distribution lie below.
const POWER: f64 = 1.644_853_626_951_472_2;
/// Fewer independent rows than this do not tell their own scatter.
const ENOUGH_ROWS: f64 = 16.0;

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
    let all = || found.deviations.iter().chain(&found.spots);
    let beyond = |d: &&Deviation| d.z.abs() > found.limits[usize::from(d.spot.is_some())];
    let least = |a: &&Deviation, b: &&Deviation| a.chi2_per_dof.total_cmp(&b.chi2_per_dof);
    let Some(best) = all().filter(beyond).min_by(least) else {
        return Vec::new();
    };
    let derivative = |d: &Deviation| {
        let index = parameters.iter().position(|p| match d.spot {
            None => p.name == d.name,
            Some(_) => p.each_spot.as_ref() == Some(&d.name),
        })?;
        let of = derivatives[index].as_ref()?;
        match residual.evidence.eliminated {
            None => Some(of_spot(of, d.spot)),
            Some(terms) => terms.left_of(&of_spot(of, d.spot)),
        }
    };
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
        Some(terms) => Some((Cow::Owned(terms.left_of(&of_spot(d, spot))?), all)),
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

/// Which weights a fit has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weights {
    /// Those of the least variance, as far as that is smooth.
    Smoothed,
    /// All alike.
    Alike,
}

/// A difference, ready to be fitted.
pub(super) struct Residual<'a> {
    evidence: Evidence<'a>,
    errors: Errors,
    freedom: f64,
    weights: Matrix,
    /// Estimated variance of each entry, W².
    variance: Matrix,
}

impl<'a> Residual<'a> {
    /// Weighs every entry that counts. One that was never lit, "0 ± 0", has no known error and
    /// no weight.
    pub(super) fn new(evidence: Evidence<'a>, test: Test, how: Weights) -> Self {
        let (rows, columns) = evidence.model.shape();
        let freedom = test.freedom();
        let known = |i: usize| {
            evidence.counts(i) && (evidence.stderr[i] > 0.0 || evidence.traced[i] != 0.0)
        };
        let square = |i: usize| evidence.stderr[i].max(evidence.rounding(i)).powi(2);
        let mut variance = Matrix::from_fn(rows, columns, |p, l| square(p + l * rows));
        let weights = match how {
            Weights::Alike => Matrix::from_fn(rows, columns, |p, l| {
                f64::from(u8::from(evidence.counts(p + l * rows)))
            }),
            Weights::Smoothed => {
                let smooth = smoothed(&variance, &known);
                Matrix::from_fn(rows, columns, |p, l| {
                    let (at, own) = (p + l * rows, variance[(p, l)]);
                    if !known(at) || own == 0.0 {
                        return 0.0;
                    }
                    if own < 2.0 * smooth[at] {
                        return 1.0 / smooth[at];
                    }
                    // Weighed by its own variance: E[σ²/s⁴] is ν/(ν − 4) times E[1/s²].
                    variance[(p, l)] *= freedom / (freedom - 4.0).max(1.0);
                    2.0 / own
                })
            }
        };
        Self {
            evidence,
            errors: test.errors,
            freedom,
            weights,
            variance,
        }
    }

    /// √w, pixels × spots; 0 of an entry without weight.
    pub(super) fn roots(&self) -> Matrix {
        self.weights.map(f64::sqrt)
    }

    fn difference(&self, at: usize) -> f64 {
        self.evidence.traced[at] - self.evidence.model[at]
    }

    /// Fits θ·d in the columns `columns`; `None` where that changes nothing.
    pub(super) fn fit(&self, d: &Matrix, columns: &Range<usize>) -> Option<Fit> {
        let rows = d.nrows();
        // Of each row: Σ w d r, Σ w d², Σ (w d s)², Σ (w d s)⁴, Σ |w d| s.
        let mut sums = vec![[0.0; 5]; rows];
        let mut bias = 0.0;
        for l in columns.clone() {
            for (p, sum) in sums.iter_mut().enumerate() {
                let at = p + l * rows;
                let wd = self.weights[at] * d[at];
                let square = wd * wd * self.variance[at];
                let terms = [
                    wd * self.difference(at),
                    wd * d[at],
                    square,
                    square * square,
                ];
                sum.iter_mut().zip(terms).for_each(|(s, x)| *s += x);
                sum[4] += square.sqrt();
                bias += wd.abs() * self.evidence.bound(at);
            }
        }
        let total = |k: usize| sums.iter().map(|s| s[k]).sum::<f64>();
        let g = total(1);
        if !(g > 0.0 && g.is_finite()) {
            return None;
        }
        let value = total(0) / g;
        // Rows that carry the fit: 1/Σ h², h the share of each.
        let effective = g * g / sums.iter().map(|s| s[1] * s[1]).sum::<f64>();
        let (variance, freedom) = match self.errors {
            Errors::WithinRows if columns.len() > 1 && effective >= ENOUGH_ROWS => {
                let left = |s: &[f64; 5]| (s[0] - value * s[1]) / (1.0 - s[1] / g);
                let scatter = sums.iter().map(|s| left(s).powi(2)).sum::<f64>();
                (scatter, effective - 1.0)
            }
            Errors::WithinRows if columns.len() > 1 => {
                (sums.iter().map(|s| s[4] * s[4]).sum(), self.freedom)
            }
            Errors::Everywhere => (total(4).powi(2), self.freedom),
            Errors::Independent | Errors::WithinRows => {
                let freedom = self.freedom * total(2).powi(2) / total(3);
                (
                    total(2),
                    if freedom.is_finite() {
                        freedom
                    } else {
                        self.freedom
                    },
                )
            }
        };
        Some(Fit {
            value,
            stderr: variance.sqrt() / g,
            bias: bias / g,
            freedom,
        })
    }

    /// z of the deviation `d` after `other` was fitted: of its part that `other` does not have.
    fn missed(&self, d: &Matrix, other: &Matrix) -> f64 {
        let dot = |a: &Matrix, b: &Matrix| {
            let terms = a.iter().zip(b).zip(&self.weights);
            terms.map(|((a, b), w)| w * a * b).sum::<f64>()
        };
        let own = d - other * (dot(d, other) / dot(other, other));
        // Below a millionth of it is rounding, and what derivatives are off by.
        if dot(&own, &own) < 1e-6 * dot(d, d) {
            return 0.0;
        }
        self.fit(&own, &(0..d.ncols())).map_or(0.0, |f| f.z())
    }
}

/// exp of a sum of a term by row and one by column, fitted to the logarithm of the entries that are
/// known and positive.
fn smoothed(variance: &Matrix, known: &dyn Fn(usize) -> bool) -> Matrix {
    let (rows, columns) = variance.shape();
    let (mut by_row, mut by_column) = (vec![[0.0; 2]; rows], vec![[0.0; 2]; columns]);
    let mut all = [0.0; 2];
    for (at, v) in variance
        .iter()
        .enumerate()
        .filter(|(i, v)| known(*i) && **v > 0.0)
    {
        for sum in [&mut by_row[at % rows], &mut by_column[at / rows], &mut all] {
            sum[0] += libm::log(*v);
            sum[1] += 1.0;
        }
    }
    let whole = all[0] / all[1].max(1.0);
    let mean = |[sum, n]: [f64; 2]| if n > 0.0 { sum / n } else { whole };
    Matrix::from_fn(rows, columns, |p, l| {
        libm::exp(mean(by_row[p]) + mean(by_column[l]) - whole)
    })
}

/// A deviation with its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub value: f64,
    pub stderr: f64,
    bias: f64,
    freedom: f64,
}

impl Fit {
    /// Standard normal deviate of the value, the bias taken off.
    pub(super) fn z(&self) -> f64 {
        let beyond = (self.value.abs() - self.bias).max(0.0);
        if beyond == 0.0 {
            return 0.0;
        }
        student_to_normal(beyond / self.stderr, self.freedom).copysign(self.value)
    }

    /// The deviation that makes |z| > `limit` 95 times in 100, whatever the model's bound hides:
    /// the noncentrality δ with P(t_ν(δ) > c) = 0.95 by c(1 − 1/4ν) − δ = −1.645·√(1 + c²/2ν)
    /// (Johnson and Welch 1940).
    fn detectable(&self, limit: f64) -> f64 {
        let c = student_threshold(limit, self.freedom);
        let nu = self.freedom;
        let delta = c * (1.0 - 0.25 / nu) + POWER * (1.0 + 0.5 * c * c / nu).sqrt();
        delta * self.stderr + 2.0 * self.bias
    }
}
