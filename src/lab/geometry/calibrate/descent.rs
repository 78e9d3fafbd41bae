//! The likeliest values of the unknowns, by noise continuation.
//!
//! The cost is a canyon: at a small noise it is steep everywhere but along its floor. So the noise
//! is first taken for at least 3 % of the light and then lowered by half a decade at a time; at
//! each noise Levenberg–Marquardt steps (1963) go down with the prior of the unknowns,
//!
//! > (F + Λ + μ diag(F + Λ)) δ = −(slope + Λθ),   Λ = diag(1/σ_k²)
//!
//! as far as there is a scene ([`super::edge`]).
//!
//! Where the noise is not known the last one is what the likeliest picture leaves.

use nalgebra::DVector;

use super::geometry::{Geometry, Light};
use super::picture::Prior;
use super::posterior::{Seen, Slope, Value};
use super::step::{damped, gain};
use crate::lab::error::LabError;
use crate::lab::geometry::common::Common;
use crate::lab::geometry::normal::Normal;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::num::statistics::median;
use crate::transport::Control;

/// Noise of the first stage, over the light.
const FIRST: f64 = 0.03;
/// From one stage to the next.
const STEP: f64 = 0.316_227_766_016_837_94;
/// Steps at one noise.
const MOST_STEPS: usize = 40;
/// A step that is expected to gain less than this, or less than this of every error, is the last.
pub(super) const ENOUGH: f64 = 1e-4;
/// μ at first, and where nothing goes down any more.
const DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e9;
/// Change of a noise that is estimated below which it is settled.
const SETTLED: f64 = 0.02;

/// What is to be found, and from what.
pub(super) struct Problem<'a> {
    pub geometry: Geometry<'a>,
    /// Less their means over the frames where there is light that all share.
    pub photographs: Unexplained<'a>,
    /// That light.
    pub common: Option<&'a Common>,
    /// σ_k; none where nothing is known of an unknown.
    pub priors: Vec<Option<f64>>,
    pub pictures: &'a [Prior],
    pub is_scale_free: bool,
    /// The noise of the first stage, over the stated one ([`first`]).
    pub first: f64,
    /// Columns and rows of photographs that are along their cosines; none where they are as taken.
    pub cosines: Option<[usize; 2]>,
    /// ½ ln det of the covariance of the stated errors, what other light takes left out.
    pub log_errors: f64,
}

/// The unknowns at some noise.
pub(super) struct State {
    pub values: Vec<f64>,
    /// Noise over the stated one.
    pub factor: f64,
    pub prior: Prior,
    pub value: Value,
    pub slope: Slope,
    /// Whether the last stage ended by itself.
    pub is_settled: bool,
}

/// What a stage found.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Stage {
    /// Noise over the stated one, or over 1 W where none is stated.
    pub noise: f64,
    /// Steps taken.
    pub steps: usize,
    /// χ² over degrees of freedom at this noise.
    pub misfit: f64,
    /// The unknowns.
    pub values: Vec<f64>,
}

impl State {
    /// ν² = χ²/(N − directions), over the assumed noise.
    pub(super) fn left(&self) -> f64 {
        self.value.chi2 / (self.value.count - self.value.freedom).max(1.0)
    }
}

impl<'a> Problem<'a> {
    pub(super) fn seen(&self, factor: f64) -> Seen<'a> {
        Seen {
            photographs: self.photographs,
            common: self.common,
            factor,
            cosines: self.cosines,
        }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.geometry.unknowns()
    }

    /// The light at `values` less what all frames may share of it.
    pub(super) fn light(&self, values: &[f64], noise: f64, rates: bool) -> Result<Light, LabError> {
        let light = self.geometry.light(values, noise, rates)?;
        Ok(match self.common {
            Some(common) => light.less_means(common.shares()),
            None => light,
        })
    }

    /// −ln of the prior of the unknowns.
    fn penalty(&self, values: &[f64]) -> f64 {
        let each = values.iter().zip(&self.priors);
        each.filter_map(|(x, sigma)| sigma.map(|s| 0.5 * (x / s) * (x / s)))
            .sum()
    }

    /// Everything at `values`; `prior` is looked for where it is not given.
    pub(super) fn state(
        &self,
        values: &[f64],
        factor: f64,
        prior: Option<&Prior>,
    ) -> Result<State, LabError> {
        let light = self.light(values, self.relative(factor), true)?;
        let normal = self.seen(factor).normal(&light)?;
        let prior = match prior {
            Some(prior) => prior.clone(),
            None => Prior::likeliest(self.pictures, &normal, self.is_scale_free)?,
        };
        self.state_by((values, factor), (&light, &normal), prior)
    }

    /// The same by a prior, of `light` at `values` and its normal equations.
    pub(super) fn state_by(
        &self,
        (values, factor): (&[f64], f64),
        (light, normal): (&Light, &Normal),
        prior: Prior,
    ) -> Result<State, LabError> {
        let seen = self.seen(factor);
        let value = seen.value(light, normal, &prior)?;
        let slope = seen.slope(light, &prior, &value, self.unknowns())?;
        Ok(State {
            values: values.to_vec(),
            factor,
            prior,
            value,
            slope,
            is_settled: false,
        })
    }

    /// The cost at `values`, its prior's included; none where the scene does not allow them.
    pub(super) fn cost(
        &self,
        values: &[f64],
        factor: f64,
        prior: &Prior,
    ) -> Result<Option<f64>, LabError> {
        let light = match self.light(values, self.relative(factor), false) {
            Ok(light) => light,
            Err(LabError::Scene(_)) => return Ok(None),
            Err(other) => return Err(other),
        };
        let seen = self.seen(factor);
        let normal = seen.normal(&light)?;
        let value = seen.value(&light, &normal, prior)?;
        Ok(Some(value.cost + self.penalty(values)))
    }

    /// F + Λ.
    pub(super) fn information(&self, slope: &Slope) -> Matrix {
        let mut all = slope.curvature.clone();
        for (k, sigma) in self.priors.iter().enumerate() {
            all[(k, k)] += sigma.map_or(0.0, |s| 1.0 / (s * s));
        }
        all
    }

    /// The noise of a pixel in the middle of all that is `factor` times the stated one, over its
    /// light; 0 at the stated one, for many pixels know together what none knows alone.
    pub(super) fn relative(&self, factor: f64) -> f64 {
        match self.photographs.stderr {
            Some(_) if factor == 1.0 => 0.0,
            _ => FIRST * factor / self.first,
        }
    }

    /// −ln p(y|θ) p(θ) up to a constant, the noise being an unknown too.
    pub(super) fn total(&self, state: &State) -> f64 {
        let noise = state.value.count * libm::log(state.factor) + self.log_errors;
        state.value.cost + self.penalty(&state.values) + noise
    }

    /// Down from `start` through all noises from the one that is `first` times the stated one.
    pub(super) fn descend(
        &self,
        start: &[f64],
        first: f64,
        control: Control<'_>,
    ) -> Result<(State, Vec<Stage>), LabError> {
        let is_known = self.photographs.stderr.is_some();
        let mut factor = if is_known { first.max(1.0) } else { first };
        let mut stages = Vec::new();
        let mut values = start.to_vec();
        loop {
            let (state, steps) = self.stage(&values, factor, control)?;
            stages.push(Stage {
                noise: factor,
                steps,
                misfit: state.left(),
                values: state.values.clone(),
            });
            let next = if is_known {
                (factor * STEP).max(1.0)
            } else {
                (factor * STEP).max(factor * state.left().sqrt())
            };
            if (next / factor - 1.0).abs() < SETTLED || stages.len() == MOST_STEPS {
                return Ok((state, stages));
            }
            values.clone_from(&state.values);
            factor = next;
        }
    }

    /// Down at one noise.
    pub(super) fn stage(
        &self,
        start: &[f64],
        factor: f64,
        control: Control<'_>,
    ) -> Result<(State, usize), LabError> {
        let mut state = self.state(start, factor, None)?;
        let prior = state.prior.clone();
        let mut damping = DAMPING;
        for steps in 0..MOST_STEPS {
            control.check()?;
            let information = self.information(&state.slope);
            let slope = self.whole_slope(&state);
            let here = state.value.cost + self.penalty(&state.values);
            let free = vec![None; slope.len()];
            let mut fixed = free.clone();
            let next = loop {
                if damping > MOST_DAMPING {
                    break None;
                }
                let Some(step) = damped(&information, &slope, damping, &fixed) else {
                    damping *= 10.0;
                    continue;
                };
                if gain(&information, &slope, &step) < ENOUGH {
                    break None;
                }
                let values: Vec<f64> = state.values.iter().zip(&step).map(|(x, d)| x + d).collect();
                match self.cost(&values, factor, &prior)? {
                    Some(cost) if cost < here => {
                        damping = (0.1 * damping).max(1e-12);
                        break Some(values);
                    }
                    None if self.geometry.fix(&state.values, &step, &mut fixed) => {}
                    _ => {
                        damping *= 10.0;
                        fixed.clone_from(&free);
                    }
                }
            };
            match next {
                Some(values) => state = self.state(&values, factor, Some(&prior))?,
                None => {
                    state.is_settled = true;
                    return Ok((state, steps));
                }
            }
        }
        Ok((state, MOST_STEPS))
    }

    /// Slope of the cost with the prior of the unknowns.
    pub(super) fn whole_slope(&self, state: &State) -> DVector<f64> {
        let mut slope = state.slope.slope.clone();
        for (k, sigma) in self.priors.iter().enumerate() {
            slope[k] += sigma.map_or(0.0, |s| state.values[k] / (s * s));
        }
        slope
    }
}

/// The noise of the first stage, over the stated one.
pub(super) fn first(photographs: &Unexplained<'_>) -> f64 {
    let Unexplained { phi, stderr, .. } = *photographs;
    let relative: Vec<f64> = match stderr {
        Some(stderr) => phi
            .iter()
            .zip(stderr)
            .filter(|(x, s)| **s > 0.0 && **x != 0.0)
            .map(|(x, s)| s / x.abs())
            .collect(),
        None => phi
            .iter()
            .filter(|x| **x != 0.0)
            .map(|x| 1.0 / x.abs())
            .collect(),
    };
    median(relative).map_or(1.0, |noise| FIRST / noise)
}
