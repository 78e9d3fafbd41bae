//! The rule that integrates the light, and what it leaves out.
//!
//! The search goes by a coarse rule. As long as the next one would move an unknown by a notable
//! part of its error, all ends go on by that. What the one after the last moves is a part of the
//! error.

use nalgebra::DVector;

use super::descent::{Problem, State};
use super::field::End;
use super::geometry::Geometry;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::model::Fineness;
use crate::num::linalg::Cholesky;

/// Part of its error by which an unknown is notably moved: with it the error is 5 % larger.
const NOTABLE: f64 = 0.3;
/// Pixels and spots times the parts of all elements beyond which no finer rule is taken.
const MOST: usize = 1 << 22;

impl<'a> Problem<'a> {
    /// The same by the next rule; none past what stands in the way but after the first, and where
    /// that would take too many parts.
    fn by_next_rule(&self) -> Option<Problem<'a>> {
        let fineness = if self.geometry.is_obstructed() {
            Fineness::Areas(2)
        } else {
            self.geometry.fineness.next()
        };
        let photographs = self.photographs.phi;
        let sides = photographs.nrows() + photographs.ncols();
        let elements = self.pictures.first().map_or(0, |p| p.root.nrows());
        let is_taken = match fineness {
            Fineness::Centres | Fineness::Areas(..=2) => fineness != self.geometry.fineness,
            Fineness::Areas(k) => sides * elements <= MOST >> (2 * k),
        };
        let geometry = Geometry {
            fineness,
            ..self.geometry
        };
        is_taken.then(|| Problem {
            geometry,
            priors: self.priors.clone(),
            ..*self
        })
    }

    /// The rule by which to go on from `end`; none where light is taken by centres, past what
    /// stands in the way, where this rule is fine enough, and where nothing would tell what the
    /// next one leaves out.
    pub(super) fn next_rule(&self, end: &End) -> Result<Option<Fineness>, LabError> {
        if self.geometry.fineness == Fineness::Centres {
            return Ok(None);
        }
        let next = self.by_next_rule();
        let Some(next) = next.filter(|next| next.by_next_rule().is_some()) else {
            return Ok(None);
        };
        let with_field = end.field.as_ref().map(|own| self.with_field(own));
        let with_field = with_field.transpose()?;
        let problem = with_field.as_ref().unwrap_or(self);
        let information = problem.information(&end.state.slope);
        let information = Cholesky::new(&information).ok_or(LabError::DARK)?;
        let covariance = information.inverse();
        let Some((moved, _)) = problem.finer(&end.state, &covariance)? else {
            return Ok(None);
        };
        let variances = covariance.diagonal();
        let mut each = moved.iter().zip(&variances);
        let is_moved = each.any(|(x, v)| x.abs() > NOTABLE * v.sqrt());
        Ok(is_moved.then_some(next.geometry.fineness))
    }

    /// How far the next rule of integration moves the unknowns, by one Newton step, and χ² there;
    /// none where there is none.
    pub(super) fn finer(
        &self,
        best: &State,
        covariance: &Matrix,
    ) -> Result<Option<(DVector<f64>, f64)>, LabError> {
        let Some(finer) = self.by_next_rule() else {
            return Ok(None);
        };
        let state = finer.state(&best.values, best.factor, Some(&best.prior))?;
        let slopes = self.whole_slope(best) - self.whole_slope(&state);
        let moved = covariance * &slopes;
        let less = moved.dot(&slopes);
        Ok(Some((moved, (state.value.chi2 - less).max(0.0))))
    }
}
