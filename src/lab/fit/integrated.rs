//! What the integrals of the model may be off by, in a recovered picture.

use nalgebra::DVector;

use super::Known;
use crate::matrix::Matrix;
use crate::recovery::{Method, Options, Problem, Recovered, recover};

/// How far the last steps of the model's integrals move each element: Σ |ρ̂_j(Φ + δΦ) − ρ̂_j(Φ)|
/// over the steps δΦ, each recovered by the same method. None where nothing is known of the steps,
/// where there are no errors to count it in, and of `joint-two-valued`, whose pattern moves by no
/// small steps.
pub(super) fn moved(
    problem: &Problem<'_>,
    known: Known<'_>,
    found: &Recovered,
    options: &Options,
) -> Option<DVector<f64>> {
    let factors = known.factors.filter(|of| !of.steps.is_empty())?;
    let has_errors = found.standard_error.is_some() || found.bands.is_some();
    if !has_errors || found.method == Method::JointTwoValued {
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
    Some(sum)
}
