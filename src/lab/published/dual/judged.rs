//! Pictures, and how much of the hidden board they show.

use super::super::sheet::board;
use super::adjoint;
use crate::lab::LabError;
use crate::lab::finding::Cell;
use crate::lab::recovered::measures::Measures;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Problem, Uncertainty, recover};

/// Elements and checks a side of the hidden board.
pub(super) const ELEMENTS: usize = 8;
pub(super) const CHECKS: usize = 2;
/// A picture shows the board where it correlates with it at least so much.
pub(super) const SHOWN: f64 = 0.5;

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
    pub(super) measures: Measures,
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
            measures: Measures::of(&values, board),
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
            number(self.measures.correlation),
            number(self.measures.mtf_raw)
        )
    }

    /// What, whose light, no number and value of a singular value, and the three measures.
    pub(super) fn row(&self) -> Vec<Cell> {
        let words = [self.what, self.origin.name()].map(Cell::from);
        let m = &self.measures;
        let measures = [None, None, m.mtf_raw, m.mtf_normalized, m.correlation];
        words.into_iter().chain(measures.map(Cell::from)).collect()
    }

    pub(super) fn shows(&self) -> bool {
        self.measures.correlation.is_some_and(|c| c.abs() >= SHOWN)
    }
}

/// What is made of T to see the board: transposes and inverses.
pub(super) fn seen(
    origin: Origin,
    phi: &Matrix,
    stderr: Option<&Matrix>,
    model: &MatrixModel,
) -> Result<Vec<Judged>, LabError> {
    let (c, d) = (&model.camera_side, &model.laser_side);
    let board = board(ELEMENTS, CHECKS);
    let options = Options {
        uncertainty: Uncertainty::StandardError,
        ..Options::default()
    };
    let problem = Problem::new(phi, c, d, stderr)?;
    let by = |what, way, values| Judged::new(what, origin, way, values, &board);
    let inverse = |what, method| -> Result<Judged, LabError> {
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
