//! What is inverted in an item, and the rows that its trials become.

use super::inversion::recovered;
use super::outcome::{Outcome, Trial};
use super::traced::{AS_RENDERED, Lights, NAMES};
use crate::lab::LabError;
use crate::lab::finding::{Curve, Mark};
use crate::model::{Kernel, PixelGrid, Published, Stagger};
use crate::num::linalg::Tolerance;
use crate::transport::Control;

/// Pixels a side of the camera in every item.
pub(super) const PIXELS: usize = 16;
/// Half-width of the square of spots in most items, in.
pub(super) const HALF_WIDTH: f64 = 6.0;
pub(super) const KERNELS: [Kernel; 2] = [Kernel::Published, Kernel::Physical];

/// The published simulation with `elements` and 4·`per_side` spots.
pub(super) fn published(
    kernel: Kernel,
    elements: usize,
    per_side: usize,
    half_width: f64,
    stagger: Stagger,
) -> Published {
    Published {
        kernel,
        elements,
        pixels: PIXELS,
        grid: PixelGrid::Edges,
        per_side,
        half_width,
        stagger,
    }
}

/// A configuration with the boards that are recovered in it.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// The curve or group that it belongs to.
    pub(super) label: &'static str,
    pub(super) published: Published,
    /// Checks a side of each board.
    pub(super) boards: Vec<usize>,
    /// Whether Φ is traced, not modelled. A traced case has one board.
    pub(super) is_traced: bool,
}

impl Case {
    /// A modelled case.
    pub(super) fn modelled(label: &'static str, published: Published, boards: Vec<usize>) -> Self {
        Self {
            label,
            published,
            boards,
            is_traced: false,
        }
    }

    /// A traced case.
    pub(super) fn traced(label: &'static str, published: Published, board: usize) -> Self {
        Self {
            is_traced: true,
            ..Self::modelled(label, published, vec![board])
        }
    }

    /// Recovers its boards by the published inversion: noiseless, or from each of the lights of
    /// [`NAMES`].
    pub(super) fn trials(&self, control: Control<'_>) -> Result<Vec<Trial>, LabError> {
        if self.is_traced {
            let board = self.boards[0];
            let lights = Lights::traced(&self.published, board, AS_RENDERED, control)?;
            Ok(vec![lights.recovered(&self.published.board(board))?])
        } else {
            let rule = [Tolerance::Spacing];
            Ok(recovered(&self.published, &rule, &self.boards)?)
        }
    }

    /// Whether `trials` may be its own, where there are `ways` to recover.
    pub(super) fn fits(&self, trials: &[Trial], ways: usize) -> bool {
        let found = if self.is_traced {
            NAMES.len()
        } else {
            self.boards.len()
        };
        let elements = self.published.elements * self.published.elements;
        let whole = |t: &Trial| {
            t.found.len() == found && t.found.iter().all(|o| o.values.len() == elements)
        };
        trials.len() == ways && trials.iter().all(whole)
    }
}

/// Name of Φ where nothing is traced, on the published grid of pixels.
const MODELLED: &str = "modelled";

/// A row of the table: one recovery.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) case: &'a Case,
    /// The number of its trial in the case: by which method or arithmetic.
    pub(super) way: usize,
    pub(super) trial: &'a Trial,
    /// Checks a side.
    pub(super) board: usize,
    /// Which Φ.
    pub(super) phi: &'static str,
    pub(super) outcome: &'a Outcome,
}

impl Row<'_> {
    pub(super) fn is(&self, kernel: Kernel) -> bool {
        self.case.published.kernel == kernel
    }

    pub(super) fn kernel(&self) -> &'static str {
        self.case.published.kernel.name()
    }

    pub(super) fn spots(&self) -> usize {
        4 * self.case.published.per_side
    }

    pub(super) fn half_width(&self) -> f64 {
        self.case.published.half_width
    }
}

/// The rows of every trial of every case, case by case.
pub(super) fn rows<'a>(cases: &'a [Case], found: &'a [Vec<Trial>]) -> Vec<Row<'a>> {
    let of = |(case, trials): (&'a Case, &'a Vec<Trial>)| {
        let trials = trials.iter().enumerate();
        trials.flat_map(move |(way, trial)| {
            let outcomes = trial.found.iter().enumerate();
            outcomes.map(move |(k, outcome)| Row {
                case,
                way,
                trial,
                board: case.boards[if case.is_traced { 0 } else { k }],
                phi: if case.is_traced { NAMES[k] } else { MODELLED },
                outcome,
            })
        })
    };
    cases.iter().zip(found).flat_map(of).collect()
}

/// The curve of `y` over `x` through `rows`; where `y` is not defined there is no point.
pub(super) fn curve<'a>(
    name: impl Into<String>,
    rows: impl IntoIterator<Item = &'a Row<'a>>,
    x: impl Fn(&Row<'_>) -> f64,
    y: fn(&Outcome) -> Option<f64>,
) -> Curve {
    let points = rows.into_iter().filter_map(|r| Some([x(r), y(r.outcome)?]));
    Curve::new(name, Mark::Line, points.collect())
}
