//! `joint-gp` where the noise is not known: what it leaves over is taken for the errors.

use super::correlated;
use super::error_field::Along;
use super::exponential::Exponential;
use super::gaussian_process::{Likeliest, with_alike};
use crate::recovery::joint::operator::scale;
use crate::recovery::{Method, Options, Problem, Recovered, RecoveryError, WeightRule};

/// How often it is done again with the errors that were found, and a change of the pixels that err
/// alike which makes no difference.
const MOST_AGAIN: usize = 3;
const SETTLED: f64 = 0.2;

const NOISE_IS_KNOWN: RecoveryError = RecoveryError::NotForMethod {
    method: Method::JointGp,
    what: "has no field of errors to find where the noise of the photographs is known",
    cure: "leave out --error-field",
};
const NO_FIELD: RecoveryError = RecoveryError::NotForMethod {
    method: Method::JointGp,
    what: "finds no field of errors where entries are left out, gains of the frames or a glare are \
           estimated, the columns and rows of a photograph are not known, or there are not more \
           entries than elements",
    cure: "leave out --error-field, or give --pixels COLUMNSxROWS",
};

/// Where the noise is unknown and the pixels' places are known, what is left over says over how
/// many pixels it hangs together, or by which field neighbours share it, and all is done again with
/// that.
pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let unknown = problem.noise().is_none() && problem.soft.is_none();
    if options.error_field && problem.noise().is_some() {
        return Err(NOISE_IS_KNOWN);
    }
    let Some(frame) = options.frame.filter(|_| unknown) else {
        return if options.error_field {
            Err(NO_FIELD)
        } else {
            Ok(with_alike(problem, options, 1.0)?.0)
        };
    };
    if options.error_field
        && let Some(found) = with_field(
            problem,
            options,
            &Along::new(problem, frame).ok_or(NO_FIELD)?,
        )?
    {
        let left = problem.phi - found.photographs(problem);
        // Of errors of this form the others' methods know nothing: no evidence that compares.
        return Ok(Recovered {
            alike: Some(correlated::pixels(&left, frame)?),
            log_evidence: None,
            ..found
        });
    }
    let (mut found, _) = with_alike(problem, options, 1.0)?;
    let mut alike = 1.0;
    for _ in 0..MOST_AGAIN {
        let left = problem.counted(problem.phi - found.photographs(problem));
        let now = correlated::pixels(&left, frame)?;
        if (now / alike - 1.0).abs() < SETTLED {
            break;
        }
        alike = now;
        (found, _) = with_alike(problem, options, alike)?;
    }
    found.alike = Some(alike);
    if alike > 1.0 {
        found.log_evidence = None;
    }
    Ok(found)
}

/// With the errors that are the likeliest for the likeliest prior, and that prior the likeliest for
/// them; none where there are no errors but rounding.
fn with_field(
    problem: &Problem<'_>,
    options: &Options,
    along: &Along,
) -> Result<Option<Recovered>, RecoveryError> {
    let unit = scale::unit(problem)?;
    let prior = Exponential::new(problem);
    let by_noise = Options {
        weighting: WeightRule::Noise,
        ..*options
    };
    let mut likeliest = Likeliest::usual(&prior);
    let (mut start, mut last) = (None, None);
    for _ in 0..MOST_AGAIN {
        let k = likeliest.covariance(&prior);
        let Some((field, likelihood)) = along.likeliest(problem, &k, unit, start)? else {
            return Ok(None);
        };
        start = Some(field);
        let stderr = along.stderr(&field);
        let (mut found, next) = with_alike(&along.problem(problem, &stderr), &by_noise, 1.0)?;
        along.back(problem, &mut found);
        found.field = Some(field);
        last = Some((found, likelihood));
        if next == likeliest {
            break;
        }
        likeliest = next;
    }
    // Noise of single pixels alone has a likeliest prior of its own.
    let (plain, likeliest) = with_alike(problem, options, 1.0)?;
    let size = plain.residual / (problem.entries() as f64).sqrt();
    let alone = along.alone(problem, &likeliest.covariance(&prior), unit, size)?;
    Ok(last.map(|(found, likelihood)| Recovered {
        log_likelier: alone.map(|alone| likelihood - alone),
        ..found
    }))
}

#[cfg(test)]
mod tests;
