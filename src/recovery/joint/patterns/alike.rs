//! Patterns of two values where neighbours may be alike: what the photographs say of that, and
//! which picture it makes.

use super::fields::{self, Fields};
use super::levels::{self, ALL};
use super::neighbours;
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_sums::Summed;
use crate::recovery::{RecoveryError, Sum};

/// The picture is the likeliest pattern where neighbours may be alike if it has at least this
/// probability there, and the photographs are likelier by at least e to this if they are alike.
const SETTLED: f64 = 0.5;
const TELLS: f64 = 3.0;
/// Share of the probability that must be summed pattern by pattern for another prior.
const LISTED: f64 = 0.99;

/// Whether nearly all patterns that count were summed one by one: of those that were drawn the few
/// that another prior prefers say nothing.
fn is_listed(sum: Sum) -> bool {
    match sum {
        Sum::Exhaustive => true,
        Sum::Sampled { listed, .. } => sum.converged() && listed >= LISTED,
    }
}

/// Where neighbours may be alike: what the patterns' evidence gains, and the patterns, if known. If
/// nearly all were summed one by one, those of single elements are weighed anew. Of such as were
/// drawn the few that neighbours prefer say nothing: so many others are drawn, those of `known`
/// listed.
pub(super) fn where_alike(
    likelihood: &PatternLikelihood<'_>,
    (sizes, known): (&[Fields], &[Vec<bool>]),
    (summed, draws): (&Summed, usize),
) -> Result<(Option<f64>, Option<Summed>), RecoveryError> {
    let prior = sizes.last().and_then(|single| single.prior.as_ref());
    let reweighed = neighbours::Reweighed::new(prior, &summed.patterns.weights);
    let quadrature = levels::rule();
    let of = |light: &[bool]| Some(likelihood.weigh(light, &quadrature, ALL)?.levels);
    let anew = is_listed(summed.sum).then(|| reweighed.sum(of)).flatten();
    let own = reweighed
        .gained()
        .zip(anew)
        .map(|(gained, patterns)| Summed {
            patterns,
            log_evidence: summed.log_evidence + gained,
            sum: summed.sum,
            best: summed.best.clone(),
        });
    let found = fields::sum(likelihood, sizes, known, (draws, own))?;
    Ok(match found.filter(|found| found.sum.converged()) {
        Some(found) => (Some(found.log_evidence - summed.log_evidence), Some(found)),
        // What was drawn for fair coins tells no evidence of another prior.
        None => {
            let known = sizes.is_empty() || is_listed(summed.sum);
            (reweighed.gained().filter(|_| known), None)
        }
    })
}

/// The likeliest pattern where neighbours may be alike, if that is settled; `even` are the sums
/// where every pattern is as likely.
pub(super) fn settled_pattern(
    gained: Option<f64>,
    alike: Option<&Summed>,
    even: &Summed,
) -> Option<Vec<bool>> {
    let (light, share) = alike?.patterns.likeliest()?;
    let doubted = if even.sum.converged() {
        0.0
    } else {
        libm::log(fields::DOUBTED)
    };
    (share >= SETTLED && gained >= Some(TELLS + doubted)).then(|| light.clone())
}
