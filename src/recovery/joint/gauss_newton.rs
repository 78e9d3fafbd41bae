//! Recovery with factors of the light that are known only roughly.
//!
//! > Φ\[p,l\] = (1 + ε)(1 + ε_l) (A x)\[p,l\] + …,   ε_l ~ N(0, σ_g²),   ε ~ N(0, σ_s²)
//!
//! is linear in x and the ε together about estimates (x₀, ε₀), with m = A x₀:
//!
//! > Φ + ε₀_l (1 + ε₀) m + ε₀ (1 + ε₀_l) m ≈ (1 + ε₀)(1 + ε₀_l) A x
//! >                                          + ε_l (1 + ε₀) m + ε (1 + ε₀_l) m + …
//!
//! So a factor is one more pattern, of a size that is known beforehand: its elimination
//! ([`conditional`](super::operator::conditional)) gives every method rows of unit noise for x
//! alone, whose normal matrix is H_xx − H_xε H_εε⁻¹ H_εx, so that errors, bands, probabilities and
//! bounds are those of x with ε unknown. The estimates are then set to what was found and all is
//! done again, until the factors no longer change (Gauss–Newton, by half steps where whole ones do
//! not settle). Where that ends, (x̂, ε̂) is where Σ z² + Σ ε_l²/σ_g² + ε²/σ_s² with the method's
//! own terms is stationary. Of `joint-gp`, which knows of what size x is, the factors of the frames
//! are the likeliest whatever x ([`Linear`]): fitted together, the picture would be the least and
//! the factors the largest.
//! Over ε it integrates itself ([`gaussian_process`](super::process::gaussian_process)): x is the
//! light (1 + ε) ρ here. So do patterns of two given values
//! ([`factor`](super::patterns::factor)).
//!
//! Patterns of two values that are not given are weighed against each other with the factors linear
//! about the best of them, and factors of frames always: of another one ε multiplies this one's
//! light, an error of the second order.
//!
//! Evidence: ∫ p(Φ|x, ε) p(ε) dε by Laplace's method is that of the linear problem times Π (1 +
//! σ²⟨m, m⟩)^(−½), m in units of the noise and without what other terms take, so that factors that
//! nothing asks for lower it.

use nalgebra::DVector;

use crate::recovery::joint::bounded;
use crate::recovery::joint::operator::khatri_rao::operator;
use crate::recovery::joint::operator::linear::{Estimates, Linear};
use crate::recovery::soft::Soft;
use crate::recovery::{
    Gains, Method, Options, Problem, Recovered, RecoveryError, Shared, WeightRule,
};

/// Linear problems that are solved at most.
const MOST_STEPS: usize = 40;
/// How many of them go all the way.
const WHOLE_STEPS: usize = 8;
/// The factors have settled where none changes by more than this fraction of its σ.
const SETTLED: f64 = 1e-4;

/// Recovers by `by`, a method on a problem that is linear in the factors.
pub(in crate::recovery) fn recover(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
    by: impl Fn(Method, &Problem<'_>, &Options) -> Result<Recovered, RecoveryError>,
) -> Result<Recovered, RecoveryError> {
    let has_size = method == Method::JointGp;
    let averages = has_size || method == Method::JointTwoValued && options.levels.is_some();
    let whole = problem.nuisance.scale_error;
    let [averaged, fitted] = if averages {
        [whole, None]
    } else {
        [None, whole]
    };
    let base = problem.without_gains().with_scale_error(averaged);
    let with_factors = problem.with_scale_error(fitted);
    let weighted = options.weighting != WeightRule::Unweighted && problem.noise().is_some();
    let noise = |found: &Recovered| {
        if weighted {
            return 1.0;
        }
        let freedom = (problem.entries() as f64 - found.freedom_used()).max(1.0);
        let floor = f64::EPSILON * problem.counted(problem.phi.clone()).norm();
        found.residual.max(floor) / freedom.sqrt()
    };
    // A pattern is found by its levels, of which only the ratio is known with the scale, and by a
    // wide search: along the scale many patterns fit nearly as well.
    let by_ratio = method == Method::JointTwoValued && fitted.is_some();
    let quick = Options {
        bands: None,
        probabilities: by_ratio && options.probabilities,
        spreads: false,
        ..*options
    };
    let (start, whole) = if by_ratio {
        let found = by(method, &base.with_free_scale(), &quick)?;
        let scale = found.seen().amax();
        let light = scale.min(1.0);
        (found, scale / light - 1.0)
    } else {
        (bounded::recover(Method::Nnls, &base, &quick)?, 0.0)
    };
    let mut at = Estimates {
        x: start.seen() / (1.0 + whole),
        frames: DVector::zeros(problem.phi.ncols()),
        whole,
        noise: noise(&start),
        averages,
        directions: 0.0,
    };
    let settle = |method: Method, at: &mut Estimates| -> Result<(usize, bool), RecoveryError> {
        let (mut steps, mut settled) = (0, false);
        while steps < MOST_STEPS && !settled {
            steps += 1;
            let linear = Linear::about(&with_factors, at);
            let found = linear.about_one(by(method, &linear.problem(&base), &quick)?);
            let noise = noise(&found);
            if has_size {
                at.directions = found.effective_rank;
            }
            settled = (noise / at.noise - 1.0).abs() < SETTLED;
            // Where whole steps go back and forth, half of them do not.
            let share = if steps > WHOLE_STEPS { 0.5 } else { 1.0 };
            settled &= at.take(&found, share) < SETTLED;
            at.noise *= libm::pow(noise / at.noise, share);
        }
        Ok((steps, settled))
    };
    // Before the factors are found no picture explains the photographs: `joint-tv` refuses them.
    let before = match method {
        Method::JointTv => settle(Method::Joint, &mut at)?.0,
        _ => 0,
    };
    let (steps, mut settled) = settle(method, &mut at)?;
    let steps = before + steps;
    let linear = Linear::about(&with_factors, &at);
    let shared = Shared::default();
    let about = linear.problem(&base).sharing(&shared);
    let mut found = linear.about_one(by(method, &about, options)?);
    settled &= at.take(&found, 1.0) < SETTLED;
    let evidence = match (found.log_evidence, weighted) {
        (Some(evidence), true) => punished(evidence, &base, &about, options)?,
        _ => None,
    };
    found.log_evidence = evidence;
    let gains = found.nuisance.as_ref().and_then(|n| n.gains.as_ref());
    let whole = gains.and_then(|gains| gains.whole.as_ref());
    let averaged = whole.filter(|_| averages).map(|of| 1.0 + of.size[0]);
    let widened = widened(&found, || {
        let scaled = averaged.map(|factor| &linear.d * factor);
        let d = scaled.as_ref().unwrap_or(&linear.d);
        let known = base.with_scale_error(None);
        let known = known.about(problem.phi, d, &Soft::NONE);
        let quick = Options {
            spreads: options.spreads,
            probabilities: options.probabilities && problem.nuisance.scale_error.is_some(),
            ..quick
        };
        by(method, &known, &quick)
    })?;
    if let Some(gains) = found.nuisance.as_mut().and_then(|n| n.gains.as_mut()) {
        *gains = Gains {
            steps,
            settled,
            widened,
            ..gains.clone()
        };
    }
    let left = problem.phi - found.photographs(problem);
    found.residual = problem.counted(left).norm();
    let whole = problem.counted(problem.phi.clone()).norm();
    found.relative_residual = found.residual / whole;
    Ok(found)
}

/// The evidence of the linear problem over the density of the numbers that fit best without
/// factors: by what the deviance of each one's best fit differs.
fn punished(
    evidence: f64,
    base: &Problem<'_>,
    about: &Problem<'_>,
    options: &Options,
) -> Result<Option<f64>, RecoveryError> {
    let by_entry = Options {
        weighting: WeightRule::Entries,
        ..*options
    };
    let with = operator(about, &by_entry)?.deviance();
    let (_, d, _) = base.sides();
    let plain = base.about(base.phi, d, &Soft::NONE);
    let without = operator(&plain, &by_entry)?.deviance();
    let gained = without.zip(with).map(|(a, b)| 0.5 * (a - b));
    Ok(gained.map(|gained| evidence + gained))
}

/// Mean standard error over what it is with the factors known.
fn widened(
    found: &Recovered,
    with_known: impl Fn() -> Result<Recovered, RecoveryError>,
) -> Result<Option<f64>, RecoveryError> {
    let Some(own) = &found.standard_error else {
        return Ok(None);
    };
    let known = with_known()?.standard_error;
    let ratio = known.map(|known| own.mean() / known.mean());
    Ok(ratio.filter(|ratio| ratio.is_finite()))
}

#[cfg(test)]
mod tests;
