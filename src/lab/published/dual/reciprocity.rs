//! Helmholtz reciprocity between two renders, within their error bars.

use super::super::traced::REPLICATES;
use super::pair::{Direction, Footprints, footprints};
use crate::lab::LabError;
use crate::lab::{Agreement, Certainty, Errors, Evidence, Test, agree};
use crate::matrix::Matrix;

/// Both renders are compared at this significance.
pub(super) const SIGNIFICANCE: f64 = 1e-3;

/// The two renders by the law of reciprocity, entry by entry and as pictures under flood light.
pub(super) struct Reciprocity {
    /// k of both, each entry alone.
    pub(super) entries: Agreement,
    /// The same with T′ taken as it is, not transposed.
    pub(super) untransposed: Agreement,
    /// The same without the étendues.
    pub(super) scaleless: Agreement,
    /// The dual image against the photograph of the exchanged pair, both under light on every spot.
    pub(super) pictures: Agreement,
}

impl Reciprocity {
    pub(super) fn new(there: &Direction, back: &Direction) -> Result<Self, LabError> {
        // Two sets of 32 replicates: at least 31 degrees of freedom (Welch).
        let test = Test {
            significance: SIGNIFICANCE,
            known: Certainty::new(Errors::Independent, Some(REPLICATES)),
        };
        let compare = |[a, a_error]: [&Matrix; 2], [b, b_error]: [&Matrix; 2], bound: &Matrix| {
            let stderr = a_error.zip_map(b_error, |x, y| (x * x + y * y).sqrt());
            let evidence = Evidence {
                traced: a,
                stderr: &stderr,
                model: b,
                bound: Some(bound),
                left_out: None,
                eliminated: None,
            };
            agree(evidence, test, None).0
        };
        let k = |d: &Direction| [&d.traced.flux, &d.traced.stderr].map(|m| d.transport(m));
        let [a, a_error] = k(there);
        let [b, b_error] = k(back).map(|m| m.transpose());
        let Footprints { signed, bound } = footprints(there, back)?;
        let [signed, bound] = [signed, bound].map(|part| part.component_mul(&a));
        let allowed = signed.abs() + &bound;
        let [flux, error] = [&back.traced.flux, &back.traced.stderr].map(Matrix::transpose);
        let none = Matrix::zeros(flux.nrows(), flux.ncols());
        // Sums over the camera's pixels; errors of different entries are independent.
        let sum = |m: &Matrix| Matrix::from_row_slice(1, m.ncols(), m.row_sum().as_slice());
        let root = |m: &Matrix| sum(&m.map(|x| x * x)).map(f64::sqrt);
        Ok(Self {
            entries: compare([&a, &a_error], [&b, &b_error], &allowed),
            untransposed: compare(
                [&a, &a_error],
                [&b.transpose(), &b_error.transpose()],
                &allowed,
            ),
            scaleless: compare(
                [&there.traced.flux, &there.traced.stderr],
                [&flux, &error],
                &none,
            ),
            pictures: compare(
                [&sum(&a), &root(&a_error)],
                [&sum(&b), &root(&b_error)],
                &(sum(&signed).abs() + sum(&bound)),
            ),
        })
    }
}
