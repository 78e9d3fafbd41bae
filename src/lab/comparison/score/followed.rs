//! A deviation followed to where the light lies, as the model bends on the way.
//!
//! A fit at the scene as it is takes the model for straight. By steps of Gauss and Newton
//!
//! > θ ← θ + Σ w d r / Σ w d²,   r = traced − model(θ), d = ∂model/∂θ at θ,
//!
//! each halved until Σ w r² falls, until a step is a twentieth of its standard error.

use std::ops::Range;

use crate::lab::comparison::evidence::{Evidence, Test};
use crate::lab::comparison::residual::{Fit, Residual, Weights};
use crate::matrix::Matrix;

/// Steps, and halvings of each.
const STEPS: usize = 12;
const HALVINGS: usize = 5;
/// A step over its standard error that changes nothing.
const ENOUGH: f64 = 0.05;

/// Where a deviation leaves the least.
pub(super) struct Followed {
    /// θ, its standard error and bias there.
    pub fit: Fit,
    /// model(θ) − model(0), and d.
    pub change: Matrix,
    pub derivative: Matrix,
}

/// Follows a deviation of the spots `columns` from `start`, whose first step is `first`; `moved`
/// gives change and derivative at each size. None where there are none, or no end.
pub(super) fn followed(
    (start, test): (&Residual<'_>, Test),
    columns: &Range<usize>,
    first: f64,
    moved: &dyn Fn(f64) -> Option<[Matrix; 2]>,
) -> Option<Followed> {
    let evidence = start.evidence;
    let at = |size: f64| {
        let [change, derivative] = moved(size)?;
        let model = evidence.model + &change;
        let own = Evidence {
            model: &model,
            ..evidence
        };
        let residual = Residual::new(own, test, Weights::Least);
        let step = residual.fit(&derivative, columns)?;
        let fit = Fit {
            value: size,
            ..step
        };
        let found = Followed {
            fit,
            change,
            derivative,
        };
        Some((residual.squares(columns), step, found))
    };
    let (mut left, mut step, mut from) = (start.squares(columns), first, 0.0);
    let mut here: Option<(Fit, Followed)> = None;
    for _ in 0..STEPS {
        let sizes = (0..HALVINGS).map(|k| from + step * 0.5f64.powi(k as i32));
        let next = sizes.filter_map(&at).find(|(squares, ..)| *squares < left);
        let Some((squares, rest, found)) = next else {
            break;
        };
        (left, step, from) = (squares, rest.value, found.fit.value);
        here = Some((rest, found));
        if step.abs() <= ENOUGH * rest.stderr {
            break;
        }
    }
    // Within its standard error it is where it belongs, whatever rounding leaves.
    let is_there = |rest: &Fit| rest.value.abs() <= rest.stderr;
    here.filter(|(rest, _)| is_there(rest))
        .map(|(_, found)| found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::uncertainty::certainty::Certainty;

    /// Light of a model that bends, exp(θ x) for x from 0 to 1, a thousandth of noise: from 0 the
    /// first step to θ = 1.5 overshoots by half, and the end is within its error.
    #[test]
    fn a_bent_model_is_followed_to_its_end() {
        const TRUE: f64 = 1.5;
        let (rows, columns) = (20, 10);
        let light = |theta: f64| {
            Matrix::from_fn(rows, columns, |p, l| {
                libm::exp(theta * (p + rows * l) as f64 / 199.0)
            })
        };
        let here = light(0.0);
        let slope = |theta: f64| {
            let x = Matrix::from_fn(rows, columns, |p, l| (p + rows * l) as f64 / 199.0);
            light(theta).component_mul(&x)
        };
        let stderr = light(TRUE) * 1e-3;
        let noise = crate::lab::deviate::normal_deviates(3, rows, columns);
        let traced = light(TRUE) + noise.component_mul(&stderr);
        let evidence = Evidence {
            traced: &traced,
            stderr: &stderr,
            model: &here,
            bound: None,
            left_out: None,
            eliminated: None,
        };
        let test = Test {
            known: Certainty::STATED,
            significance: 1e-3,
        };
        let all = 0..columns;
        let start = Residual::new(evidence, test, Weights::Least);
        let first = start.fit(&slope(0.0), &all).unwrap();
        assert!(first.value > 2.0, "{}", first.value);
        let moved = |theta: f64| Some([light(theta) - &here, slope(theta)]);
        let found = followed((&start, test), &all, first.value, &moved).unwrap();
        let off = (found.fit.value - TRUE) / found.fit.stderr;
        assert!(off.abs() < 4.0, "{off}");
        // Σ (d/σ)², the information.
        let information = slope(TRUE).component_div(&stderr).norm_squared();
        let ratio = found.fit.stderr * information.sqrt();
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        assert!(followed((&start, test), &all, first.value, &|_| None).is_none());
    }
}
