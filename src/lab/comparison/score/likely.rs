//! Which deviations explain a difference.

use std::ops::Range;

use rayon::prelude::*;

use super::deviation::{Derivatives, Deviation};
use super::followed::followed;
use super::picture::{PictureFit, TOLD_APART};
use crate::lab::comparison::eliminated::Eliminated;
use crate::lab::comparison::evidence::{Evidence, Test};
use crate::lab::comparison::residual::{Residual, Weights};
use crate::lab::uncertainty::certainty::Errors;
use crate::matrix::Matrix;
use crate::num::statistics::sidak_threshold;

/// Causes that are followed.
const FOLLOWED: usize = 4;
/// A cause that leaves more χ²/dof does not explain the difference.
const EXPLAINED: f64 = 1.5;

/// What χ² says of the model.
#[derive(Clone, Copy)]
pub(in crate::lab) struct Remaining<'a> {
    /// χ²/dof of the entries after a deviation: of `model + θ·d` in these columns.
    pub after: &'a (dyn Fn(f64, &Matrix, &Range<usize>) -> f64 + Sync),
    /// Entries less what was fitted first.
    pub entries: f64,
    /// Whether χ² or the largest |z| refuses the model.
    pub is_refused: bool,
}

/// What may explain a difference.
pub(super) struct Causes<'a> {
    pub residual: &'a Residual<'a>,
    pub test: Test,
    pub derivatives: &'a Derivatives<'a>,
    /// ∂Φ/∂θ of each parameter.
    pub of: &'a [Option<Matrix>],
    pub remaining: Remaining<'a>,
}

/// A deviation with what it changes in the model, and the derivative there.
struct Cause {
    deviation: Deviation,
    change: Matrix,
    derivative: Matrix,
}

impl Causes<'_> {
    /// The most likely cause, of those `beyond` their limit the one that leaves the least χ², and
    /// those of `all` that explain the difference as well; and what that cause changes. Where the
    /// best few by their first steps do not explain it, the others are followed until one does, in
    /// the order of what the light of the scene leaves there: a model that bends is not told by its
    /// slope.
    pub(super) fn likely(
        &self,
        all: &[&Deviation],
        mut beyond: Vec<&Deviation>,
    ) -> (Vec<Deviation>, Option<Matrix>) {
        let least = |a: &&Deviation, b: &&Deviation| a.chi2_per_dof.total_cmp(&b.chi2_per_dof);
        let all = || all.iter().copied().filter(|d| d.is_within_reach(d.value));
        // A first step may go too far.
        beyond.sort_by(least);
        let (first, further) = beyond.split_at(FOLLOWED.min(beyond.len()));
        let mut causes: Vec<Cause> = first.iter().filter_map(|d| self.cause(d)).collect();
        let chi2 = |cause: &Cause| cause.deviation.chi2_per_dof;
        if !causes.iter().any(|cause| chi2(cause) < EXPLAINED) {
            let of_scene = further.par_iter().filter(|d| d.spot.is_none());
            let there = of_scene.filter_map(|d| Some((self.at_first_step(d)?, *d)));
            let mut there: Vec<(f64, &Deviation)> = there.collect();
            there.sort_by(|a, b| a.0.total_cmp(&b.0));
            for cause in there.into_iter().filter_map(|(_, d)| self.cause(d)) {
                let explains = chi2(&cause) < EXPLAINED;
                causes.push(cause);
                if explains {
                    break;
                }
            }
        }
        causes.sort_by(|a, b| chi2(a).total_cmp(&chi2(b)));
        let Some((best, others)) = causes.split_first() else {
            return (Vec::new(), None);
        };
        let limit = sidak_threshold(TOLD_APART, all().count() as u64);
        let is_as_good = |other: &Cause| self.missed(best, other).abs() <= limit;
        let is = |d: &Deviation, cause: &Cause| {
            let own = &cause.deviation;
            d.name == own.name && d.spot == own.spot
        };
        let rest = all().filter(|d| !causes.iter().any(|cause| is(d, cause)));
        let rest: Vec<&Deviation> = rest.collect();
        let rest = rest.into_par_iter().filter_map(|d| self.straight(d));
        let rest = rest.filter(is_as_good).map(|cause| cause.deviation);
        let mut rest: Vec<Deviation> = rest.collect();
        let followed = others.iter().filter(|other| is_as_good(other));
        rest.extend(followed.map(|other| other.deviation.clone()));
        rest.sort_by(|a, b| least(&a, &b));
        let first = std::iter::once(best.deviation.clone());
        (first.chain(rest).collect(), Some(best.change.clone()))
    }

    /// The picture as a cause, beside what the best single parameter changes. Errors that entries
    /// share look like one, and a free scale would change with it.
    pub(super) fn picture(&self, best: Option<&Matrix>) -> Option<PictureFit> {
        let evidence = self.residual.evidence;
        let is_free = evidence.eliminated.is_some_and(Eliminated::is_scale_free);
        if is_free || self.test.known.errors != Errors::Independent {
            return None;
        }
        let all = 0..evidence.model.ncols();
        let remaining = |change: &Matrix| (self.remaining.after)(1.0, change, &all);
        let picture = (self.derivatives.picture?)()?;
        picture.fit(self.residual, best, (&remaining, self.remaining.entries))
    }

    /// z of the best cause after another was fitted, of what that does not change.
    fn missed(&self, best: &Cause, other: &Cause) -> f64 {
        if !other.deviation.is_followed {
            return self.residual.missed(&best.change, &other.derivative);
        }
        let evidence = self.residual.evidence;
        let model = evidence.model + &other.change;
        let evidence = Evidence {
            model: &model,
            ..evidence
        };
        let residual = Residual::new(evidence, self.test, Weights::Least);
        residual.missed(&(&best.change - &other.change), &other.derivative)
    }

    /// A deviation as far as it can be followed, if a scene can have it.
    fn cause(&self, d: &Deviation) -> Option<Cause> {
        let straight = || {
            let possible = d.is_within_reach(d.value).then_some(d)?;
            self.straight(possible)
        };
        self.bent(d).or_else(straight)
    }

    /// Its first step.
    fn straight(&self, d: &Deviation) -> Option<Cause> {
        let derivative = self.of[self.index(d)?].as_ref()?;
        let derivative = whole(&self.residual.evidence, derivative, d.spot)?;
        Some(Cause {
            change: &derivative * d.value,
            derivative,
            deviation: d.clone(),
        })
    }

    /// What the model changes by a size of the deviation, and the derivative there. A free scale
    /// would change with it.
    fn moved(&self, d: &Deviation, size: f64) -> Option<[Matrix; 2]> {
        let evidence = self.residual.evidence;
        let is_free = evidence.eliminated.is_some_and(Eliminated::is_scale_free);
        let inside = (!is_free && d.is_within_reach(size)).then_some(size)?;
        let [change, derivative] = (self.derivatives.moved)(self.index(d)?, inside)?;
        let of = |m: Matrix| whole(&evidence, &m, d.spot);
        Some([of(change)?, of(derivative)?])
    }

    /// χ²/dof that the scene at the first step leaves, not its slope.
    fn at_first_step(&self, d: &Deviation) -> Option<f64> {
        let [change, _] = self.moved(d, d.value)?;
        Some((self.remaining.after)(1.0, &change, &(0..change.ncols())))
    }

    /// The deviation where it leaves the least.
    fn bent(&self, d: &Deviation) -> Option<Cause> {
        let evidence = self.residual.evidence;
        let all = 0..evidence.model.ncols();
        let columns = match (evidence.eliminated, d.spot) {
            (None, Some(l)) => l..l + 1,
            _ => all,
        };
        let moved = |size: f64| self.moved(d, size);
        let found = followed((self.residual, self.test), &columns, d.value, &moved)?;
        let deviation = Deviation {
            value: found.fit.value,
            stderr: found.fit.stderr,
            bias: found.fit.bias,
            chi2_per_dof: (self.remaining.after)(1.0, &found.change, &columns),
            is_followed: true,
            ..d.clone()
        };
        Some(Cause {
            deviation,
            change: found.change,
            derivative: found.derivative,
        })
    }

    /// Its parameter.
    fn index(&self, d: &Deviation) -> Option<usize> {
        let mut all = self.derivatives.parameters.iter();
        all.position(|p| match d.spot {
            None => p.name == d.name,
            Some(_) => p.each_spot.as_ref() == Some(&d.name),
        })
    }
}

/// The same with all spots.
pub(super) fn whole(evidence: &Evidence<'_>, d: &Matrix, spot: Option<usize>) -> Option<Matrix> {
    evidence.left_of(of_spot(d, spot))
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
