//! The problem about estimates of picture and factors, linear in both.

use nalgebra::{DMatrix, DVector};

use crate::recovery::soft::Soft;
use crate::recovery::{Options, Problem, Recovered, WeightRule};

/// Least factor about which the problem is made linear.
const LEAST: f64 = 0.05;

/// Estimates about which the problem is linear.
pub(in crate::recovery::joint) struct Estimates {
    pub(in crate::recovery::joint) x: DVector<f64>,
    pub(in crate::recovery::joint) frames: DVector<f64>,
    pub(in crate::recovery::joint) whole: f64,
    /// 1 where the noise is known, else its standard deviation, W.
    pub(in crate::recovery::joint) noise: f64,
    /// Whether the method integrates over ε: x is the light (1 + ε) ρ then, and `whole` stays 0.
    pub(in crate::recovery::joint) averages: bool,
    /// ν, directions of x that are of a prior's size, over which ε is averaged; 0 of methods whose
    /// x has no size beforehand.
    pub(in crate::recovery::joint) directions: f64,
}

impl Estimates {
    /// Goes this share of the way to what was found; by how much a factor differs from that at
    /// most, in units of its σ.
    pub(in crate::recovery::joint) fn take(&mut self, found: &Recovered, share: f64) -> f64 {
        let mut seen = found.seen();
        let mut change = 0.0f64;
        if let Some(gains) = found.nuisance.as_ref().and_then(|n| n.gains.as_ref()) {
            if let Some(frames) = &gains.frames {
                change = (&frames.size - &self.frames).amax() / frames.known_to;
                self.frames = &self.frames * (1.0 - share) + &frames.size * share;
            }
            if let Some(whole) = &gains.whole
                && self.averages
            {
                seen *= 1.0 + whole.size[0];
            } else if let Some(whole) = &gains.whole {
                change = change.max((whole.size[0] - self.whole).abs() / whole.known_to);
                self.whole += share * (whole.size[0] - self.whole);
            }
        }
        self.x = &self.x * (1.0 - share) + seen * share;
        change
    }
}

/// The linear problem.
///
/// Of what the photographs say of the mean of (1 + ε_l) x the prior of x says p ∝ (1 + mean)^(−ν)
/// more than patterns ε_l m can: the same as if ε_l were known about
///
/// > μ_l = −ν σ_g²/(n (1 + ε₀_l)),   n frames that count
///
/// in place of 0, where ln (1 + ε_l) is linear about ε₀_l.
pub(in crate::recovery::joint) struct Linear {
    pub(in crate::recovery::joint) phi: DMatrix<f64>,
    pub(in crate::recovery::joint) d: DMatrix<f64>,
    soft: Soft,
    /// μ_l.
    means: DVector<f64>,
    /// ln of what that prior has more at ε₀ than one about 0 times (1 + mean)^(−ν).
    log_prior: f64,
}

impl Linear {
    /// Of `problem`, whose nuisance names the standard deviations.
    pub(in crate::recovery::joint) fn about(problem: &Problem<'_>, at: &Estimates) -> Self {
        let (_, d, _) = problem.sides();
        let light = problem.light(&at.x);
        let factor = |x: f64| (1.0 + x).max(LEAST);
        let whole = factor(at.whole);
        let by_frame = |m: &DMatrix<f64>, of: &dyn Fn(usize, f64) -> f64| {
            let mut own = m.clone();
            for (l, mut column) in own.column_iter_mut().enumerate() {
                column *= of(l, factor(at.frames[l]));
            }
            own
        };
        let nuisance = &problem.nuisance;
        let (pixels, spots) = problem.phi.shape();
        let is_seen = |l: usize| (0..pixels).any(|p| nuisance.counts(p, l));
        let seen = (0..spots).filter(|l| is_seen(*l)).count();
        let of_each = at.directions / seen.max(1) as f64;
        let frames = DVector::from_fn(at.frames.len(), |l, _| {
            f64::from(u8::from(is_seen(l))) * of_each / factor(at.frames[l])
        });
        let frame_mean = &frames * -nuisance.frame_gain.map_or(0.0, |known| known * known);
        // What the linear terms in ε hold at the estimates, less their means.
        let shift = by_frame(&light, &|l, frame| {
            (frame - 1.0 - frame_mean[l]) * whole + (whole - 1.0) * frame
        });
        // Factors that are not asked for stay 0, and so do their means.
        let log_prior = frames.dot(&(&at.frames - &frame_mean * 0.5));
        Self {
            phi: problem.phi + shift,
            d: by_frame(d, &|_, frame| frame * whole),
            soft: Soft {
                frames: nuisance.frame_gain.map(|known| (&light * whole, known)),
                whole: nuisance.scale_error.map(|known| (&at.x / whole, known)),
                noise: at.noise,
            },
            means: frame_mean,
            log_prior,
        }
    }

    /// What a method found of this problem, its factors about 1 and its evidence with their prior.
    pub(in crate::recovery::joint) fn about_one(&self, mut found: Recovered) -> Recovered {
        let gains = found.nuisance.as_mut().and_then(|n| n.gains.as_mut());
        if let Some(frames) = gains.and_then(|gains| gains.frames.as_mut()) {
            frames.size += &self.means;
        }
        found.log_evidence = found.log_evidence.map(|evidence| evidence + self.log_prior);
        found
    }

    /// The linear problem; `base` is that without factors.
    pub(in crate::recovery::joint) fn problem<'b>(&'b self, base: &Problem<'b>) -> Problem<'b> {
        base.about(&self.phi, &self.d, &self.soft)
    }
}

/// What `of` makes of a problem whose factors are known only roughly: of that about factors of 1
/// and the grey surface that fits best. Of other problems, and where the noise is not known, of
/// itself.
pub(in crate::recovery::joint) fn about_grey<T>(
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
        averages: false,
        directions: 0.0,
    };
    of(&Linear::about(problem, &at).problem(&problem.without_gains()))
}
