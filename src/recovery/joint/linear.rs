//! The problem about estimates of picture and factors, linear in both.

use nalgebra::{DMatrix, DVector};

use crate::recovery::soft::Soft;
use crate::recovery::{Options, Problem, Recovered, WeightRule};

/// Least factor about which the problem is made linear.
const LEAST: f64 = 0.05;

/// Estimates about which the problem is linear.
pub(super) struct Estimates {
    pub(super) x: DVector<f64>,
    pub(super) frames: DVector<f64>,
    pub(super) whole: f64,
    /// 1 where the noise is known, else its standard deviation, W.
    pub(super) noise: f64,
}

impl Estimates {
    /// Goes this share of the way to what was found; by how much a factor differs from that at
    /// most, in units of its σ.
    pub(super) fn take(&mut self, found: &Recovered, share: f64) -> f64 {
        self.x = &self.x * (1.0 - share) + found.seen() * share;
        let mut change = 0.0f64;
        if let Some(gains) = found.nuisance.as_ref().and_then(|n| n.gains.as_ref()) {
            if let Some(frames) = &gains.frames {
                change = (&frames.size - &self.frames).amax() / frames.known_to;
                self.frames = &self.frames * (1.0 - share) + &frames.size * share;
            }
            if let Some(whole) = &gains.whole {
                change = change.max((whole.size[0] - self.whole).abs() / whole.known_to);
                self.whole += share * (whole.size[0] - self.whole);
            }
        }
        change
    }
}

/// The linear problem.
pub(super) struct Linear {
    pub(super) phi: DMatrix<f64>,
    pub(super) d: DMatrix<f64>,
    soft: Soft,
}

impl Linear {
    /// Of `problem`, whose nuisance names the standard deviations.
    pub(super) fn about(problem: &Problem<'_>, at: &Estimates) -> Self {
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

    /// The linear problem; `base` is that without factors.
    pub(super) fn problem<'b>(&'b self, base: &Problem<'b>) -> Problem<'b> {
        base.about(&self.phi, &self.d, &self.soft)
    }
}

/// What `of` makes of a problem whose factors are known only roughly: of that about factors of 1
/// and the grey surface that fits best. Of other problems, and where the noise is not known, of
/// itself.
pub(super) fn about_grey<T>(
    problem: &Problem<'_>,
    options: &Options,
    of: impl FnOnce(&Problem<'_>) -> T,
) -> T {
    let weighted = problem.noise().is_some() && options.weighting != WeightRule::Unweighted;
    if !(problem.nuisance.has_gains() && weighted) {
        return of(problem);
    }
    let at = Estimates {
        x: DVector::from_element(problem.elements(), problem.brightness()),
        frames: DVector::zeros(problem.phi.ncols()),
        whole: 0.0,
        noise: 1.0,
    };
    of(&Linear::about(problem, &at).problem(&problem.without_gains()))
}
