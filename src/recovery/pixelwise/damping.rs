//! The choice of a damping λ.

use crate::recovery::rule::{Data, discrepancy::Discrepancy};
use crate::recovery::{Choice, Method, Options, Problem, RecoveryError, Rule, Spectrum};

/// Trial values of λ/σ₁ fall from 1e3 by this factor until one is accepted; bisection finds the
/// rest.
const STEP: f64 = 0.5;
/// Below this fraction of the last singular value kept, with room for a STEP, damping does nothing:
/// (λ/σ)² is lost in the rounding of 1 + (λ/σ)².
const NOTHING: f64 = 4e-9;

/// λ as a fraction of the spectrum's largest singular value, and why.
pub(super) fn choose(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
    spectrum: &Spectrum,
) -> Result<(f64, Choice), RecoveryError> {
    match options.damping {
        Some(value) if value.is_finite() && value >= 0.0 => return Ok((value, Choice::Given)),
        Some(value) => {
            let cure = "give a fraction of the largest singular value, 0 or more";
            return Err(RecoveryError::BadParameter {
                method,
                name: "damping",
                value,
                cure,
            });
        }
        None => {}
    }
    let (Some(&first), Some(&last)) = (spectrum.filtered().first(), spectrum.filtered().last())
    else {
        // Nothing that damping could change.
        return Ok((0.0, Choice::None));
    };
    let undecided = RecoveryError::Undecided {
        method,
        rule: options.rule,
        parameter: "damping",
    };
    let (lambda, choice) = match options.rule {
        Rule::Discrepancy => {
            let rule = Discrepancy::new(method, "damping", problem, spectrum)?;
            return by_discrepancy(&rule, spectrum, first, last);
        }
        Rule::Gcv => Data::new(problem, spectrum).damped_by_gcv(),
        Rule::LCurve => Data::new(problem, spectrum).damped_by_l_curve(),
    }
    .ok_or(undecided)?;
    Ok((lambda / first, choice))
}

/// The largest λ that is accepted.
fn by_discrepancy(
    rule: &Discrepancy<'_>,
    spectrum: &Spectrum,
    first: f64,
    last: f64,
) -> Result<(f64, Choice), RecoveryError> {
    let level = |damping: f64| rule.level(&spectrum.damped(damping * first));
    let (mut high, mut low) = (1e3, 1e3);
    while !level(low).accepted() {
        high = low;
        low *= STEP;
        if low * first < NOTHING * last {
            return Ok((low, rule.weakest(level(0.0))?));
        }
    }
    while high / low > 1.0 + 1e-12 {
        let middle = (high * low).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        if level(middle).accepted() {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low, level(low).choice()))
}
