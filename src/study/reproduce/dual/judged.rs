//! Pictures, and how much of the hidden board they show.

use super::super::inversion::stretched;
use super::super::{Cell, ReproduceError};
use super::{ELEMENTS, SHOWN, adjoint, board};
use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_normalized, mtf_raw};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Problem, Uncertainty, recover};

/// Whose light a picture is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// T as it was traced.
    Traced,
    /// The exchanged pair, traced by itself.
    Exchanged,
    /// T of the matrix model.
    Modelled,
}

impl Origin {
    fn name(self) -> &'static str {
        match self {
            Self::Traced => "traced",
            Self::Exchanged => "exchanged pair, traced",
            Self::Modelled => "modelled",
        }
    }
}

/// How a picture comes from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// As a photograph of the wall.
    Photograph,
    /// By a transpose.
    Transpose,
    /// By an inverse.
    Inverse(Method),
}

/// A picture of the wall or of the board, judged by how much of the board it shows.
pub(super) struct Judged {
    pub(super) what: &'static str,
    pub(super) origin: Origin,
    pub(super) way: Way,
    pub(super) values: Vec<f64>,
    pub(super) mtf: Option<f64>,
    mtf_normalized: Option<f64>,
    correlation: Option<f64>,
}

impl Judged {
    pub(super) fn new(
        what: &'static str,
        origin: Origin,
        way: Way,
        values: Vec<f64>,
        board: &[f64],
    ) -> Self {
        Self {
            what,
            origin,
            way,
            mtf: mtf_raw(&values, board),
            mtf_normalized: mtf_normalized(&values, board),
            correlation: correlation(&values, board),
            values,
        }
    }

    /// In words.
    pub(super) fn line(&self) -> String {
        let number = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{x:.3}"));
        format!(
            "{} ({}): correlation {}, raw MTF {}",
            self.what,
            self.origin.name(),
            number(self.correlation),
            number(self.mtf)
        )
    }

    pub(super) fn shows(&self) -> bool {
        self.correlation.is_some_and(|c| c.abs() >= SHOWN)
    }

    /// Values stretched to \[0, 1\] by their own ends.
    pub(super) fn stretched(&self) -> Vec<f64> {
        stretched(&self.values)
    }

    pub(super) fn row(&self) -> Vec<Cell> {
        vec![
            self.what.into(),
            self.origin.name().into(),
            None.into(),
            None.into(),
            self.mtf.into(),
            self.mtf_normalized.into(),
            self.correlation.into(),
        ]
    }
}

/// What is made of T to see the board: transposes and inverses.
pub(super) fn seen(
    origin: Origin,
    phi: &Matrix,
    stderr: Option<&Matrix>,
    model: &MatrixModel,
) -> Result<Vec<Judged>, ReproduceError> {
    let (c, d) = (&model.camera_side, &model.laser_side);
    let board = board(ELEMENTS);
    let options = Options {
        uncertainty: Uncertainty::StandardError,
        ..Options::default()
    };
    let problem = Problem::new(phi, c, d, stderr)?;
    let by = |what, way, values| Judged::new(what, origin, way, values, &board);
    let inverse = |what, method| -> Result<Judged, ReproduceError> {
        let found = recover(method, &problem, &options)?;
        let values = found.reflectance.as_slice().to_vec();
        Ok(by(what, Way::Inverse(method), values))
    };
    Ok(vec![
        by(
            "transpose of G12 in place of its inverse",
            Way::Transpose,
            adjoint::laser_side(phi, c, d),
        ),
        by(
            "back projection, both sides transposed",
            Way::Transpose,
            adjoint::both_sides(phi, c, d),
        ),
        inverse("inverse: pinv of G12", Method::Pinv)?,
        inverse("inverse: joint", Method::Joint)?,
    ])
}
