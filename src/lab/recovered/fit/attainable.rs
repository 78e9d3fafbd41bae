//! What the best picture of all can do.

use super::{Apart, Certainty, Fit, Known, MOST_ELEMENTS, Residuals, fit};
use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::matrix::Matrix;
use crate::num::statistics::fisher_sf;
use crate::recovery::{Method, Options, Problem, Recovered, RecoveryError, WeightRule, recover};

/// What the best picture of all can do: whether photographs and matrices belong together, whatever
/// the method.
#[derive(Clone, Debug, PartialEq)]
pub struct Attainable {
    /// Of all reflectances between 0 and 1 (above 0, where the scale is free): of `joint`, or of
    /// another picture of such reflectances that was found and fits.
    pub possible: Fit,
    /// Of all numbers: of `joint-unbounded`.
    pub any: Option<Fit>,
    /// The photographs over those of a surface that is white throughout, by least squares: at most
    /// 1 for any surface. 1 with a free scale.
    pub brightness: f64,
    /// Photographs or pixels without which reflectances between 0 and 1 fit; none where none do.
    pub apart: Option<Apart>,
}

impl Attainable {
    /// The best among what was `found` already, looked for where it is not there; none without a
    /// noise model, and where there are too many elements for a search that no one asked for.
    ///
    /// # Errors
    /// Why no reflectances between 0 and 1 were found.
    pub(in crate::lab::recovered) fn of(
        problem: &Problem<'_>,
        noise: Known<'_>,
        found: &[&Recovered],
        options: &Options,
    ) -> Result<Option<Self>, RecoveryError> {
        let weighted = options.weighting != WeightRule::Unweighted;
        let options = Options {
            bands: None,
            weighting: WeightRule::Noise,
            ..*options
        };
        let few = problem.elements() <= MOST_ELEMENTS;
        let by = |method: Method| -> Result<Option<Recovered>, RecoveryError> {
            let known = found.iter().find(|f| f.method == method);
            match known.filter(|_| weighted) {
                Some(known) => Ok(Some((*known).clone())),
                None if few => recover(method, problem, &options).map(Some),
                None => Ok(None),
            }
        };
        let scale = |f: &&Recovered| f.nuisance.as_ref().and_then(|n| n.scale);
        let free = found.iter().any(|f| scale(f).is_some());
        let top = if free { f64::INFINITY } else { 1.0 };
        let such = |f: &&&Recovered| f.reflectance.iter().all(|x| (0.0..=top).contains(x));
        let has_joint = found.iter().any(|f| f.method == Method::Joint);
        if weighted && !has_joint {
            let fits = found
                .iter()
                .filter(such)
                .filter_map(|f| fit(problem, noise, f));
            if let Some(possible) = fits.into_iter().find(|own| own.fits) {
                return Ok(Some(Self {
                    possible,
                    any: None,
                    brightness: 1.0,
                    apart: None,
                }));
            }
        }
        let Some(best) = by(Method::Joint)? else {
            return Ok(None);
        };
        let any = || fit(problem, noise, &by(Method::JointUnbounded).ok()??);
        let apart = || Apart::of(problem, noise, &best, &options);
        Ok(fit(problem, noise, &best).map(|possible| Self {
            any: any(),
            brightness: if free { 1.0 } else { problem.brightness() },
            apart: if possible.fits || !few { None } else { apart() },
            possible,
        }))
    }
}

/// What any numbers leave over of photographs whose noise is not known: of `joint-unbounded`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOver {
    /// Σ (Φ − Φ̂)², W².
    sum: f64,
    /// ν.
    used: f64,
    /// Over how many pixels it hangs together.
    alike: f64,
}

/// What is left over of Φcam below which it is rounding.
const ROUNDING: f64 = 1e-9;

impl LeftOver {
    /// Of what was `found` already, or is looked for.
    pub(super) fn of(
        problem: &Problem<'_>,
        found: &[&Recovered],
        options: &Options,
    ) -> Option<Self> {
        let searched = || recover(Method::JointUnbounded, problem, options).ok();
        let known = found.iter().find(|f| f.method == Method::JointUnbounded);
        let any = match known {
            Some(known) => (*known).clone(),
            None if problem.elements() <= MOST_ELEMENTS => searched()?,
            None => return None,
        };
        Some(Self {
            sum: squares(problem, &any).sums.iter().sum(),
            used: any.freedom_used(),
            alike: found.iter().find_map(|f| f.alike).unwrap_or(1.0),
        })
    }

    /// The fit of a picture that is one of them, where it is refuted: with N entries the quotient
    ///
    /// > F = (S − S₀)/(ν₀ − ν) · (N − ν₀)/S₀
    ///
    /// of what it leaves over, S, and they leave over, S₀, follows the law of that name if the
    /// picture is right and the noise alike in all entries. Noise that a pixels share is counted a
    /// times.
    pub(super) fn refutes(&self, problem: &Problem<'_>, found: &Recovered) -> Option<Fit> {
        let own = squares(problem, found);
        let (sum, used) = (own.sums.iter().sum::<f64>(), found.freedom_used());
        let entries = own.entries as f64;
        let (over, under) = (self.used - used, entries / self.alike - self.used);
        if over < 0.5 || under < 0.5 || found.relative_residual < ROUNDING {
            return None;
        }
        let noise = self.sum / (entries - self.used);
        let p = fisher_sf((sum - self.sum) / over / noise / self.alike, over, under);
        (p < FIT_LEVEL).then(|| Fit {
            chi2_per_dof: sum / (entries - used) / noise,
            dof: entries - used,
            p,
            entries: own.entries,
            left_out: own.left_out,
            level: FIT_LEVEL,
            fits: false,
            within_integration: None,
            outlier: None,
            pooled: None,
            neighbours: None,
            with_light: None,
        })
    }
}

/// (Φ − Φ̂)² of the entries that count.
fn squares(problem: &Problem<'_>, found: &Recovered) -> Residuals {
    let mut residuals = Residuals::default();
    let phi = problem.photographed();
    let ones = problem.counted(Matrix::from_element(phi.nrows(), phi.ncols(), 1.0));
    residuals.add(phi, &found.photographs(problem), &ones, Certainty::STATED);
    residuals
}
