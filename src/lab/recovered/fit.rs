//! Does a recovered picture explain the photographs it was recovered from?
//!
//! Every method answers with reflectances ρ̂; what they would photograph is
//!
//! > Φ̂\[p,l\] = s Σ_j C\[p,j\] ρ̂_j D\[j,l\] + other light that was estimated with them,
//!
//! whether the method worked pixel by pixel, with bounds or without. Then
//!
//! > χ² = Σ z²,   z = (Φ − Φ̂)/σ   over the N entries whose standard error σ is not zero,
//!
//! has the mean N − ν if the picture is right, ν the degrees of freedom that it used up
//! ([`Recovered::freedom_used`]). Where σ was estimated from K replicates z is the normal deviate
//! of the same tail probability as Student's t of K − 1 degrees of freedom; of errors that were
//! pooled z² is t² over what is expected of it ([`Certainty`]).
//!
//! Where no σ is known, two levels alone are held against it: what they leave over against what any
//! numbers leave over ([`LeftOver`]).
//!
//! χ²/(N − ν) is compared with χ² of N − ν degrees of freedom where entries are independent, of
//! fewer where those of a row are not, of one where all hang together
//! ([`Errors`](crate::lab::Errors)).
//!
//! A picture that is refuted so is held against the photographs once more, |Φ − Φ̂| less what the
//! last steps of the model's integrals move of Φ̂ ([`Factors::moved`]): what these leave over is no
//! evidence against it.

mod apart;
mod attainable;
mod integrated;
mod residuals;

use serde::Serialize;

use nalgebra::DVector;

use crate::lab::uncertainty::certainty::Certainty;
use crate::matrix::Matrix;
use crate::model::Factors;
use crate::num::statistics::chi_square_quantile;
use crate::recovery::{
    Determined, Method, Options, Problem, Recovered, RecoveryError, determined, unseen,
};
pub use apart::Apart;
pub use attainable::Attainable;
use attainable::LeftOver;
pub use residuals::{Outlier, Residuals};

/// Elements up to which the best picture of all is looked for where no method that was asked for
/// gives it.
const MOST_ELEMENTS: usize = 1024;

/// Elements up to which what the photographs determine is computed.
const MOST_DECOMPOSED: usize = 2048;

/// Share of the brightest entry's light below which an entry has none.
const LIT: f64 = 1e-9;

/// How well what was recovered explains the photographs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// χ²/(N − ν): 1 on average for a picture that explains them.
    pub chi2_per_dof: f64,
    /// Degrees of freedom of the χ² that it is compared with.
    pub dof: f64,
    /// Probability of as large a χ² if noise alone were left over.
    pub p: f64,
    /// Entries compared, N.
    pub entries: usize,
    /// Entries left out, because they do not count or their standard error is zero.
    pub left_out: usize,
    /// Below this p the picture is refuted.
    pub level: f64,
    /// Whether it is not.
    pub fits: bool,
    /// χ²/(N − ν) less what the integrals of the model may be off by; none where the picture fits
    /// without, or nothing is known of them.
    pub within_integration: Option<f64>,
    /// The entry farthest off, where chance hardly leaves any of all so far, and all others fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlier: Option<Outlier>,
    /// Replicates as from which the standard errors are known, where those of few were pooled over
    /// pixels and spots; absent where none were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pooled: Option<u32>,
    /// Correlation of what is left of neighbouring pixels, where it is more than chance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<f64>,
    /// Correlation of z² with ln of the light that the picture would photograph, where it is more
    /// than chance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_light: Option<f64>,
}

/// Parts of the noise, beside it in every entry, that a test must find to judge a picture by.
const BLIND: f64 = 2.0;

impl Fit {
    /// The misfit in every entry, in standard errors, that makes χ²/dof on average what refutes a
    /// picture:
    ///
    /// > E χ²/dof = 1 + m²,   m = √(χ²_ν(1 − level)/ν − 1)
    ///
    /// with ν degrees of freedom: 3.1 of one, 1.4 of ten, 0.4 of a thousand.
    pub fn passes(&self) -> f64 {
        let most = chi_square_quantile(1.0 - self.level, self.dof) / self.dof;
        (most - 1.0).max(0.0).sqrt()
    }

    /// Whether it is not refuted, by a test that passes over misfits of twice the noise.
    pub fn is_blind(&self) -> bool {
        self.fits && self.passes() > BLIND
    }

    /// Whether it is neither refuted nor told: more than noise differs, but no more than the
    /// integrals of the model may be off.
    pub fn is_open(&self) -> bool {
        self.fits && self.within_integration.is_some()
    }
}

/// What photographs are held against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known<'a> {
    /// Their standard errors, W.
    pub stderr: &'a Matrix,
    /// What is known of these.
    pub certainty: Certainty,
    /// The light of the elements, where it was integrated.
    pub factors: Option<&'a Factors>,
}

/// The fit of `found` to the photographs of `problem`.
fn fit(problem: &Problem<'_>, known: Known<'_>, found: &Recovered) -> Option<Fit> {
    let Known {
        stderr,
        certainty,
        factors,
    } = known;
    let phi = problem.photographed();
    let stderr = problem.counted(stderr.clone());
    let of = |seen: &Matrix| {
        let mut residuals = Residuals::default();
        residuals.add(phi, seen, &stderr, certainty);
        residuals.fit(found.freedom_used(), certainty)
    };
    let seen = found.photographs(problem);
    let fit = of(&seen)?;
    let steps = factors.filter(|of| !fit.fits && !of.steps.is_empty());
    let Some(factors) = steps else {
        return Some(fit);
    };
    let picture = found.seen();
    let off = factors.bound(picture.as_slice());
    let nearest = seen.zip_zip_map(phi, &off, |seen, phi, off| {
        seen + (phi - seen).clamp(-off, off)
    });
    let within = of(&nearest)?;
    let is_open = within.fits && within.outlier.is_none();
    Some(Fit {
        within_integration: Some(within.chi2_per_dof),
        fits: is_open,
        outlier: within.outlier.or(fit.outlier).filter(|_| !is_open),
        ..fit
    })
}

/// Entries that count and that the surface can light, whose standard error is 0.
fn untested(problem: &Problem<'_>, stderr: &Matrix) -> usize {
    if stderr.iter().all(|s| *s > 0.0) {
        return 0;
    }
    let white = DVector::from_element(problem.elements(), 1.0);
    let light = problem.counted(problem.light(&white));
    let least = LIT * light.amax();
    let both = light.iter().zip(stderr);
    both.filter(|(light, stderr)| **light > least && **stderr <= 0.0)
        .count()
}

/// Another picture that explains the same photographs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rival {
    /// Its method.
    pub method: Method,
    /// How far it lies off, root mean square, in the errors of both.
    pub apart: f64,
    /// Its errors over one's own, root mean square.
    pub wider: f64,
    /// ln of how much likelier one's own assumption makes the photographs; absent where that is not
    /// known of both.
    pub ahead: Option<f64>,
}

/// How far a recovery is to be believed, as the photographs themselves say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// Its fit; none where it cannot be judged.
    pub fit: Option<Fit>,
    /// What any numbers leave over, where the noise is not known and two levels were tried.
    pub left_over: Option<LeftOver>,
    /// That of the best picture of all, where it is known.
    pub best: Option<Attainable>,
    /// Why no picture of reflectances between 0 and 1 was found, where one was looked for.
    pub none_possible: Option<RecoveryError>,
    /// What the photographs determine of each element, where it is known.
    pub determined: Option<Determined>,
    /// Elements of which they say nothing, in order; none where that is not known.
    pub unseen: Vec<usize>,
    /// Entries that count and that the surface can light, whose standard error is 0: they weigh on
    /// the picture, and no test sees them.
    pub untested: usize,
    /// What is known of the errors of the photographs; none where they are not.
    pub certainty: Option<Certainty>,
    /// How far the integrals of the model may move each element; none where that is not known.
    pub moved: Option<DVector<f64>>,
    /// Another method that fits as well and says something else.
    pub against: Option<Rival>,
    /// Occluders that send on light which the model does not have, by name.
    pub sent_on: Option<String>,
}

impl Judged {
    /// Which entries share their errors, and what gives each its own, in words.
    pub(super) fn shared(&self) -> Option<[&'static str; 2]> {
        self.certainty.and_then(Certainty::shared)
    }

    /// What holds for every method: the best of all that was `found` and can be found, and what the
    /// photographs determine.
    pub(super) fn any(
        problem: &Problem<'_>,
        noise: Option<Known<'_>>,
        found: &[&Recovered],
        options: &Options,
    ) -> Self {
        let few = problem.elements() <= MOST_DECOMPOSED && !found.is_empty();
        let two_valued = found.iter().any(|f| f.method == Method::JointTwoValued);
        let known = noise.filter(|_| !found.is_empty());
        let best = known.map(|noise| Attainable::of(problem, noise, found, options));
        let (best, none_possible) = match best.transpose() {
            Ok(best) => (best.flatten(), None),
            Err(RecoveryError::Stopped(_)) => (None, None),
            Err(error) => (None, Some(error)),
        };
        Self {
            fit: None,
            left_over: match noise {
                None if two_valued => LeftOver::of(problem, found, options),
                _ => None,
            },
            best,
            none_possible,
            determined: few.then(|| determined(problem).ok()).flatten(),
            unseen: few
                .then(|| unseen(problem).ok())
                .flatten()
                .unwrap_or_default(),
            untested: known.map_or(0, |known| untested(problem, known.stderr)),
            certainty: noise.map(|known| known.certainty),
            moved: None,
            against: None,
            sent_on: None,
        }
    }

    /// The same with the fit of `found`, which was recovered with these options.
    pub(super) fn of(
        &self,
        problem: &Problem<'_>,
        noise: Option<Known<'_>>,
        (found, options): (&Recovered, &Options),
    ) -> Self {
        let two_valued = found.method == Method::JointTwoValued;
        let left_over = self.left_over.filter(|_| two_valued);
        Self {
            fit: match noise {
                Some(noise) => fit(problem, noise, found),
                None => left_over.and_then(|any| any.refutes(problem, found)),
            },
            moved: noise.and_then(|noise| integrated::moved(problem, noise, found, options)),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests;
