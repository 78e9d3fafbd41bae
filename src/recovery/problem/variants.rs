//! The same problem with some of it changed.

use nalgebra::DMatrix;

use super::{Problem, Terms};
use crate::recovery::Nuisance;
use crate::recovery::soft::Soft;

impl<'a> Problem<'a> {
    /// The same without factors that are known only roughly.
    pub(in crate::recovery) fn without_gains(&self) -> Self {
        let nuisance = Nuisance {
            frame_gain: None,
            scale_error: None,
            ..self.nuisance
        };
        Problem {
            nuisance,
            shared: None,
            ..*self
        }
    }

    /// The same with a factor of all light that is known to this, or exactly.
    pub(in crate::recovery) fn with_scale_error(&self, scale_error: Option<f64>) -> Self {
        let nuisance = Nuisance {
            scale_error,
            ..self.nuisance
        };
        Problem {
            nuisance,
            shared: None,
            ..*self
        }
    }

    /// The same with a free scale of all light.
    pub(in crate::recovery) fn with_free_scale(&self) -> Self {
        let nuisance = Nuisance {
            free_scale: true,
            ..self.nuisance
        };
        Problem {
            nuisance,
            shared: None,
            ..*self
        }
    }

    /// The same with factors that are what they are estimated to be.
    pub(in crate::recovery) fn with_known_factors(&self) -> Self {
        Problem {
            soft: None,
            shared: None,
            ..*self
        }
    }

    /// The same with other photographs and another right side of the operator, and with factors
    /// about estimates of them.
    pub(in crate::recovery) fn about<'b>(
        &self,
        phi: &'b DMatrix<f64>,
        d: &'b DMatrix<f64>,
        soft: &'b Soft,
    ) -> Problem<'b>
    where
        'a: 'b,
    {
        let own: Problem<'b> = *self;
        Problem {
            phi,
            d: if own.terms.is_some() { own.d } else { d },
            terms: own.terms.map(|terms| Terms { d, ..terms }),
            soft: Some(soft),
            shared: None,
            ..own
        }
    }

    /// The same along other directions of its photographs: `phi` and the camera side of its terms
    /// turned by one orthogonal matrix, with the errors and the light beside it along them.
    pub(in crate::recovery) fn along<'b>(
        &self,
        phi: &'b DMatrix<f64>,
        c: &'b DMatrix<f64>,
        stderr: &'b DMatrix<f64>,
        nuisance: Nuisance<'b>,
    ) -> Problem<'b>
    where
        'a: 'b,
    {
        let own: Problem<'b> = *self;
        Problem {
            phi,
            c: if own.terms.is_some() { own.c } else { c },
            terms: own.terms.map(|terms| Terms { c, ..terms }),
            stderr: Some(stderr),
            nuisance,
            shared: None,
            ..own
        }
    }
}
