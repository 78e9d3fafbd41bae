//! Standard errors made better by what the photographs themselves say of them.
//!
//! Errors that follow from the noisy entries, σ² = a + b x + c x² of every entry x (√n of counts n,
//! a share of each entry), make entries too certain that noise has made darker, and the picture too
//! dark. That law is exact, which errors of any other origin do not follow, and of the light that
//! is [`expected`] of each entry it holds for the noise itself, counts of none included. Errors
//! from few replicates are [`Pooled`].

use std::borrow::Cow;

use super::certainty::Certainty;
use super::counted::Counted;
use super::light_law::LightLaw;
use super::pooled::Pooled;
use super::smooth_noise;
use crate::matrix::{Matrix, expected};
use crate::num::separable::Separable;

/// Standard errors, W, and what is known of them.
#[derive(Debug)]
pub(in crate::lab) struct Refined<'a> {
    /// Pixels × spots.
    pub(in crate::lab) stderr: Cow<'a, Matrix>,
    /// What is known of them.
    pub(in crate::lab) certainty: Certainty,
}

impl<'a> Refined<'a> {
    /// Those of the entries of `phi` that are not `left_out`, where entries are weighed by them one
    /// by one.
    pub(in crate::lab) fn of(
        phi: &Matrix,
        stderr: &'a Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Self {
        if let Some(law) = LightLaw::of(phi, stderr, left_out) {
            let light = expected(phi, &stderr.map(|s| s * s), left_out);
            let light = light.ok().flatten();
            let follows_entries = light.is_none();
            let stderr = match light {
                Some(light) => Cow::Owned(law.stderrs(&light, (phi, stderr))),
                None => of_counts_of_none(law, (phi, stderr), left_out),
            };
            let at = stderr.iter().enumerate();
            let counts = at.filter(|(at, _)| left_out.is_none_or(|out| out[*at] == 0.0));
            let counted = Counted::new(law, counts.map(|(_, s)| s));
            // Over errors of the noisy entries deviates are skewed the other way.
            let counted = counted.filter(|_| !follows_entries);
            return Self {
                stderr,
                certainty: Certainty {
                    follows_entries: follows_entries || certainty.follows_entries,
                    counted,
                    ..certainty
                },
            };
        }
        Self::of_replicates(stderr, certainty, left_out)
    }

    /// The same for a fit that weighs entries by them and has no model of their light.
    pub(in crate::lab) fn of_weights(
        phi: &Matrix,
        stderr: &'a Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Self {
        let own = Self::of(phi, stderr, certainty, left_out);
        match smooth_noise::pooled(phi, &own.stderr, own.certainty, left_out) {
            Some(smooth) => Self::pooled(smooth),
            None => own,
        }
    }

    /// The same whatever the entries, of methods that work pixel by pixel: they weigh none.
    pub(in crate::lab) fn of_replicates(
        stderr: &'a Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Self {
        match Pooled::of(stderr, certainty, left_out) {
            Some(own) => Self::pooled(own),
            None => Self {
                stderr: Cow::Borrowed(stderr),
                certainty,
            },
        }
    }

    fn pooled(own: Pooled) -> Self {
        Self {
            stderr: Cow::Owned(own.stderr),
            certainty: own.certainty,
        }
    }
}

/// The errors given, of counts of none those of the light that pixel and spot have.
fn of_counts_of_none<'a>(
    law: LightLaw,
    (phi, given): (&Matrix, &'a Matrix),
    left_out: Option<&Matrix>,
) -> Cow<'a, Matrix> {
    let counts = |at: usize| left_out.is_none_or(|out| out[at] == 0.0);
    let is_none = |at: usize| counts(at) && law.is_count_of_none(phi[at], given[at]);
    if !(0..phi.len()).any(is_none) {
        return Cow::Borrowed(given);
    }
    let at: Vec<usize> = (0..phi.len()).filter(|at| counts(*at)).collect();
    let light = Separable::of(phi, &at);
    let mut own = given.clone();
    for at in (0..phi.len()).filter(|at| is_none(*at)) {
        own[at] = law.stderr(light.at(at)).unwrap_or(0.0);
    }
    Cow::Owned(own)
}

#[cfg(test)]
pub(in crate::lab) mod tests;
