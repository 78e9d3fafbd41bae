//! What the integrals of the model may be off by, in a recovered picture.

use super::Known;
use crate::matrix::Matrix;
use crate::recovery::{Method, Options, Problem, Recovered, recover};

/// How far the last steps of the model's integrals move an element at most, over its standard
/// error, which knows of noise alone: the largest Σ |ρ̂_j(Φ + δΦ) − ρ̂_j(Φ)|/σ_j over the steps δΦ,
/// each recovered by the same method. None where nothing is known of the steps or of σ, and of
/// `joint-two-valued`, whose pattern moves by no small steps.
pub(super) fn moved(
    problem: &Problem<'_>,
    known: Known<'_>,
    found: &Recovered,
    options: &Options,
) -> Option<f64> {
    let factors = known.factors.filter(|of| !of.steps.is_empty())?;
    let stderr = found.standard_error.as_ref()?;
    if found.method == Method::JointTwoValued {
        return None;
    }
    let options = Options {
        bands: None,
        ..*options
    };
    let mut sum = found.reflectance.map(|_| 0.0);
    for step in factors.moved(found.seen().as_slice()) {
        let phi: Matrix = problem.photographed() + step;
        let other = recover(found.method, &problem.photographing(&phi), &options).ok()?;
        sum += (other.reflectance - &found.reflectance).abs();
    }
    let each = sum.iter().zip(stderr).map(|(moved, error)| moved / error);
    Some(each.fold(0.0, f64::max))
}
