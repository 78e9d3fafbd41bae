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
//! ([`super::conditional`]) gives every method rows of unit noise for x alone, whose normal matrix is
//! H_xx − H_xε H_εε⁻¹ H_εx, so that errors, bands, probabilities and bounds are those of x with ε
//! unknown. The estimates are then set to what was found and all is done again, until the factors no
//! longer change (Gauss–Newton). Where that ends, (x̂, ε̂) is where Σ z² + Σ ε_l²/σ_g² + ε²/σ_s² with
//! the method's own terms is stationary.
//!
//! Patterns of two values are weighed against each other with the factors linear about the best of
//! them: of another one ε multiplies this one's light, an error of the second order.
//!
//! Evidence: ∫ p(Φ|x, ε) p(ε) dε by Laplace's method is that of the linear problem times
//! Π (1 + σ²⟨m, m⟩)^(−½), m in units of the noise and without what other terms take, so that factors
//! that nothing asks for lower it.

use nalgebra::{DMatrix, DVector};

use super::bounded;
use super::khatri_rao::operator;
use crate::recovery::soft::Soft;
use crate::recovery::{
    Gains, Method, Options, Problem, Recovered, RecoveryError, Shared, WeightRule,
};

/// Linear problems that are solved at most.
const MOST_STEPS: usize = 30;
/// The factors have settled where none changes by more than this fraction of its σ.
const SETTLED: f64 = 1e-4;
/// Least factor about which the problem is made linear.
const LEAST: f64 = 0.05;

/// Estimates about which the problem is linear.
struct Estimates {
    x: DVector<f64>,
    frames: DVector<f64>,
    whole: f64,
    /// 1 where the noise is known, else its standard deviation, W.
    noise: f64,
}

/// The linear problem.
struct Linear {
    phi: DMatrix<f64>,
    d: DMatrix<f64>,
    soft: Soft,
}

impl Linear {
    /// Of `problem`, whose nuisance names the standard deviations.
    fn about(problem: &Problem<'_>, at: &Estimates) -> Self {
        let (_, d, _) = problem.sides();
        let light = problem.light(&at.x);
        let factor = |x: f64| (1.0 + x).max(LEAST);
        let whole = factor(at.whole);
        let by_frame = |m: &DMatrix<f64>, of: &dyn Fn(f64) -> f64| {
            let mut own = m.clone();
            for (mut column, frame) in own.column_iter_mut().zip(at.frames.iter()) {
                column *= of(factor(*frame));
            }
            own
        };
        // What the linear terms in ε hold at the estimates.
        let shift = by_frame(&light, &|frame| {
            (frame - 1.0) * whole + (whole - 1.0) * frame
        });
        let nuisance = &problem.nuisance;
        Self {
            phi: problem.phi + shift,
            d: by_frame(d, &|frame| frame * whole),
            soft: Soft {
                frames: nuisance.frame_gain.map(|known| (&light * whole, known)),
                whole: nuisance.scale_error.map(|known| (&at.x / whole, known)),
                noise: at.noise,
            },
        }
    }

    fn problem<'b>(&'b self, base: &Problem<'b>) -> Problem<'b> {
        base.about(&self.phi, &self.d, &self.soft)
    }
}

/// Recovers by `by`, a method on a problem that is linear in the factors.
pub(in crate::recovery) fn recover(
    method: Method,
    problem: &Problem<'_>,
    options: &Options,
    by: impl Fn(Method, &Problem<'_>, &Options) -> Result<Recovered, RecoveryError>,
) -> Result<Recovered, RecoveryError> {
    let base = problem.without_gains();
    let weighted = options.weighting != WeightRule::Unweighted && problem.noise().is_some();
    let noise = |found: &Recovered| {
        if weighted {
            return 1.0;
        }
        let freedom = (problem.entries() as f64 - found.freedom_used()).max(1.0);
        let floor = f64::EPSILON * problem.counted(problem.phi.clone()).norm();
        found.residual.max(floor) / freedom.sqrt()
    };
    let quick = Options {
        bands: None,
        probabilities: false,
        ..*options
    };
    let start = bounded::recover(Method::Nnls, &base, &quick)?;
    let mut at = Estimates {
        x: start.seen(),
        frames: DVector::zeros(problem.phi.ncols()),
        whole: 0.0,
        noise: noise(&start),
    };
    let (mut steps, mut settled) = (0, false);
    while steps < MOST_STEPS && !settled {
        steps += 1;
        let linear = Linear::about(problem, &at);
        let found = by(method, &linear.problem(&base), &quick)?;
        let noise = noise(&found);
        settled = (noise / at.noise - 1.0).abs() < SETTLED;
        settled &= at.take(&found) < SETTLED;
        at.noise = noise;
    }
    let linear = Linear::about(problem, &at);
    let shared = Shared::default();
    let about = linear.problem(&base).sharing(&shared);
    let mut found = by(method, &about, options)?;
    settled &= at.take(&found) < SETTLED;
    let evidence = match (found.log_evidence, weighted) {
        (Some(evidence), true) => punished(evidence, &base, &about, options)?,
        _ => None,
    };
    found.log_evidence = evidence;
    let widened = widened(&found, || {
        let known = base.about(&linear.phi, &linear.d, &Soft::NONE);
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

impl Estimates {
    /// Takes what was found; the largest change of a factor in units of its σ.
    fn take(&mut self, found: &Recovered) -> f64 {
        self.x = found.seen();
        let mut change = 0.0f64;
        if let Some(gains) = found.nuisance.as_ref().and_then(|n| n.gains.as_ref()) {
            if let Some(frames) = &gains.frames {
                change = (&frames.size - &self.frames).amax() / frames.known_to;
                self.frames.copy_from(&frames.size);
            }
            if let Some(whole) = &gains.whole {
                change = change.max((whole.size[0] - self.whole).abs() / whole.known_to);
                self.whole = whole.size[0];
            }
        }
        change
    }
}

/// The evidence of the linear problem over the density of the numbers that fit best without factors:
/// by what the deviance of each one's best fit differs.
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
