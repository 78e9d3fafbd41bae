//! What is taken out of a frame: its constants, patterns and glare as a whole, its factor softly.

use nalgebra::{DMatrix, DVectorViewMut};

use super::super::conditional::Softening;
use super::super::elimination::{directions, without_left};
use crate::recovery::Problem;

/// What is taken out of the weighted rows of a frame.
pub(super) struct Frame {
    /// Orthonormal directions as columns, as a whole,
    taken: DMatrix<f64>,
    /// and the frame's factor m, one column, softly.
    pub(super) softly: Option<(DMatrix<f64>, Softening)>,
}

impl Frame {
    /// Of frame l, √w of whose pixels is `root`.
    pub(super) fn new(
        problem: &Problem<'_>,
        patterns: &DMatrix<f64>,
        root: &[f64],
        l: usize,
    ) -> Self {
        let taken = directions(&problem.nuisance.of_frame(patterns, l), |p| root[p]);
        let frames = problem.soft.and_then(|soft| {
            let (pattern, known_to) = soft.frames.as_ref()?;
            Some((pattern.column(l), known_to / soft.noise))
        });
        let softly = frames.map(|(pattern, width)| {
            let mut m = DMatrix::from_fn(root.len(), 1, |p, _| root[p] * pattern[p]);
            taken.iter().for_each(|u| without_left(&mut m, u));
            let softening = Softening::new(m.norm_squared(), width);
            (m, softening)
        });
        Frame {
            taken: DMatrix::from_fn(root.len(), taken.len(), |p, k| taken[k][p]),
            softly,
        }
    }

    /// Directions U and shares s of rows → rows − s U Uᵀ rows, one after the other. Those that are
    /// taken as a whole come twice: once leaves rounding of the size of what was removed.
    pub(super) fn steps(&self) -> impl Iterator<Item = (&DMatrix<f64>, f64)> {
        let whole = [(&self.taken, 1.0); 2];
        let whole = whole.into_iter().filter(|(u, _)| u.ncols() > 0);
        let softly = self.softly.as_ref();
        whole.chain(softly.map(|(m, softening)| (m, softening.taken)))
    }

    pub(super) fn take_out(&self, rows: &mut DVectorViewMut<'_, f64>) {
        for (u, share) in self.steps() {
            let along = u.tr_mul(rows);
            rows.gemv(-share, u, &along, 1.0);
        }
    }
}
