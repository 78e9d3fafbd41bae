//! What the integrals of the model may be off by, in a recovered picture.

use nalgebra::DVector;

use super::Known;
use crate::matrix::Matrix;
use crate::model::Factors;
use crate::num::linalg::Cholesky;
use crate::recovery::{Method, Options, Problem, Recovered, recover};

/// How far the last steps of the model's integrals move each element: Σ |ρ̂_j(Φ + δΦ) − ρ̂_j(Φ)|
/// over the steps δΦ, each recovered by the same method; of `joint-two-valued`, whose pattern moves
/// by no small steps, with its pattern as it is. None where nothing is known of the steps, or there
/// are no errors to count it in.
pub(super) fn moved(
    problem: &Problem<'_>,
    known: Known<'_>,
    found: &Recovered,
    options: &Options,
) -> Option<DVector<f64>> {
    let factors = known.factors.filter(|of| !of.steps.is_empty())?;
    let has_errors = found.standard_error.is_some() || found.bands.is_some();
    if !has_errors {
        return None;
    }
    if found.method == Method::JointTwoValued {
        let estimated = options.levels.is_none() && found.nuisance.is_none();
        return estimated.then(|| levels(problem, known.stderr, factors, found))?;
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

/// The same of two levels a of a given pattern, A_k what each lights, by weighted least squares:
///
/// > δa = (AᵀWA)⁻¹ AᵀW δΦ
fn levels(
    problem: &Problem<'_>,
    stderr: &Matrix,
    factors: &Factors,
    found: &Recovered,
) -> Option<DVector<f64>> {
    let picture = &found.reflectance;
    let middle = 0.5 * (picture.min() + picture.max());
    let is_light = picture.map(|x| f64::from(u8::from(x > middle)));
    let both = [is_light.map(|x| 1.0 - x), is_light];
    let lit: Vec<usize> = (0..2).filter(|k| both[*k].sum() > 0.0).collect();
    let counted = problem.counted(stderr.clone());
    let over = |m: Matrix| m.zip_map(&counted, |x, s| if s > 0.0 { x / s } else { 0.0 });
    let sides: Vec<Matrix> = lit.iter().map(|k| over(problem.light(&both[*k]))).collect();
    let n = sides.len();
    let gram = Matrix::from_fn(n, n, |i, j| sides[i].dot(&sides[j]));
    let gram = Cholesky::new(&gram)?;
    let mut sum = picture.map(|_| 0.0);
    for step in factors.moved(found.seen().as_slice()) {
        let step = over(step);
        let moved = gram.solve(&DVector::from_fn(n, |k, _| sides[k].dot(&step)));
        for (k, by) in lit.iter().zip(&moved) {
            sum += &both[*k] * by.abs();
        }
    }
    Some(sum)
}
