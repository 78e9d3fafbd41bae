//! The points that beams light.

use std::borrow::Cow;
use std::ops::Range;

use super::beam::LitPoint;

/// Lit points of some columns for a number of places in the beams: the same for all places where beams have no width. `None` where the
/// light is lost.
#[derive(Debug)]
pub(super) struct Lit<'a> {
    /// Columns of Φcam.
    pub columns: Range<usize>,
    /// By place and column, or by column alone.
    points: Cow<'a, [Option<LitPoint>]>,
}

impl<'a> Lit<'a> {
    pub(super) fn new(columns: Range<usize>, points: Cow<'a, [Option<LitPoint>]>) -> Self {
        Self { columns, points }
    }

    /// Whether all places have the same points.
    pub(super) fn is_fixed(&self) -> bool {
        self.points.len() == self.columns.len()
    }

    /// The points of all columns for place `k`.
    pub(super) fn at(&self, k: usize) -> &[Option<LitPoint>] {
        let n = self.columns.len();
        match self.is_fixed() {
            true => &self.points,
            false => &self.points[k * n..(k + 1) * n],
        }
    }
}
